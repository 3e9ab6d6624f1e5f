#include "mbk/measure/preprocess/exclusions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace mbk::preprocess {
namespace exclusions_test {

using testing::HasSubstr;

constexpr double kRate = 100.0;

TEST(ExcludedWindows, AreReadAsTheyWereWritten) {
  const std::vector<ExcludedWindow> windows = {{1.5, 4.0, "spoke; laughed"}, {7.0, 9.25, "3-4 s: of a cough"}};
  const std::string text = excluded_windows_text(windows);
  EXPECT_EQ(text, "1.5-4 s: spoke; laughed; 7-9.25 s: 3-4 s: of a cough");
  const auto read = parse_excluded_windows(text);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->size(), 2U);
  for (std::size_t k = 0; k < windows.size(); ++k) {
    EXPECT_EQ((*read)[k].from_s, windows[k].from_s);
    EXPECT_EQ((*read)[k].to_s, windows[k].to_s);
    EXPECT_EQ((*read)[k].why, windows[k].why);
  }
  EXPECT_EQ(excluded_windows_text(*read), text);
  EXPECT_TRUE(parse_excluded_windows("")->empty());
}

TEST(ExcludedWindows, AreReadWhateverTheirTimes) {
  for (const double from : {0.0, 1e-5, 0.123, 12.5, 3599.25}) {
    const ExcludedWindow window{from, from + 0.5, "x"};
    const auto read = parse_excluded_windows(excluded_windows_text({&window, 1}));
    ASSERT_TRUE(read) << from;
    EXPECT_NEAR(read->front().from_s, from, 1e-5 * from) << from;
  }
}

TEST(ExcludedWindows, ThatCannotBeReadAreRefused) {
  for (const char* text : {"the first half", "4-1.5 s: backwards", "1-1 s: nothing", "1-nan s: x", "1.5 s: half"}) {
    const auto read = parse_excluded_windows(text);
    ASSERT_FALSE(read) << text;
    EXPECT_THAT(read.error().message, HasSubstr(text));
  }
}

/// A plan of one cut of 20 s, identified up to 16 s.
WindowPlan sustained() {
  WindowPlan plan;
  plan.rule = "0 s to 20 s";
  plan.cuts = {{0, 2000, {{0, 1600, Purpose::identification}, {1600, 2000, Purpose::validation}}}};
  return plan;
}

Result<WindowPlan> without(const std::vector<ExcludedWindow>& windows, WindowPlan plan = sustained(),
                           bool displacements = false, double origin = 0.0) {
  const Vector time = origin + Vector::LinSpaced(2000, 0.0, 19.99).array();
  const Clock clock(time, Hertz(kRate));
  if (auto ok = leave_out(windows, clock, origin, displacements, plan); !ok) return tl::unexpected(ok.error());
  return plan;
}

TEST(LeaveOut, CutsAWindowOutOfASustainedPerturbationAndSaysSo) {
  const auto plan = without({{5.0, 7.0, "coughed"}});
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->cuts.size(), 2U);
  EXPECT_EQ(plan->cuts[0].begin, 0);
  EXPECT_EQ(plan->cuts[0].end, 500);
  EXPECT_EQ(plan->cuts[1].begin, 701);  // both ends are excluded
  EXPECT_EQ(plan->cuts[1].end, 2000);
  ASSERT_EQ(plan->cuts[1].keep.size(), 2U);
  EXPECT_EQ(plan->cuts[1].keep[1].begin, 1600);
  EXPECT_EQ(plan->cuts[1].keep[1].purpose, Purpose::validation);
  EXPECT_EQ(plan->rule, "0 s to 20 s; omitted: 5 s to 7 s, excluded: coughed");
}

TEST(LeaveOut, CountsWindowsOnTheClockOfTheRecording) {
  const auto plan = without({{105.0, 107.0, "coughed"}}, sustained(), false, 100.0);
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->cuts.size(), 2U);
  EXPECT_EQ(plan->cuts[1].begin, 701);
}

TEST(LeaveOut, TakesWindowsInAnyOrderAndOverlapping) {
  const auto plan = without({{12.0, 13.0, "b"}, {5.0, 9.0, "a"}, {6.0, 7.0, "c"}});
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->cuts.size(), 3U);
  EXPECT_EQ(plan->cuts[1].begin, 901);
  EXPECT_EQ(plan->cuts[1].end, 1200);
}

TEST(LeaveOut, DropsWhatIsTooShortBesideAWindow) {
  const auto plan = without({{1.0, 7.0, "coughed"}});
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->cuts.size(), 1U);
  EXPECT_EQ(plan->cuts[0].begin, 701);
}

TEST(LeaveOut, LeavesAPlanAloneThatNoWindowTouches) {
  WindowPlan late = sustained();
  late.cuts[0].begin = late.cuts[0].keep[0].begin = 800;
  const auto plan = without({{1.0, 7.0, "coughed"}, {30.0, 40.0, "after it"}}, late);
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->cuts.size(), 1U);
  EXPECT_EQ(plan->rule, late.rule);
  EXPECT_TRUE(plan->excluded.empty());
}

TEST(LeaveOut, DropsDisplacementsThatAWindowTouches) {
  WindowPlan pulses;
  for (Index k = 0; k < 4; ++k) {
    const Segment pulse{400 * k + 100, 400 * k + 200, Purpose::identification};
    pulses.cuts.push_back({pulse.begin, pulse.end, {pulse}});
  }
  const auto plan = without({{5.5, 6.5, "moved"}, {10.5, 12.0, "between two"}}, pulses, true);
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->cuts.size(), 3U);
  EXPECT_EQ(plan->cuts[1].begin, 900);
}

TEST(LeaveOut, RefusesWhereNothingIsLeft) {
  const auto plan = without({{0.0, 20.0, "slept"}});
  ASSERT_FALSE(plan);
  EXPECT_THAT(plan.error().message, HasSubstr("slept"));
}

TEST(Blanked, KeepsTheReferenceAndEverythingOutside) {
  Recording recording;
  recording.time = Vector::LinSpaced(11, 0.0, 10.0);
  recording.channels.push_back({"force_x", "N", "base", Vector::Ones(11)});
  recording.channels.push_back({"reference_x", "m", "base", Vector::Ones(11)});
  const Recording blank = blanked(recording, std::vector<ExcludedWindow>{{2.5, 4.0, "x"}});
  for (Index i = 0; i < 11; ++i) {
    EXPECT_EQ(std::isnan(blank.channels[0].values[i]), i == 3 || i == 4) << i;
    EXPECT_EQ(blank.channels[1].values[i], 1.0);
  }
}

}  // namespace exclusions_test
}  // namespace mbk::preprocess
