#include "mbk/files/recording/channel_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "mbk/files/recording/si_units.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::recording {
namespace {

TEST(ChannelTable, KnowsTheChannelsOfEveryQuantity) {
  for (const QuantityChannels& quantity : {kPositionChannels, kForceChannels, kReferenceChannels, kAccelerationChannels,
                                           kJointChannels, kTorqueChannels}) {
    const auto known = [](const char* name) { return std::ranges::find(channel_kinds(), name, &ChannelKind::name); };
    for (const char* const name : quantity.several) {
      const auto kind = known(name);
      ASSERT_NE(kind, channel_kinds().end()) << name;
      EXPECT_EQ(kind->frame, quantity.frame) << name;
      EXPECT_TRUE(kind->accepts(*find_unit(quantity.unit))) << name;
      EXPECT_EQ(kind->axes, 2) << name;
    }
    if (quantity.one_axis == nullptr) continue;
    ASSERT_NE(known(quantity.one_axis), channel_kinds().end()) << quantity.one_axis;
    EXPECT_EQ(known(quantity.one_axis)->axes, 1) << quantity.one_axis;
  }
}

TEST(ChannelTable, NamesTheNearestWhateverItsCase) {
  EXPECT_EQ(nearest_channel_name("HNAD_X"), "hand_x");
  EXPECT_EQ(nearest_channel_name("vx"), "Vx");
  EXPECT_NE(nearest_channel_name("z"), "t");
}

}  // namespace
}  // namespace mbk::recording
