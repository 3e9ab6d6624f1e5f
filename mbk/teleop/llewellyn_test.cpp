#include "mbk/teleop/llewellyn.h"

#include <gtest/gtest.h>

#include "mbk/teleop/admissible.h"
#include "mbk/teleop/architectures.h"

namespace mbk::teleop {
namespace {

Teleoperator position_position(Rational b_m, Rational b_s, Rational d_m, Rational k_m, Rational d_s, Rational k_s) {
  Teleoperator t;
  t.values = {{"master.m", 0}, {"slave.m", 0}, {"master.b", b_m}, {"slave.b", b_s}, {"master.d", d_m},
              {"master.k", k_m}, {"slave.d", d_s}, {"slave.k", k_s}};
  return t;
}

TEST(Llewellyn, PositionPositionWithoutDampingNeedsEqualTimeConstants) {
  for (const auto& [k_s, holds] : {std::pair{200, true}, {210, false}, {190, false}}) {
    const auto network = position_position(0, 0, 10, 100, 20, k_s).equations().at(0);
    EXPECT_EQ(llewellyn(*network).verdict, holds ? StabilityVerdict::marginal : StabilityVerdict::unstable) << k_s;
  }
}

TEST(LargestShortage, OfPositionPositionIsTheClosedForm) {
  const auto a = largest_shortage(position_position(2, 3, 10, 100, 20, 200).equations(), Port::two);
  EXPECT_NEAR(a.value(), 19.0 / 3.0, 1e-12);
}

TEST(AdmissibleSet, OfSlaveStiffnessHasTwoSides) {
  const auto set = admissible_set(position_position(1, 1, 10, 100, 20, 200).equations("slave.k"), 0, 1000);
  ASSERT_TRUE(set) << set.error().line();
  for (auto& i : set->intervals) printf("[%.9f, %.9f]\n", i.low.value, i.high.value);
  for (auto& i : set->critical) printf("%.9f\n", i);
}

}  // namespace
}  // namespace mbk::teleop
