#include "mbk/model/impedance/model.h"

#include <gtest/gtest.h>

namespace mbk::impedance {
namespace {

TEST(Model, StacksItsNumbersRowByRowAndBack) {
  Vector numbers = Vector::LinSpaced(14, 1.0, 14.0);
  const Model model = unstacked(numbers, 2);
  EXPECT_EQ(model.M(0, 1), 2.0);
  EXPECT_EQ(model.M(1, 0), 3.0);
  EXPECT_EQ(model.K(1, 1), 12.0);
  EXPECT_EQ(model.x0[1], 14.0);
  EXPECT_EQ(stacked(model), numbers);
  EXPECT_EQ(stacked(unstacked(numbers.head(4), 1)), numbers.head(4));
}

}  // namespace
}  // namespace mbk::impedance
