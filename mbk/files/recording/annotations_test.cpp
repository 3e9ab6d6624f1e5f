#include "mbk/files/recording/annotations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mbk/files/contents/utf16.h"

namespace mbk::recording {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

Contents with_events(Index times, Index values, std::size_t names) {
  Contents contents;
  contents.arrays = {{"events.time", Matrix(Vector::LinSpaced(times, 1.0, 2.0))},
                     {"events.value", Matrix(Vector::Zero(values))}};
  contents.texts = {{"events.name", std::vector<std::string>(names, "onset")}};
  return contents;
}

TEST(TakeAnnotations, TakesMetadataAndNotesOtherTexts) {
  Contents contents;
  contents.texts = {{"metadata.name", {"Anna"}}, {"who", {"me"}}, {"metadata.rows", {"a", "b"}}, {"metadata", {"x"}}};
  take_annotations(contents);
  EXPECT_THAT(contents.metadata, ElementsAre(Pair("name", "Anna"), Pair("rows", "a; b")));
  EXPECT_THAT(contents.notes, ElementsAre(HasSubstr("'who'"), AllOf(HasSubstr("'rows'"), HasSubstr("2 lines")),
                                          HasSubstr("'metadata'")));
}

TEST(TakeAnnotations, TakesEventsThatFitTogether) {
  Contents contents = with_events(3, 3, 3);
  take_annotations(contents);
  ASSERT_EQ(contents.events.size(), 3u);
  EXPECT_EQ(contents.events[1].time, 1.5);
  EXPECT_EQ(contents.events[1].name, "onset");
  EXPECT_TRUE(contents.arrays.empty());
  EXPECT_TRUE(contents.notes.empty());
}

TEST(TakeAnnotations, LeavesEventsOfAnotherShapeAsTheyAre) {
  for (Contents contents : {with_events(2, 3, 3), with_events(3, 2, 3), with_events(3, 3, 1)}) {
    take_annotations(contents);
    EXPECT_TRUE(contents.events.empty());
    EXPECT_EQ(contents.arrays.size(), 2u);
    EXPECT_THAT(contents.notes, ElementsAre(HasSubstr("'events.name'")));
  }
}

TEST(Utf16, ComesBackFromUtf8) {
  for (const char* text : {"", "a", "\x7f\u0080\u07FF\u0800\uFFFD", "\U00010000\U0010FFFF", "né 😀 ж 漢"}) {
    EXPECT_EQ(utf8_from_utf16(utf16_from_utf8(text)), text);
  }
  EXPECT_EQ(utf16_from_utf8("é😀"), u"é😀");
}

TEST(Utf16, ReplacesHalvesOfPairs) {
  const char16_t halves[] = {0xD83D, u'a', 0xDE00, 0xD83D};
  EXPECT_EQ(utf8_from_utf16({halves, 4}), "\uFFFDa\uFFFD\uFFFD");
}

}  // namespace
}  // namespace mbk::recording
