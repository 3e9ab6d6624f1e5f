#include "mbk/study/statistics/people_bootstrap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::statistics {
namespace people_bootstrap_test {

using reliability::Pairing;

Matrix people_in_sessions(Index people, Index sessions, double error, std::uint64_t seed) {
  numeric::Random random(seed);
  Matrix scores(people, sessions);
  for (Index i = 0; i < people; ++i) {
    const double person = random.normal();
    for (Index j = 0; j < sessions; ++j) scores(i, j) = 10.0 + person + error * random.normal();
  }
  return scores;
}

/// Positive numbers with a long tail.
Vector skewed(Index count, std::uint64_t seed) {
  numeric::Random random(seed);
  Vector values(count);
  for (double& value : values) value = std::exp(random.normal());
  return values;
}

OutcomeReliability reliability_with(const Matrix& scores) {
  OutcomeReliability one;
  one.between_sessions.support = Support::enough;
  one.between_sessions.scores = scores;
  return one;
}

StudyStatistics comparing(const Vector& first, const Vector& second, Pairing pairing) {
  OutcomeComparison one;
  one.difference = *reliability::difference(first, second, pairing);
  one.first_values = first;
  one.second_values = second;
  StudyStatistics statistics;
  statistics.comparison.emplace().outcomes.push_back(std::move(one));
  return statistics;
}

void resample(StudyStatistics& statistics, int count, std::uint64_t seed = 1) {
  const auto tables = people_tables(statistics);
  std::vector<std::vector<double>> draws;
  for (int k = 0; k < count; ++k) draws.push_back(bootstrap_draw(tables, seed, k));
  add_bootstrap(statistics, tables, draws, seed);
}

const BootstrapInterval& of_difference(const StudyStatistics& statistics) {
  return *statistics.comparison->outcomes.front().bootstrap;
}

TEST(Bootstrap, ADrawDependsOnItsNumberAndNotOnWhatIsDrawnBeside) {
  const PeopleTable one{std::nullopt, people_in_sessions(12, 2, 0.5, 1), {}};
  const PeopleTable two{std::nullopt, people_in_sessions(9, 3, 0.5, 2), {}};
  const std::vector<PeopleTable> alone = {two}, both = {one, two};
  const auto of_both = bootstrap_draw(both, 7, 3);
  ASSERT_EQ(of_both.size(), 6U);
  EXPECT_EQ(std::vector(of_both.begin() + 3, of_both.end()), bootstrap_draw(alone, 7, 3));
  EXPECT_NE(bootstrap_draw(alone, 7, 3), bootstrap_draw(alone, 7, 4));
  EXPECT_NE(bootstrap_draw(alone, 7, 3), bootstrap_draw(alone, 8, 3));
}

TEST(Bootstrap, OfTheSamePeopleTheSameAreDrawn) {
  const Matrix scores = people_in_sessions(12, 2, 0.5, 1);
  const Matrix twice = (2.0 * scores).array() + 1.0;
  const std::vector<PeopleTable> tables = {{std::nullopt, scores, {}}, {std::nullopt, twice, {}}};
  const auto numbers = bootstrap_draw(tables, 1, 0);
  EXPECT_NEAR(numbers[3], numbers[0], 1e-12) << "an ICC has no unit";
  EXPECT_NEAR(numbers[5], 2.0 * numbers[2], 1e-12) << "an SEM has that of the numbers";
}

TEST(Bootstrap, StatesTheNumbersThatTheClassicalFormsState) {
  StudyStatistics statistics;
  const Matrix scores = people_in_sessions(15, 3, 0.4, 5);
  statistics.reliability.push_back(reliability_with(scores));
  resample(statistics, 200);
  const auto classical = *reliability::test_retest(scores);
  const ReliabilityBootstrap& found = *statistics.reliability.front().bootstrap;
  EXPECT_NEAR(found.icc_agreement.value, classical.icc[1].value, 1e-12);
  EXPECT_NEAR(found.icc_consistency.value, classical.icc[2].value, 1e-12);
  EXPECT_NEAR(found.sem_agreement.value, classical.error[0].sem, 1e-12);
  for (const BootstrapInterval* one : {&found.icc_agreement, &found.icc_consistency, &found.sem_agreement}) {
    EXPECT_LT(one->bca95.first, one->value);
    EXPECT_GT(one->bca95.second, one->value);
    EXPECT_EQ(one->undefined, 0);
  }
}

TEST(Bootstrap, OfManyPairsIsAsWideAsStudentsInterval) {
  const Matrix scores = people_in_sessions(200, 2, 0.5, 3);
  StudyStatistics statistics = comparing(scores.col(0), scores.col(1), Pairing::paired);
  resample(statistics, 4000);
  const auto& difference = statistics.comparison->outcomes.front().difference;
  const auto [low, high] = of_difference(statistics).bca95;
  const double width = difference.interval95.second - difference.interval95.first;
  EXPECT_NEAR(high - low, width, 0.06 * width);
  EXPECT_NEAR(of_difference(statistics).value, difference.value, 1e-12);
  EXPECT_NEAR(of_difference(statistics).standard_error, difference.standard_error, 0.05 * difference.standard_error);
}

/// The mean of one sample, whose jackknife is x̄ − (xᵢ − x̄)/(n − 1), so that a = Σ(xᵢ − x̄)³/(6 (Σ(xᵢ − x̄)²)^1.5).
TEST(Bootstrap, OfSkewedNumbersIsTheFormulaOfBca) {
  const Vector second = skewed(25, 4), first = Vector::Zero(25);
  StudyStatistics statistics = comparing(first, second, Pairing::paired);
  const auto tables = people_tables(statistics);
  constexpr int kDraws = 3000;
  Vector means(kDraws);
  for (int k = 0; k < kDraws; ++k) means[k] = bootstrap_draw(tables, 1, k).front();
  resample(statistics, kDraws);
  std::sort(means.begin(), means.end());
  const Vector apart = second.array() - second.mean();
  const double a = apart.array().cube().sum() / (6.0 * std::pow(apart.squaredNorm(), 1.5));
  const auto below = std::ranges::count_if(means, [&](double x) { return x < second.mean(); });
  const double z0 = numeric::normal_quantile(static_cast<double>(below) / kDraws);
  const auto end = [&](double z) {
    return numeric::quantile(means, numeric::normal_probability(z0 + (z0 + z) / (1.0 - a * (z0 + z))));
  };
  const BootstrapInterval& found = of_difference(statistics);
  EXPECT_NEAR(found.bca95.first, end(-numeric::kNormal95), 1e-6);
  EXPECT_NEAR(found.bca95.second, end(numeric::kNormal95), 1e-6);
  EXPECT_GT(found.bca95.second, found.percentile95.second) << "a long tail reaches further than the percentiles do";
}

TEST(Bootstrap, OfTwoGroupsDrawsEachByItself) {
  const Vector first = skewed(30, 1), second = Vector::Constant(8, 5.0);
  StudyStatistics statistics = comparing(first, second, Pairing::unpaired);
  resample(statistics, 2000);
  const BootstrapInterval& found = of_difference(statistics);
  EXPECT_NEAR(found.value, 5.0 - first.mean(), 1e-12);
  EXPECT_NEAR(found.standard_error, std::sqrt(numeric::variance(first) * 29.0 / 30.0 / 30.0),
              0.05 * found.standard_error)
      << "the second group does not vary";
}

TEST(Bootstrap, StatesNoIntervalWhereDrawsOftenGiveNoNumber) {
  // Of five people four have the same values: a third of the draws are of these alone.
  Matrix scores = Matrix::Constant(5, 2, 3.0);
  scores.row(0) << 4.0, 4.5;
  StudyStatistics statistics;
  statistics.reliability.push_back(reliability_with(scores));
  resample(statistics, 1000);
  const BootstrapInterval& found = statistics.reliability.front().bootstrap->icc_agreement;
  EXPECT_NEAR(found.undefined, 1000.0 * std::pow(0.8, 5), 60.0);
  EXPECT_TRUE(std::isfinite(found.value));
  EXPECT_TRUE(std::isnan(found.bca95.first));
  EXPECT_TRUE(std::isnan(found.percentile95.second));
}

}  // namespace people_bootstrap_test
}  // namespace mbk::statistics
