#include "mbk/measure/preprocess/perturbation_only.h"

#include <gtest/gtest.h>

namespace mbk::preprocess {
namespace {

Recording ten_seconds() {
  Recording recording;
  recording.time = Vector::LinSpaced(101, 0.0, 10.0);
  recording.channels.push_back({"hand_x", "m", "base", Vector::LinSpaced(101, 0.0, 100.0)});
  recording.events = {{3.0, "perturbation_start", 0.0}, {4.0, "onset", 1.5}, {7.0, "perturbation_end", 0.0}};
  return recording;
}

TEST(PerturbationOnly, KeepsWhatLiesBetweenOnItsOwnClock) {
  const Recording cut = perturbation_only(ten_seconds());
  ASSERT_EQ(cut.samples(), 40);  // 3.0 … 6.9 s
  EXPECT_NEAR(cut.time[0], 0.0, 1e-12);
  EXPECT_NEAR(cut.time[39], 3.9, 1e-12);
  EXPECT_NEAR(cut.channels[0].values[0], 30.0, 1e-9);
  EXPECT_NEAR(cut.channels[0].values[39], 69.0, 1e-9);
  ASSERT_EQ(cut.events.size(), 3U);
  EXPECT_EQ(cut.events[1].name, "onset");
  EXPECT_NEAR(cut.events[1].time, 1.0, 1e-12);
  EXPECT_EQ(cut.notes.size(), 1U);
}

TEST(PerturbationOnly, MovesExcludedWindowsToItsClock) {
  Recording recording = ten_seconds();
  recording.metadata["excluded_windows"] = "1-2 s: before; 2-4.5 s: into; 5-6 s: within";
  EXPECT_EQ(perturbation_only(recording).metadata.at("excluded_windows"), "0-1.5 s: into; 2-3 s: within");
  recording.metadata["excluded_windows"] = "the first half";
  EXPECT_EQ(perturbation_only(recording).metadata.at("excluded_windows"), "the first half");
}

TEST(PerturbationOnly, GoesOnToTheLastSampleWhereTheEndIsMissing) {
  Recording recording = ten_seconds();
  recording.events.pop_back();
  EXPECT_EQ(perturbation_only(recording).samples(), 71);
}

TEST(PerturbationOnly, LeavesARecordingWithoutAStartAlone) {
  Recording recording = ten_seconds();
  recording.events.clear();
  const Recording same = perturbation_only(recording);
  EXPECT_EQ(same.samples(), 101);
  EXPECT_TRUE(same.notes.empty());
}

TEST(PerturbationOnly, LeavesARecordingAloneWhoseMarksHoldNoSample) {
  Recording recording = ten_seconds();
  recording.events = {{20.0, "perturbation_start", 0.0}};
  EXPECT_EQ(perturbation_only(recording).samples(), 101);
}

}  // namespace
}  // namespace mbk::preprocess
