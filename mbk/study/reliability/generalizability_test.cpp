#include "mbk/study/reliability/generalizability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <tuple>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/study/reliability/retest.h"

namespace mbk::reliability {
namespace generalizability_test {

using enum FacetTerm;

constexpr double kTable = 0.005;   // the published numbers have two decimals
constexpr double kMaximum = 1e-5;  // relative: both are at the maximum of the likelihood

void add(Ratings& ratings, int participant_number, int rater_number, int session_number, double value) {
  ratings.values.conservativeResize(ratings.values.size() + 1);
  ratings.values[ratings.values.size() - 1] = value;
  ratings.participants.push_back(participant_number);
  ratings.raters.push_back(rater_number);
  ratings.sessions.push_back(session_number);
}

double variance_of(const RaterModel& model, FacetTerm term) {
  const auto found = std::ranges::find(model.variances, term, &FacetVariance::term);
  return found == model.variances.end() ? kNaN : found->value;
}

/// Six targets and four judges: table 2 of Shrout & Fleiss, Psychol. Bull. 86 (1979) 420–428.
Matrix judged() {
  Matrix scores(6, 4);
  scores << 9, 2, 5, 8, 6, 1, 3, 2, 8, 4, 6, 8, 7, 1, 2, 6, 10, 5, 6, 9, 6, 2, 4, 7;
  return scores;
}

Ratings ratings_of(const Matrix& scores) {
  Ratings ratings;
  for (Index i = 0; i < scores.rows(); ++i) {
    for (Index k = 0; k < scores.cols(); ++k) add(ratings, int(i) + 10, int(k) + 3, 1, scores(i, k));
  }
  return ratings;
}

void expect_same(const Interval& interval, const Interval& reference, double tolerance) {
  EXPECT_NEAR(interval.first, reference.first, tolerance);
  EXPECT_NEAR(interval.second, reference.second, tolerance);
}

TEST(Raters, OfShroutAndFleissHaveTheirCoefficients) {
  const auto model = fit_raters(ratings_of(judged()));
  ASSERT_TRUE(model) << model.error().line();
  ASSERT_EQ(model->support, Support::enough);
  ASSERT_EQ(model->variances.size(), 3U);
  EXPECT_EQ(model->variances[2].pooled, std::vector<FacetTerm>{participant_rater});
  EXPECT_FALSE(model->has_trials);
  EXPECT_EQ(model->session_facet, SessionFacet::too_few);
  const auto one = generalizability(*model, {1, 1, 1}).value(), four = generalizability(*model, {4, 1, 1}).value();
  EXPECT_NEAR(one.absolute, 0.29, kTable);   // ICC(2,1)
  EXPECT_NEAR(one.relative, 0.71, kTable);   // ICC(3,1)
  EXPECT_NEAR(four.absolute, 0.62, kTable);  // ICC(2,4)
  EXPECT_NEAR(four.relative, 0.91, kTable);  // ICC(3,4)
}

TEST(Raters, OfATwoWayTableHaveTheIntervalsOfMcGrawAndWong) {
  const auto model = fit_raters(ratings_of(judged())).value();
  const TestRetest classical = test_retest(judged()).value();
  const auto one = generalizability(model, {1, 1, 1}).value();
  EXPECT_NEAR(one.absolute, classical.icc[1].value, kMaximum);
  EXPECT_NEAR(one.relative, classical.icc[2].value, kMaximum);
  constexpr double kEnds = 1e-4;
  expect_same(one.absolute95, classical.icc[1].interval95, kEnds);
  expect_same(one.relative95, classical.icc[2].interval95, kEnds);
  for (const auto& [error, reference] :
       {std::pair(one.absolute_error, classical.error[0]), std::pair(one.relative_error, classical.error[1])}) {
    EXPECT_NEAR(error.sem, reference.sem, kEnds);
    EXPECT_NEAR(error.mdc95, reference.mdc95, kEnds);
    expect_same(error.sem95, reference.sem95, 1e-3 * reference.sem95.second);
    expect_same(error.mdc95_interval, reference.mdc95_interval, 1e-3 * reference.mdc95_interval.second);
  }
  const auto four = generalizability(model, {4, 1, 1}).value();
  expect_same(four.absolute95, classical.icc[4].interval95, 0.02);  // other degrees of freedom than of one
  expect_same(four.relative95, classical.icc[5].interval95, kEnds);
}

/// Standard deviations of the effects.
using Deviations = std::map<FacetTerm, double>;
const Deviations kEqualDeviations = {
    {participant, 3.0},         {rater, 1.0},         {participant_rater, 1.0},         {session, 1.0},
    {participant_session, 1.0}, {rater_session, 1.0}, {participant_rater_session, 1.0}, {residual, 1.5}};

/// A complete study, drawn.
Ratings drawn_study(int people, int raters, int sessions, int trials, const Deviations& deviations,
                    std::uint32_t seed) {
  numeric::Random random(seed);
  std::map<std::tuple<FacetTerm, int, int, int>, double> effects;
  const auto effect = [&](FacetTerm term, int p, int r, int s) {
    const auto found = effects.try_emplace({term, p, r, s}, 0.0);
    if (found.second) found.first->second = deviations.at(term) * random.normal();
    return found.first->second;
  };
  Ratings ratings;
  for (int p = 1; p <= people; ++p) {
    for (int r = 1; r <= raters; ++r) {
      for (int s = 1; s <= sessions; ++s) {
        for (int t = 0; t < trials; ++t) {
          add(ratings, p, r, s,
              100.0 + effect(participant, p, 0, 0) + effect(rater, 0, r, 0) + effect(participant_rater, p, r, 0) +
                  effect(session, 0, 0, s) + effect(participant_session, p, 0, s) + effect(rater_session, 0, r, s) +
                  effect(participant_rater_session, p, r, s) + deviations.at(residual) * random.normal());
        }
      }
    }
  }
  return ratings;
}

/// The mean over all rows that agree in some of their numbers, squared and summed: n Σ ȳ² of the analysis of variance.
double sum_of_squares(const Ratings& ratings, bool by_p, bool by_r, bool by_s) {
  std::map<std::tuple<int, int, int>, std::pair<double, int>> sums;
  for (std::size_t k = 0; k < ratings.raters.size(); ++k) {
    auto& [sum, count] =
        sums[{by_p ? ratings.participants[k] : 0, by_r ? ratings.raters[k] : 0, by_s ? ratings.sessions[k] : 0}];
    sum += ratings.values[Index(k)];
    ++count;
  }
  double squares = 0.0;
  for (const auto& [key, one] : sums) squares += one.first * one.first / one.second;
  return squares;
}

/// Estimators of Brennan, Generalizability Theory (2001), section 3: expected mean squares of people × raters ×
/// sessions.
std::map<FacetTerm, double> by_analysis_of_variance(const Ratings& y, double P, double R, double S, double T) {
  const double m = sum_of_squares(y, false, false, false), p = sum_of_squares(y, true, false, false),
               r = sum_of_squares(y, false, true, false), s = sum_of_squares(y, false, false, true),
               pr = sum_of_squares(y, true, true, false), ps = sum_of_squares(y, true, false, true),
               rs = sum_of_squares(y, false, true, true), prs = sum_of_squares(y, true, true, true);
  const double e = (y.values.squaredNorm() - prs) / (P * R * S * (T - 1));
  const double MSp = (p - m) / (P - 1), MSr = (r - m) / (R - 1), MSs = (s - m) / (S - 1);
  const double MSpr = (pr - p - r + m) / ((P - 1) * (R - 1)), MSps = (ps - p - s + m) / ((P - 1) * (S - 1));
  const double MSrs = (rs - r - s + m) / ((R - 1) * (S - 1));
  const double MSprs = (prs - pr - ps - rs + p + r + s - m) / ((P - 1) * (R - 1) * (S - 1));
  return {{residual, e},
          {participant_rater_session, (MSprs - e) / T},
          {participant_rater, (MSpr - MSprs) / (T * S)},
          {participant_session, (MSps - MSprs) / (T * R)},
          {rater_session, (MSrs - MSprs) / (T * P)},
          {participant, (MSp - MSpr - MSps + MSprs) / (T * R * S)},
          {rater, (MSr - MSpr - MSrs + MSprs) / (T * P * S)},
          {session, (MSs - MSps - MSrs + MSprs) / (T * P * R)}};
}

TEST(Raters, OfACompleteStudyHaveTheVariancesOfItsAnalysis) {
  int compared = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Ratings ratings = drawn_study(8, 4, 3, 2, kEqualDeviations, seed);
    const auto reference = by_analysis_of_variance(ratings, 8, 4, 3, 2);
    if (std::ranges::any_of(reference, [](const auto& one) { return one.second <= 0.0; })) continue;
    const auto model = fit_raters(ratings).value();
    EXPECT_EQ(model.session_facet, SessionFacet::separate);
    EXPECT_TRUE(model.has_trials);
    for (const auto& [term, value] : reference) {
      EXPECT_NEAR(variance_of(model, term), value, kMaximum * (value + 1.0)) << word_of(term) << ", " << seed;
    }
    ++compared;
  }
  EXPECT_GE(compared, 2) << "most have negative estimates";
}

/// −2 ln of the restricted likelihood from the covariance of all rows.
double dense_deviance(const Ratings& y, const std::vector<FacetVariance>& variances, const Vector& values) {
  const Index N = y.values.size();
  Matrix V = Matrix::Zero(N, N);
  for (Index i = 0; i < N; ++i) {
    for (Index k = 0; k < N; ++k) {
      const auto a = std::size_t(i), b = std::size_t(k);
      const bool p = y.participants[a] == y.participants[b], r = y.raters[a] == y.raters[b],
                 s = y.sessions[a] == y.sessions[b];
      const std::map<FacetTerm, bool> alike = {{participant, p},
                                               {rater, r},
                                               {participant_rater, p && r},
                                               {session, s},
                                               {participant_session, p && s},
                                               {rater_session, r && s},
                                               {participant_rater_session, p && r && s},
                                               {residual, i == k}};
      for (std::size_t v = 0; v < variances.size(); ++v) {
        if (alike.at(variances[v].term)) V(i, k) += values[Index(v)];
      }
    }
  }
  const numeric::Cholesky factor(V);
  const Vector ones = Vector::Ones(N), by_ones = factor.solve(ones), by_values = factor.solve(y.values);
  const double weight = ones.dot(by_ones), sum = ones.dot(by_values);
  return 2.0 * factor.upper().diagonal().array().log().sum() + std::log(weight) + y.values.dot(by_values) -
         sum * sum / weight + double(N - 1) * std::log(2.0 * std::numbers::pi);
}

/// A third of the rows are missing, and one rater measured half of the people.
Ratings with_gaps(std::uint32_t seed) {
  const Ratings whole = drawn_study(9, 3, 3, 3, kEqualDeviations, seed);
  numeric::Random random(100 + seed);
  Ratings ratings;
  for (std::size_t k = 0; k < whole.raters.size(); ++k) {
    if (random.uniform() < 0.33 || (whole.raters[k] == 3 && whole.participants[k] > 4)) continue;
    add(ratings, whole.participants[k], whole.raters[k], whole.sessions[k], whole.values[Index(k)]);
  }
  return ratings;
}

TEST(Raters, OfAStudyWithGapsAreAtTheMaximumOfTheDenseLikelihood) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const Ratings ratings = with_gaps(seed);
    const auto model = fit_raters(ratings).value();
    ASSERT_EQ(model.variances.size(), 8U);
    Vector at(8);
    for (Index k = 0; k < 8; ++k) at[k] = model.variances[std::size_t(k)].value;
    const double deviance = dense_deviance(ratings, model.variances, at);
    EXPECT_NEAR(model.deviance, deviance, 1e-7 * std::abs(deviance));
    numeric::Random random(seed);
    for (int k = 0; k < 30; ++k) {
      Vector near = at;
      for (Index i = 0; i < 8; ++i) {
        if (k >= 16 || i == k / 2)
          near[i] = std::max(at[i] + (k < 16 ? (k % 2 == 0 ? 0.05 : -0.05) : 0.1 * random.normal()), 0.0);
      }
      near[7] = std::max(near[7], 0.01);
      EXPECT_GE(dense_deviance(ratings, model.variances, near), deviance - 1e-8) << seed << ", " << k;
    }
  }
}

TEST(Raters, InNumbersFarFromZeroAndInOtherUnitsHaveTheSameCoefficients) {
  Ratings ratings = with_gaps(1);
  const auto model = fit_raters(ratings).value();
  ratings.values = (ratings.values.array() * 1e-6 + 1.0).matrix();
  std::ranges::reverse(ratings.values);
  std::ranges::reverse(ratings.participants);
  std::ranges::reverse(ratings.raters);
  std::ranges::reverse(ratings.sessions);
  const auto scaled = fit_raters(ratings).value();
  EXPECT_NEAR(scaled.mean, 1.0 + 1e-6 * model.mean, 1e-9);
  const auto one = generalizability(model, {2, 2, 3}).value(), other = generalizability(scaled, {2, 2, 3}).value();
  EXPECT_NEAR(one.absolute, other.absolute, 1e-6);
  EXPECT_NEAR(one.relative95.first, other.relative95.first, 1e-5);
  EXPECT_NEAR(one.same_raters.mdc95, 1e6 * other.same_raters.mdc95, 1e-4);
}

TEST(Raters, AreAveragedByTheNumbersOfEach) {
  const auto model = fit_raters(with_gaps(2)).value();
  const auto of = [&](FacetTerm term) { return variance_of(model, term); };
  const double R = 3, S = 2, T = 4;
  const auto found = generalizability(model, {3, 2, 4}).value();
  const double relative = of(participant_rater) / R + of(participant_session) / S +
                          of(participant_rater_session) / (R * S) + of(residual) / (R * S * T);
  const double absolute = relative + of(rater) / R + of(session) / S + of(rater_session) / (R * S);
  EXPECT_NEAR(found.relative, of(participant) / (of(participant) + relative), 1e-12);
  EXPECT_NEAR(found.absolute, of(participant) / (of(participant) + absolute), 1e-12);
  EXPECT_NEAR(found.absolute_error.sem, std::sqrt(absolute), 1e-12);
  EXPECT_NEAR(found.same_raters.sem, std::sqrt(absolute - of(rater) / R - of(participant_rater) / R), 1e-12);
  EXPECT_NEAR(found.same_raters.mdc95, 1.96 * std::numbers::sqrt2 * found.same_raters.sem, 1e-12);
  EXPECT_FALSE(generalizability(model, {0, 1, 1}));
}

TEST(Raters, WhoDoNotDifferHaveAVarianceOfZeroWithItsUncertainty) {
  Deviations alike = kEqualDeviations;
  alike[rater] = alike[participant_rater] = alike[rater_session] = 0.0;
  int zeros = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const auto model = fit_raters(drawn_study(10, 2, 2, 2, alike, seed)).value();
    for (const FacetVariance& one : model.variances) {
      EXPECT_GE(one.value, 0.0);
      EXPECT_GT(one.standard_error, 0.0) << word_of(one.term);
    }
    const auto found = generalizability(model, {1, 1, 1}).value();
    EXPECT_GE(found.relative, found.absolute);
    EXPECT_LT(found.absolute_error.sem95.first, found.absolute_error.sem);
    EXPECT_GT(found.absolute_error.sem95.second, found.absolute_error.sem);
    if (variance_of(model, rater) == 0.0) ++zeros;
  }
  EXPECT_GE(zeros, 1);
}

TEST(Raters, WhoAreTooFewHaveNoNumbers) {
  Ratings nested;  // each person has a rater of their own kind
  for (int p = 1; p <= 10; ++p) {
    for (int s = 1; s <= 2; ++s) add(nested, p, 1 + p % 2, s, double(p + s * s));
  }
  EXPECT_EQ(fit_raters(nested)->support, Support::too_few_raters);
  EXPECT_EQ(fit_raters(ratings_of(judged().topRows(4)))->support, Support::too_few_people);
  EXPECT_EQ(fit_raters(ratings_of(Matrix::Constant(6, 2, 3.0)))->support, Support::no_variation);
  EXPECT_EQ(generalizability(*fit_raters(nested), {1, 1, 1})->support, Support::too_few_raters);
  Ratings wrong = nested;
  wrong.raters.pop_back();
  EXPECT_FALSE(fit_raters(wrong));
  nested.values[3] = kNaN;
  EXPECT_FALSE(fit_raters(nested));
}

TEST(Raters, WithSessionsOfTheirOwnAreNotToldFromThem) {
  const Ratings whole = drawn_study(10, 2, 2, 3, kEqualDeviations, 3);
  Ratings ratings;
  for (std::size_t k = 0; k < whole.raters.size(); ++k) {
    if (whole.raters[k] != whole.sessions[k]) continue;
    add(ratings, whole.participants[k], whole.raters[k], whole.sessions[k], whole.values[Index(k)]);
  }
  const auto model = fit_raters(ratings).value();
  EXPECT_EQ(model.session_facet, SessionFacet::confounded);
  EXPECT_TRUE(std::isnan(variance_of(model, participant_session)));
  const auto found = std::ranges::find(model.variances, rater, &FacetVariance::term);
  EXPECT_EQ(found->pooled, std::vector<FacetTerm>{session});
  EXPECT_EQ(generalizability(model, {2, 2, 1})->support, Support::too_few_sessions);
  EXPECT_TRUE(std::isnan(generalizability(model, {2, 1, 1})->same_raters.sem));
  EXPECT_GT(generalizability(model, {2, 1, 3})->relative, generalizability(model, {1, 1, 1})->relative);
}

TEST(Raters, WithOneTrialEachDoNotTellWhatMoreWouldBring) {
  const auto model = fit_raters(drawn_study(10, 2, 2, 1, kEqualDeviations, 4)).value();
  EXPECT_FALSE(model.has_trials);
  EXPECT_EQ(model.variances.back().pooled, std::vector<FacetTerm>{participant_rater_session});
  EXPECT_EQ(generalizability(model, {1, 1, 2})->support, Support::too_few_trials);
  EXPECT_EQ(generalizability(model, {2, 2, 1})->support, Support::enough);
}

/// How many of so many studies have intervals that contain the truth: Φ, G, SEM of any and of the same raters.
std::array<double, 4> covered(int people, int raters, int sessions, int trials, int studies) {
  const Deviations& d = kEqualDeviations;
  const auto v = [&](FacetTerm term) { return d.at(term) * d.at(term); };
  const double relative = v(participant_rater) + v(participant_session) + v(participant_rater_session) + v(residual);
  const double absolute = relative + v(rater) + v(session) + v(rater_session);
  const double same = absolute - v(rater) - v(participant_rater);
  std::array<int, 4> hits{};
  const auto within = [](const Interval& interval, double x) { return interval.first <= x && x <= interval.second; };
  for (int k = 0; k < studies; ++k) {
    const auto model = fit_raters(drawn_study(people, raters, sessions, trials, d, 1000 + std::uint32_t(k))).value();
    const auto one = generalizability(model, {1, 1, 1}).value();
    hits[0] += within(one.absolute95, v(participant) / (v(participant) + absolute)) ? 1 : 0;
    hits[1] += within(one.relative95, v(participant) / (v(participant) + relative)) ? 1 : 0;
    hits[2] += within(one.absolute_error.sem95, std::sqrt(absolute)) ? 1 : 0;
    hits[3] += within(one.same_raters.sem95, std::sqrt(same)) ? 1 : 0;
  }
  std::array<double, 4> shares{};
  for (std::size_t k = 0; k < 4; ++k) shares[k] = double(hits[k]) / studies;
  return shares;
}

TEST(Raters, HaveIntervalsThatContainTheTruth) {
  const char* const many = std::getenv("MBK_RATER_STUDIES");
  const int studies = many != nullptr ? std::atoi(many) : 150;
  constexpr double kAtLeast = 0.85;  // 95 % by the method less four standard deviations of 150 studies and its error
  for (const auto& [raters, sessions, trials] : {std::tuple(2, 2, 2), std::tuple(4, 3, 2)}) {
    const auto shares = covered(15, raters, sessions, trials, studies);
    for (const double share : shares) EXPECT_GE(share, kAtLeast) << raters << " raters";
    if (many != nullptr)
      std::printf("%d raters: %.3f %.3f %.3f %.3f\n", raters, shares[0], shares[1], shares[2], shares[3]);
  }
}

}  // namespace generalizability_test
}  // namespace mbk::reliability
