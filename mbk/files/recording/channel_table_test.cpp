#include "mbk/files/recording/channel_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

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
      EXPECT_EQ(kind->axes, std::string_view(name).ends_with("_z") ? 3 : 2) << name;
    }
    if (quantity.one_axis == nullptr) continue;
    ASSERT_NE(known(quantity.one_axis), channel_kinds().end()) << quantity.one_axis;
    EXPECT_EQ(known(quantity.one_axis)->axes, 1) << quantity.one_axis;
  }
}

TEST(ChannelTable, AThirdAxisIsNeverImplied) {
  const auto axes = [](std::initializer_list<std::string_view> names) {
    std::vector<std::vector<const ChannelKind*>> meanings;
    for (const std::string_view name : names) meanings.push_back(kinds_called(name));
    return axes_of(meanings);
  };
  EXPECT_EQ(axes({"x", "F", "z"}), 1);
  EXPECT_EQ(axes({"x", "Fx", "Fz"}), 2);
  EXPECT_EQ(axes({"hand_x", "hand_y", "hand_z", "force_x", "force_y", "force_z"}), 2);
  EXPECT_EQ(kind_for_axes(kinds_called("z"), 1), nullptr);
  for (const int several : {2, 3}) {
    EXPECT_EQ(kind_for_axes(kinds_called("x"), several)->name, "hand_x") << several;
    EXPECT_EQ(kind_for_axes(kinds_called("Fz"), several)->name, "force_z") << several;
    EXPECT_EQ(kind_for_axes(kinds_called("F"), several), nullptr) << several;
  }
}

TEST(ChannelTable, EmgIsFoundByTheWordInANameWhateverTheMuscle) {
  for (const auto& [name, channel] : {std::pair{"emg_biceps", "emg_biceps"},
                                      {"EMG1", "emg_1"},
                                      {"Biceps EMG", "emg_biceps"},
                                      {"emg_triceps_mV", "emg_triceps"},
                                      {"EMG bic. brev. [uV]", "emg_bic_brev"},
                                      {"sEMG", "emg"},
                                      {"demography", ""},
                                      {"memg", ""},
                                      {"force_x", ""}}) {
    EXPECT_EQ(emg_channel(name), channel) << name;
  }
  EXPECT_EQ(kinds_called("emg_biceps").front()->name, "emg");
  EXPECT_TRUE(kinds_called("Biceps EMG").empty());  // in a map it begins with emg
  EXPECT_EQ(parse_column_name("emg_biceps_mV").unit, find_unit("mV"));
  EXPECT_EQ(parse_column_name("EMG biceps [uV]").unit, find_unit("uV"));
}

TEST(ChannelTable, NamesTheNearestWhateverItsCase) {
  EXPECT_EQ(nearest_channel_name("HNAD_X"), "hand_x");
  EXPECT_EQ(nearest_channel_name("vx"), "Vx");
  EXPECT_NE(nearest_channel_name("z"), "t");
}

}  // namespace
}  // namespace mbk::recording
