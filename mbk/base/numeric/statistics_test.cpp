#include "mbk/base/numeric/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/random.h"

namespace mbk::numeric {
namespace {

TEST(Statistics, VarianceIsNormalisedByOneLessThanTheCount) {
  EXPECT_DOUBLE_EQ(variance((Vector(4) << 1, 2, 3, 4).finished()), 5.0 / 3.0);
  EXPECT_EQ(variance(Vector::Constant(1, 3.0)), 0.0);
  EXPECT_EQ(variance(Vector()), 0.0);
}

TEST(Statistics, VarianceKeepsItsDigitsFarFromZero) {
  EXPECT_NEAR(variance((Vector(3) << 1e9 + 1, 1e9 + 2, 1e9 + 3).finished()), 1.0, 1e-9);
}

TEST(Statistics, VarianceIsThatOfThePlainSumForAnyLength) {
  for (const Index count : {2, 3, 15, 16, 31, 32, 33, 1000, 4099}) {
    const Vector values = Vector::Random(count).array() + 3.0;
    double mean = 0.0, squares = 0.0;
    for (const double value : values) mean += value / static_cast<double>(count);
    for (const double value : values) squares += (value - mean) * (value - mean);
    const double want = squares / static_cast<double>(count - 1);
    EXPECT_NEAR(variance(values), want, 1e-12 * want) << count << " values";
    EXPECT_NEAR(variance(values.tail(count - 1)), variance(Vector(values.tail(count - 1))), 1e-14) << count;
  }
}

TEST(Statistics, ExtremesAreThoseOfThePlainSearchForAnyLengthAndPlace) {
  for (const Index count : {1, 2, 15, 16, 31, 32, 33, 100, 1000, 4099}) {
    Vector values = Vector::Random(count).array() - 3.0;
    const Extremes found = finite_extremes(values);
    EXPECT_EQ(found.min, values.minCoeff()) << count << " values";
    EXPECT_EQ(found.max, values.maxCoeff()) << count;
    for (Index at = 0; at < count; at += 1 + count / 97) {
      Vector other = values;
      other[at] = 7.0;
      EXPECT_EQ(finite_extremes(other).max, 7.0) << at;
      other[at] = -7.0;
      EXPECT_EQ(finite_extremes(other).min, -7.0) << at;
    }
  }
}

TEST(Statistics, ThereAreNoExtremesWhereOneValueIsNotFinite) {
  EXPECT_TRUE(std::isnan(finite_extremes(Vector()).min));
  EXPECT_TRUE(std::isnan(finite_extremes(Vector()).max));
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double other : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity}) {
    for (const Index count : {1, 31, 33, 200}) {
      for (Index at = 0; at < count; ++at) {
        Vector values = Vector::Random(count);
        values[at] = other;
        EXPECT_TRUE(std::isnan(finite_extremes(values).min)) << at << " of " << count;
        EXPECT_TRUE(std::isnan(finite_extremes(values).max)) << at << " of " << count;
        EXPECT_EQ(first_non_finite(values), at);
      }
      EXPECT_EQ(first_non_finite(Vector::Random(count)), -1);
    }
  }
}

TEST(Statistics, VarianceAccountedForIgnoresAnOffsetAndMayBeNegative) {
  const Vector force = (Vector(4) << 1, -1, 1, -1).finished();
  EXPECT_DOUBLE_EQ(variance_accounted_for(force, Vector::Constant(4, 7.0)), 100.0);
  EXPECT_DOUBLE_EQ(variance_accounted_for(force, 0.5 * force), 75.0);
  EXPECT_DOUBLE_EQ(variance_accounted_for(force, 2.0 * force), -300.0);
  EXPECT_TRUE(std::isnan(variance_accounted_for(Vector::Ones(4), force)));
}

TEST(Statistics, StudentQuantileIsThatOfTheTables) {
  // mpmath with 30 digits; of two degrees √2 (2p − 1)/√(1 − (2p − 1)²)
  EXPECT_NEAR(student_quantile(0.975, 1), 12.7062047361747, 1e-11);
  EXPECT_NEAR(student_quantile(0.95, 2), std::sqrt(2.0) * 0.9 / std::sqrt(1.0 - 0.81), 1e-12);
  EXPECT_NEAR(student_quantile(0.975, 5), 2.57058183563631, 1e-12);
  EXPECT_NEAR(student_quantile(0.05, 15), -1.75305035569257, 1e-12);
  EXPECT_NEAR(student_quantile(0.975, 1000), 1.96233908082641, 1e-12);
  EXPECT_NEAR(student_quantile(0.5, 3), 0.0, 1e-15);
}

TEST(Statistics, ChiSquareQuantileIsThatOfTheTables) {
  EXPECT_NEAR(chi_square_quantile(0.95, 1), std::pow(kNormal95, 2), 1e-12);   // of one normal, squared
  EXPECT_NEAR(chi_square_quantile(0.975, 2), -2.0 * std::log(0.025), 1e-12);  // exponential
  EXPECT_NEAR(chi_square_quantile(0.025, 2), -2.0 * std::log(0.975), 1e-12);
  EXPECT_NEAR(chi_square_quantile(0.975, 10), 20.4831773507, 1e-9);
}

TEST(Statistics, StudentQuantileTendsToTheNormal) {
  EXPECT_NEAR(normal_probability(student_quantile(0.975, 1000000)), 0.975, 1e-6);  // they differ by about z³/4ν
  EXPECT_NEAR(normal_probability(kNormal95), 0.975, 1e-15);
}

TEST(Statistics, QuantileLiesBetweenTheSortedValues) {
  const Vector sorted = (Vector(4) << 1, 2, 4, 8).finished();
  EXPECT_EQ(quantile(sorted, 0.0), 1.0);
  EXPECT_EQ(quantile(sorted, 0.5), 3.0);
  EXPECT_EQ(quantile(sorted, 1.0), 8.0);
  EXPECT_EQ(quantile(Vector::Ones(1), 0.7), 1.0);
  EXPECT_TRUE(std::isnan(quantile(Vector(), 0.5)));
}

TEST(Statistics, TheMedianIsInTheMiddle) {
  EXPECT_EQ(median({8, 1, 4, 2}), 3.0);
  EXPECT_EQ(median({8, 1, 4}), 4.0);
  EXPECT_EQ(upper_median({8, 1, 4, 2}), 4.0);
  EXPECT_EQ(upper_median({8, 1, 4}), 4.0);
  EXPECT_EQ(median({7}), 7.0);
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_TRUE(std::isnan(upper_median({})));
}

TEST(Statistics, TheMedianOfManyIsThatOfSortedValues) {
  Random random(5);
  for (const std::size_t count : {4095u, 4096u, 4097u, 5000u, 20001u}) {
    // Far apart, many alike, one beside few others, and in an order that misleads a sample.
    for (const double grain : {0.0, 0.1, 3.0, 100.0}) {
      std::vector<double> values(count);
      for (double& value : values) {
        const double drawn = 10.0 * random.normal();
        value = grain > 0.0 ? grain * std::round(drawn / grain) : drawn;
      }
      std::vector<double> misleading = values;
      for (std::size_t k = 0; k < count; k += count / 255) misleading[k] = 1e6 + static_cast<double>(k);
      for (const std::vector<double>& given : {values, misleading}) {
        std::vector<double> sorted = given;
        std::ranges::sort(sorted);
        const double upper = sorted[count / 2], lower = sorted[count / 2 - 1];
        EXPECT_EQ(upper_median(given), upper) << count << " values, " << grain;
        EXPECT_EQ(median(given), count % 2 == 1 ? upper : 0.5 * (lower + upper)) << count << " values, " << grain;
      }
    }
  }
}

TEST(Statistics, TheMedianOfManyIsTheSame) {
  Random random(5);
  for (const std::size_t count : {1U, 2U, 200'001U, 200'002U, 300'000U}) {
    for (const double step : {0.0, 1e-3, 0.25}) {  // of what values are rounded to: the last leaves few different ones
      std::vector<double> values(count);
      for (double& value : values) {
        value = 0.001 + random.uniform(0.0, 1.0);
        if (step > 0.0) value = step * std::floor(value / step);
      }
      const auto in_three = [&](const std::function<void(std::span<const double>)>& use) {
        const std::span<const double> all(values);
        const std::size_t third = all.size() / 3;
        for (std::size_t k = 0; k < 3; ++k) use(all.subspan(k * third, k < 2 ? third : all.size() - 2 * third));
      };
      EXPECT_EQ(median_of_many(static_cast<Index>(count), in_three), median(values)) << count << " values, " << step;
    }
  }
  EXPECT_TRUE(std::isnan(median_of_many(0, [](const auto&) {})));
}

TEST(Statistics, BinomialIntervalIsClopperAndPearsons) {
  // Beta quantiles: B(0.005; 380, 21) and B(0.995; 381, 20), from SciPy.
  const auto [lower, upper] = binomial_interval(380, 400, 0.99);
  EXPECT_NEAR(lower, 0.9149188396, 1e-9);
  EXPECT_NEAR(upper, 0.9738313266, 1e-9);
  EXPECT_EQ(binomial_interval(0, 10, 0.95).first, 0.0);
  EXPECT_NEAR(binomial_interval(0, 10, 0.95).second, 1.0 - std::pow(0.025, 0.1), 1e-12);  // closed form
  EXPECT_EQ(binomial_interval(10, 10, 0.95).second, 1.0);
}

TEST(Statistics, BinomialTailsAreSumsOfTheirTerms) {
  constexpr int kTrials = 12;
  for (const double share : {0.0, 0.03, 0.5, 0.8, 1.0}) {
    double below = 0.0;
    for (int k = 0; k <= kTrials; ++k) {
      EXPECT_NEAR(binomial_at_least(k, kTrials, share), 1.0 - below, 1e-14);
      below += std::exp(std::lgamma(kTrials + 1.0) - std::lgamma(k + 1.0) - std::lgamma(kTrials - k + 1.0)) *
               std::pow(share, k) * std::pow(1.0 - share, kTrials - k);
      EXPECT_NEAR(binomial_at_most(k, kTrials, share), below, 1e-14);
    }
  }
  EXPECT_EQ(binomial_at_least(kTrials + 1, kTrials, 0.5), 0.0);
  EXPECT_EQ(binomial_at_most(-1, kTrials, 0.5), 0.0);
}

TEST(Statistics, BinomialTailsSayOnWhichSideOfAShareTheIntervalEnds) {
  for (int k = 0; k <= 40; ++k) {
    const auto [lower, upper] = binomial_interval(k, 40, 0.95);
    for (double share = 0.01; share < 1.0; share += 0.0137) {
      EXPECT_EQ(binomial_at_least(k, 40, share) <= 0.025, lower >= share) << k << " " << share;
      EXPECT_EQ(binomial_at_most(k, 40, share) <= 0.025, upper <= share) << k << " " << share;
    }
  }
}

TEST(Statistics, NormalProbabilityAndItsQuantileAreEachOthersInverse) {
  EXPECT_NEAR(normal_probability(kNormal95), 0.975, 1e-15);
  EXPECT_NEAR(normal_quantile(0.975), kNormal95, 1e-12);
  EXPECT_NEAR(normal_quantile(0.995), kNormal99, 1e-12);
  for (double z = -8.0; z < 8.0; z += 0.37) {
    EXPECT_NEAR(normal_quantile(normal_probability(z)), z, z < 4.0 ? 1e-9 : 0.1) << z;  // near 1 the digits are gone
  }
  EXPECT_EQ(normal_quantile(0.0), -INFINITY);
  EXPECT_EQ(normal_quantile(1.0), INFINITY);
  EXPECT_TRUE(std::isnan(normal_quantile(std::nan(""))));
}

TEST(Statistics, APositiveQuantityHasAPositiveInterval) {
  const auto [low, high] = positive_interval95(2.0, 3.0);
  EXPECT_GT(low, 0.0);
  EXPECT_DOUBLE_EQ(low * high, 4.0);
}

}  // namespace
}  // namespace mbk::numeric
