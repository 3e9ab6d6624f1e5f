#include "mbk/experiment/console/outbox.h"

#include <gtest/gtest.h>

namespace mbk::console {
namespace {

Message message(std::string text) {
  return std::make_shared<std::string>(std::move(text));
}

TEST(Outbox, AStuckViewerKeepsTheNewestFramesAndTheRestIsCounted) {
  Outbox outbox(3);
  for (int k = 0; k < 1000; ++k) outbox.put_frame(message(std::to_string(k)));
  EXPECT_EQ(outbox.frames(), 3U);
  EXPECT_EQ(outbox.dropped(), 997U);
  for (const char* const expected : {"997", "998", "999"}) EXPECT_EQ(*outbox.take()->message, expected);
  EXPECT_FALSE(outbox.take());
}

TEST(Outbox, OfATopicOnlyTheNewestIsSentAndBeforeFrames) {
  Outbox outbox(3);
  outbox.put_frame(message("frame"));
  outbox.put(Topic::state, message("old"));
  outbox.put(Topic::state, message("new"));
  outbox.put(Topic::estimate, message("estimate"));
  EXPECT_EQ(*outbox.take()->message, "new");
  EXPECT_EQ(*outbox.take()->message, "estimate");
  const auto frame = outbox.take();
  EXPECT_EQ(*frame->message, "frame");
  EXPECT_TRUE(frame->binary);
  EXPECT_FALSE(outbox.take());
  EXPECT_EQ(outbox.dropped(), 0U);
}

TEST(Outbox, MessagesAreSharedAndLetGo) {
  const Message one = message("one");
  Outbox first(2), second(2);
  first.put_frame(one);
  second.put_frame(one);
  EXPECT_EQ(one.use_count(), 3);
  (void)first.take();
  second.put_frame(message("two"));
  second.put_frame(message("three"));
  EXPECT_EQ(one.use_count(), 1);
}

}  // namespace
}  // namespace mbk::console
