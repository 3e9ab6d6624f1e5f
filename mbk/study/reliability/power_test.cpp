#include "mbk/study/reliability/power.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::reliability {
namespace power_test {

/// R 4.2.2, power.t.test(delta = d, power = 0.8), rounded up.
TEST(Power, PeopleAreAsManyAsRSays) {
  const struct {
    double d;
    int unpaired, paired;
  } kCases[] = {{0.2, 394, 199}, {0.5, 64, 34}, {0.8, 26, 15}};
  for (const auto& [d, unpaired, paired] : kCases) {
    EXPECT_EQ(people_for_effect(d, 0.8, Pairing::unpaired), unpaired);
    EXPECT_EQ(people_for_effect(-d, 0.8, Pairing::paired), paired);
  }
  // power.t.test(n = 20, delta = 0.7, strict = TRUE)
  EXPECT_NEAR(power_of_t_test(0.7, 20, Pairing::unpaired), 0.57829043101803, 1e-9);
  EXPECT_NEAR(power_of_t_test(1e-12, 20, Pairing::unpaired, 0.05), 0.05, 1e-9);
}

TEST(Power, IsTheShareOfStudiesThatFindTheDifference) {
  constexpr int kStudies = 1500, kPeople = 9;
  numeric::Random random(8);
  for (const Pairing pairing : {Pairing::unpaired, Pairing::paired}) {
    int found = 0;
    for (int study = 0; study < kStudies; ++study) {
      Vector first(kPeople), second(kPeople);
      for (Index i = 0; i < kPeople; ++i) {
        first[i] = pairing == Pairing::paired ? 0.0 : random.normal();
        second[i] = 1.0 + random.normal();
      }
      found += difference(first, second, pairing)->p <= 0.05 ? 1 : 0;
    }
    const auto [low, high] = numeric::binomial_interval(found, kStudies, 0.999);
    const double power = power_of_t_test(1.0, kPeople, pairing);
    EXPECT_GE(power, low);
    EXPECT_LE(power, high + 0.005);  // Welch's degrees of freedom are a little fewer
  }
}

TEST(Power, RefusesWhatHasNoAnswer) {
  EXPECT_FALSE(people_for_effect(0.0, 0.8, Pairing::paired));
  EXPECT_FALSE(people_for_effect(0.5, 1.0, Pairing::paired));
  EXPECT_FALSE(people_for_effect(0.5, 0.04, Pairing::paired, 0.05));
  EXPECT_FALSE(people_for_effect(1e-6, 0.8, Pairing::paired));
}

}  // namespace power_test
}  // namespace mbk::reliability
