#include "mbk/measure/explore/reference_ramps.h"

#include <gtest/gtest.h>

#include "mbk/measure/explore/test_ramps.h"

namespace mbk::explore {
namespace reference_ramps_test {

constexpr double kT = 0.001, kShortest = 0.01;

TEST(ReferenceRamps, AreTheWaysOutAndNotTheWaysBack) {
  const RampsOfLimb limb;
  const auto ramps = find_ramps(ramps_of(limb).reference, kT, kShortest);
  ASSERT_EQ(ramps.size(), 24U);
  const double cycle = limb.pause + 2.0 * limb.ramp + limb.hold;
  for (std::size_t k = 0; k < ramps.size(); ++k) {
    const double onset = cycle * static_cast<double>(k) + limb.pause;
    EXPECT_NEAR(static_cast<double>(ramps[k].onset) * kT, onset, 0.005);  // a ramp begins flat
    EXPECT_NEAR(static_cast<double>(ramps[k].held) * kT, onset + limb.ramp, 0.005);
    EXPECT_NEAR(static_cast<double>(ramps[k].hold_end) * kT, onset + limb.ramp + limb.hold, 0.006);
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k % 8) / 8.0;
    EXPECT_NEAR((ramps[k].commanded - 0.006 * Vector{{std::cos(angle), std::sin(angle)}}).norm(), 0.0, 1e-6);
  }
}

TEST(ReferenceRamps, AreFoundWhereAFileRoundsTheReference) {
  Matrix reference = ramps_of({}).reference;
  reference = (reference * 1e6).array().round().matrix() * 1e-6;
  EXPECT_EQ(find_ramps(reference, kT, kShortest).size(), 24U);
}

TEST(ReferenceRamps, AreNoSteps) {
  Matrix reference = Matrix::Zero(4000, 2);
  for (Index i = 0; i < 4000; ++i) reference(i, 0) = (i / 500) % 2 == 1 ? 0.005 : 0.0;
  EXPECT_TRUE(find_ramps(reference, kT, kShortest).empty());
  EXPECT_EQ(find_ramps(reference, kT, 0.0).size(), 4U);
}

TEST(ReferenceRamps, AreNowhereInSinesOrInAReferenceThatRests) {
  Matrix sines(5000, 2);
  for (Index i = 0; i < 5000; ++i) {
    const double t = static_cast<double>(i) * kT;
    sines.row(i) << 0.01 * std::sin(9.0 * t), 0.01 * std::cos(7.0 * t);
  }
  EXPECT_TRUE(find_ramps(sines, kT, kShortest).empty());
  EXPECT_TRUE(find_ramps(Matrix::Constant(500, 2, 0.3), kT, kShortest).empty());
  EXPECT_TRUE(find_ramps(Matrix(), kT, kShortest).empty());
}

}  // namespace reference_ramps_test
}  // namespace mbk::explore
