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
  const auto turned = turn_force(pushed_along_x(), 30.0 / kDegrees);
  ASSERT_TRUE(turned.has_value());
  EXPECT_NEAR(turned->find("force_x")->values[3], std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(turned->find("force_y")->values[3], 1.0, 1e-12);
  EXPECT_EQ(turned->find("hand_x")->values, pushed_along_x().time);
}

TEST(ForceRotation, NeedsAnAngleAndTwoAxes) {
  EXPECT_FALSE(turn_force(pushed_along_x(), std::nan("")));
  Recording one = pushed_along_x();
  one.channels.pop_back();
  EXPECT_FALSE(turn_force(one, 0.1));
}

}  // namespace force_rotation_test
}  // namespace mbk::preprocess
