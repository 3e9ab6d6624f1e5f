#include "mbk/base/dsp/autoregression.h"

#include <gtest/gtest.h>

#include "mbk/base/numeric/random.h"

namespace mbk::dsp {
namespace autoregression_test {

Vector white(Index samples) {
  numeric::Random random(3);
  Vector e(samples);
  for (double& value : e) value = random.normal();
  return e;
}

TEST(Autoregression, FindsItsCoefficientsAndOrder) {
  Vector e = white(20000);
  for (Index t = 2; t < e.size(); ++t) e[t] += 1.2 * e[t - 1] - 0.5 * e[t - 2];
  const Vector c = autoregression({e.head(9000), e.tail(11000)}, 20);
  ASSERT_EQ(c.size(), 3);
  constexpr double kFourErrors = 0.025;  // of 20,000 samples
  EXPECT_EQ(c[0], 1.0);
  EXPECT_NEAR(c[1], -1.2, kFourErrors);
  EXPECT_NEAR(c[2], 0.5, kFourErrors);
}

TEST(Autoregression, OfWhiteNoiseHasOrderZero) {
  EXPECT_EQ(autoregression({white(5000)}, 20).size(), 1);
}

TEST(Autoregression, OfNothingIsNothing) {
  EXPECT_EQ(autoregression({Vector::Zero(100)}, 5), Vector::Ones(1));
}

}  // namespace autoregression_test
}  // namespace mbk::dsp
