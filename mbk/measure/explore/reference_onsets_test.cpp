#include "mbk/measure/explore/reference_onsets.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::explore {
namespace reference_onsets_test {

constexpr Index kRest = 50;

/// Levels from some samples on.
Vector levels(const std::vector<std::pair<Index, double>>& changes, Index rows) {
  Vector values = Vector::Zero(rows);
  for (const auto& [from, level] : changes) values.tail(rows - from).setConstant(level);
  return values;
}

TEST(ReferenceOnsets, AreWherePulsesBeginAndNotWhereTheyEnd) {
  const Vector pulses = levels({{100, 2.0}, {250, 0.0}, {400, -2.0}, {520, 0.0}}, 700);
  const auto onsets = reference_onsets(pulses, kRest);
  ASSERT_EQ(onsets.size(), 2u);
  EXPECT_EQ(onsets[0].sample, 100);
  EXPECT_EQ(onsets[0].step[0], 2.0);
  EXPECT_EQ(onsets[1].sample, 400);
  EXPECT_EQ(onsets[1].step[0], -2.0);
}

TEST(ReferenceOnsets, AreAllStepsOfAStaircase) {
  EXPECT_EQ(reference_onsets(levels({{100, 1.0}, {200, 2.0}, {300, 3.0}}, 400), kRest).size(), 3u);
}

TEST(ReferenceOnsets, TakeARampForOneMovement) {
  Vector ramp = levels({{160, 1.0}}, 300);
  for (Index i = 100; i < 160; ++i) ramp[i] = static_cast<double>(i - 99) / 61.0;
  const auto onsets = reference_onsets(ramp, kRest);
  ASSERT_EQ(onsets.size(), 1u);
  EXPECT_EQ(onsets[0].sample, 100);
  EXPECT_EQ(onsets[0].step[0], 1.0);
}

TEST(ReferenceOnsets, ArriveSlowlyAtTheEndOfAPulse) {
  Vector pulses = levels({{100, 2.0}, {250, 0.0}, {400, 2.0}, {520, 0.0}}, 700);
  for (const Index back : {250, 520}) pulses.segment(back, 2) << 3e-6, 1.5e-6;  // steps within rounding of a rest
  const auto onsets = reference_onsets(pulses, kRest);
  ASSERT_EQ(onsets.size(), 2u);
  EXPECT_EQ(onsets[1].sample, 400);
  EXPECT_EQ(onsets[1].step[0], 2.0);
}

TEST(ReferenceOnsets, NeedARestBefore) {
  EXPECT_TRUE(reference_onsets(levels({{30, 1.0}}, 300), kRest).empty());
  EXPECT_TRUE(reference_onsets(Matrix::Zero(300, 2), kRest).empty());
  EXPECT_TRUE(reference_onsets(Matrix(0, 1), kRest).empty());
  Vector sine(1000);
  for (Index i = 0; i < sine.size(); ++i) sine[i] = std::sin(0.05 * static_cast<double>(i));
  EXPECT_TRUE(reference_onsets(sine, kRest).empty());
}

}  // namespace reference_onsets_test
}  // namespace mbk::explore
