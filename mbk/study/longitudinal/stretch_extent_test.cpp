#include "mbk/study/longitudinal/stretch_extent.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/study/longitudinal/course.h"
#include "mbk/study/longitudinal/normal_range.h"
#include "mbk/study/longitudinal/side_difference.h"
#include "mbk/study/store/test_study.h"

namespace mbk::longitudinal {
namespace {

constexpr const char* kTorque = "stretch_increasing_torque";
constexpr const char* kSlope = "stretch_increasing_slope";

/// Recordings 1 and 2 agree, 3 is slower, 4 is of fewer positions, 5 has 83 % of the positions of 1.
StretchExtents five_recordings() {
  StretchExtents extents;
  extents.set(1, 1, {120.0, 60.0, 120.0, "°"});
  extents.set(2, 1, {112.0, 62.0, 122.0, "°"});
  extents.set(3, 1, {60.0, 60.0, 120.0, "°"});
  extents.set(4, 1, {120.0, 60.0, 90.0, "°"});
  extents.set(5, 1, {120.0, 60.0, 110.0, "°"});
  return extents;
}

TEST(StretchExtents, SpeedMattersForOutcomesOfTheFastestSpeed) {
  const StretchExtents extents = five_recordings();
  for (const char* name : {"torque", "work", "catch"}) {
    const std::string outcome = std::string("stretch_increasing_") + name;
    EXPECT_TRUE(extents.comparable(outcome, {1}, {2})) << name;
    EXPECT_FALSE(extents.comparable(outcome, {1}, {3})) << name;
  }
  for (const char* name : {"slope", "rise", "threshold"}) {
    EXPECT_TRUE(extents.comparable(std::string("stretch_increasing_") + name, {1}, {3})) << name;
  }
  EXPECT_EQ(extents.difference(kTorque, {3}, {1}, "", "before "), "60 °/s, before 120 °/s");
}

TEST(StretchExtents, PositionsMatterForAllOutcomesInBothDirections) {
  const StretchExtents extents = five_recordings();
  for (const char* name : {"torque", "work", "catch", "slope", "rise", "threshold"}) {
    const std::string outcome = std::string("stretch_increasing_") + name;
    EXPECT_FALSE(extents.comparable(outcome, {1}, {4})) << name;
    EXPECT_FALSE(extents.comparable(outcome, {4}, {1})) << name;
    EXPECT_TRUE(extents.comparable(outcome, {1}, {5})) << name;
  }
  EXPECT_EQ(extents.difference(kSlope, {4}, {1}, "left ", "right "), "left 60 to 90°, right 60 to 120°");
}

TEST(StretchExtents, AllRecordingsOfASessionCount) {
  const StretchExtents extents = five_recordings();
  EXPECT_FALSE(extents.comparable(kSlope, {1, 4}, {}));
  EXPECT_FALSE(extents.comparable(kSlope, {2}, {1, 4}));
  EXPECT_FALSE(extents.comparable(kSlope, {1}, {9})) << "nothing is known of 9";
  EXPECT_FALSE(extents.comparable("stretch_decreasing_slope", {1}, {2})) << "nothing is known of that direction";
  EXPECT_TRUE(extents.comparable("K", {1}, {9}));
}

TEST(StretchExtents, AreReadFromStoredResults) {
  store::TestFolder folder;
  store::Store study = store::new_study(folder / "s");
  ASSERT_TRUE(store::add(study, folder.file("r.csv", "1"), {.participant = 1}));
  const auto units = study.pending("{}", "1.0", false).value();
  const std::vector<store::UnitResult> results = {
      {R"({"units":{"K":"N·m/rad"},"stretch":{"axis":0,"directions":[{"direction":-1,"range":[1,2],"speeds":[)"
       R"({"speed":0.5,"mean_torque":{"value":1}},{"speed":2,"mean_torque":{"value":2}}]}]}})",
       true, ""}};
  ASSERT_TRUE(study.save("{}", "1.0", units, results, store::Role::analyst));
  const auto list = store::list_study(study, {}).value();
  const auto columns = study.columns(1).value();
  const auto extents = stretch_extents(study, list, columns);
  ASSERT_TRUE(extents) << extents.error().message;
  const std::int64_t recording = columns.trials.at(0).recording;
  StretchExtents other = *extents;
  other.set(999, -1, {114.6, 57.3, 114.6, "°"});  // the same in degrees
  EXPECT_TRUE(other.comparable("stretch_decreasing_torque", {recording}, {999}));
  other.set(999, -1, {57.3, 57.3, 114.6, "°"});
  EXPECT_FALSE(other.comparable("stretch_decreasing_torque", {recording}, {999}));
}

/// People with two sessions of both sides, one recording each.
struct StretchedStudy {
  store::OutcomeColumns columns{{"left", "right"}, {}, {{kTorque, "N·m", {}, {}}, {kSlope, "N·m·s/rad", {}, {}}}};
  StretchExtents extents;

  explicit StretchedStudy(int people) {
    for (int p = 1; p <= people; ++p) {
      for (int s = 1; s <= 2; ++s) {
        for (int side = 0; side < 2; ++side) {
          const auto recording = static_cast<std::int64_t>(std::ssize(columns.trials)) + 1;
          columns.trials.push_back({recording, p, s, 1, side});
          const double value = 1.0 + 0.1 * p + 0.02 * std::sin(9.7 * p + 5.3 * s + 3.1 * side);
          for (auto& outcome : columns.outcomes) outcome.values.push_back(value);
          extents.set(recording, 1, {120.0, 60.0, 120.0, "°"});
        }
      }
    }
  }

  void stretch(int person, int session, int side, StretchExtent extent, double value) {
    for (std::size_t k = 0; k < columns.trials.size(); ++k) {
      const store::TrialRow& trial = columns.trials[k];
      if (trial.participant != person || trial.session != session || trial.condition != side) continue;
      extents.set(trial.recording, 1, extent);
      for (auto& outcome : columns.outcomes) outcome.values[k] = value;
    }
  }
};

const StretchExtent kShort = {120.0, 60.0, 90.0, "°"}, kSlow = {60.0, 60.0, 120.0, "°"};

TEST(ComparableResults, ControlsOfAnotherExtentDoNotCount) {
  StretchedStudy study(8);
  study.stretch(2, 2, 0, kShort, 50.0);
  study.stretch(3, 2, 0, kSlow, 90.0);
  const auto ranges = outcome_ranges(study.columns, 1, {2, 3, 4, 5, 6, 7, 8}, study.extents);
  ASSERT_EQ(ranges.size(), 4U);  // of both sides
  EXPECT_EQ(ranges[0].normal.controls, 5);
  EXPECT_EQ(ranges[0].normal.not_comparable, 2);
  EXPECT_LT(ranges[0].normal.range95.second, 10.0);
  EXPECT_EQ(ranges[1].normal.controls, 6) << "the slope of 3 is comparable";
  EXPECT_EQ(ranges[2].normal.not_comparable, 0);
  study.stretch(1, 2, 0, kShort, 1.0);
  const auto own = outcome_ranges(study.columns, 1, {2, 3, 4, 5, 6, 7, 8}, study.extents);
  EXPECT_EQ(own[0].normal.controls, 1);
  EXPECT_EQ(own[0].verdict, RangeVerdict::unknown);
  EXPECT_NE(own[0].why_not_comparable, "");
}

TEST(ComparableResults, SidesOfAnotherExtentHaveNoVerdict) {
  StretchedStudy study(10);
  study.stretch(1, 2, 0, kShort, 5.0);
  study.stretch(2, 2, 0, kSlow, 50.0);
  const auto all = side_differences(study.columns, 1, {2, 3, 4, 5, 6, 7, 8, 9, 10}, study.extents);
  ASSERT_EQ(all.size(), 2U);
  for (const SideDifference& one : all) {
    EXPECT_EQ(one.why_not_comparable, "left 60 to 90°, right 60 to 120°");
    EXPECT_EQ(one.verdict, ChangeVerdict::unknown);
    EXPECT_EQ(one.range_verdict, RangeVerdict::unknown);
  }
  // Neither does the slower side of person 2 widen the error or the range of others.
  const auto other = side_differences(study.columns, 3, {2, 4, 5, 6, 7, 8, 9, 10}, study.extents);
  EXPECT_EQ(other.at(0).why_not_comparable, "");
  EXPECT_EQ(other[0].normal.controls, 7);
  EXPECT_EQ(other[0].normal.not_comparable, 1);
  EXPECT_LT(other[0].error, 1.0);
}

TEST(ComparableResults, SessionsOfAnotherExtentHaveNoVerdict) {
  StretchedStudy study(10);
  study.stretch(1, 2, 0, kSlow, 5.0);
  study.stretch(2, 2, 0, kShort, 50.0);
  const auto courses_of = [&](std::int64_t person) {
    const auto statistics = statistics::study_statistics(comparable_columns(study.columns, study.extents, person));
    EXPECT_TRUE(statistics);
    return courses(study.columns, *statistics, person, study.extents);
  };
  const auto first = courses_of(1);
  ASSERT_EQ(first.size(), 4U);
  for (const OutcomeCourses& one : first) {
    const Change& change = one.courses.at(0).changes.at(0);
    if (one.condition != "left" || one.outcome != kTorque) {
      EXPECT_EQ(change.why_not_comparable, "") << one.outcome;
      continue;
    }
    EXPECT_EQ(change.why_not_comparable, "60 °/s, before 120 °/s");
    EXPECT_EQ(change.verdict, ChangeVerdict::unknown);
  }
  // The minimal detectable change of others is from comparable sessions alone.
  for (const OutcomeCourses& one : courses_of(3)) {
    const Change& change = one.courses.at(0).changes.at(0);
    EXPECT_EQ(change.verdict, ChangeVerdict::within_error) << one.outcome;
    if (one.outcome == kTorque) {
      EXPECT_LT(change.mdc, 1.0);
    }
  }
}

}  // namespace
}  // namespace mbk::longitudinal
