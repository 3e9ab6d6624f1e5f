#include "mbk/measure/preprocess/force_rotation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/base/core/units.h"

namespace mbk::preprocess {
namespace force_rotation_test {

Recording pushed_along_x() {
  Recording made;
  made.time = Vector::LinSpaced(5, 0.0, 0.004);
  made.channels = {{"hand_x", "m", "base", made.time},
                   {"force_x", "N", "base", Vector::Constant(5, 2.0)},
                   {"force_y", "N", "base", Vector::Zero(5)}};
  return made;
}

TEST(ForceRotation, TurnsFromXToY) {
  const auto turned = turn_force(pushed_along_x(), {0.0, 0.0, 30.0 / kDegrees});
  ASSERT_TRUE(turned.has_value());
  EXPECT_NEAR(turned->find("force_x")->values[3], std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(turned->find("force_y")->values[3], 1.0, 1e-12);
  EXPECT_EQ(turned->find("hand_x")->values, pushed_along_x().time);
}

TEST(ForceRotation, TurnsAboutAnyAxisInSpace) {
  Recording space = pushed_along_x();
  EXPECT_FALSE(turn_force(space, {0.1, 0.0, 0.0}));
  space.channels.push_back({"force_z", "N", "base", Vector::Constant(5, 1.0)});
  // About y by 90°, from z to x: (2, 0, 1) becomes (1, 0, -2).
  const auto about_y = turn_force(space, {0.0, 90.0 / kDegrees, 0.0});
  ASSERT_TRUE(about_y.has_value());
  EXPECT_NEAR(about_y->find("force_x")->values[3], 1.0, 1e-12);
  EXPECT_NEAR(about_y->find("force_y")->values[3], 0.0, 1e-12);
  EXPECT_NEAR(about_y->find("force_z")->values[3], -2.0, 1e-12);
  // By 120° about (1, 1, 1): x becomes y, y becomes z, z becomes x.
  const double each = 120.0 / kDegrees / std::sqrt(3.0);
  const auto cyclic = turn_force(space, {each, each, each});
  ASSERT_TRUE(cyclic.has_value());
  EXPECT_NEAR(cyclic->find("force_x")->values[3], 1.0, 1e-12);
  EXPECT_NEAR(cyclic->find("force_y")->values[3], 2.0, 1e-12);
  EXPECT_NEAR(cyclic->find("force_z")->values[3], 0.0, 1e-12);
  // About z the force along z remains.
  const auto about_z = turn_force(space, {0.0, 0.0, 30.0 / kDegrees});
  ASSERT_TRUE(about_z.has_value());
  EXPECT_EQ(about_z->find("force_z")->values, space.find("force_z")->values);
}

TEST(ForceRotation, NeedsAnAngleAndTwoAxes) {
  EXPECT_FALSE(turn_force(pushed_along_x(), {0.0, 0.0, std::nan("")}));
  Recording one = pushed_along_x();
  one.channels.pop_back();
  EXPECT_FALSE(turn_force(one, {0.0, 0.0, 0.1}));
}

}  // namespace force_rotation_test
}  // namespace mbk::preprocess
