#include "mbk/base/dsp/difference_equation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::dsp {
namespace {

TEST(DifferenceEquation, AnswersAnImpulseWithPowersOfItsPole) {
  const Vector y = difference_equation(Vector{{2.0}}, Vector{{1.0, -0.5}}, Vector::Unit(20, 3));
  for (Index k = 0; k < 20; ++k) EXPECT_EQ(y[k], k < 3 ? 0.0 : 2.0 * std::pow(0.5, static_cast<double>(k - 3)));
}

TEST(DifferenceEquation, IsUndoneByItsInverse) {
  const Vector b{{1.0, 0.4, -0.1}}, a{{1.0, -1.2, 0.5, 0.05}};
  Vector u(50);
  for (Index k = 0; k < u.size(); ++k) u[k] = std::sin(0.3 * static_cast<double>(k * k));
  const Vector back = difference_equation(a, b, difference_equation(b, a, u));
  EXPECT_LT((back - u).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(DifferenceEquation, TakesSignalsShorterThanItsCoefficients) {
  const Vector b{{1.0, 2.0, 3.0, 4.0}}, one{{1.0}};
  EXPECT_EQ(difference_equation(b, one, Vector::Ones(2)), (Vector{{1.0, 3.0}}));
  EXPECT_EQ(difference_equation(one, b, Vector::Ones(2)), (Vector{{1.0, -1.0}}));
  EXPECT_EQ(difference_equation(b, one, Vector()).size(), 0);
}

}  // namespace
}  // namespace mbk::dsp
