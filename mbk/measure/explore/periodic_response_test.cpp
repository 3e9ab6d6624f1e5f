#include "mbk/measure/explore/periodic_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "mbk/measure/explore/test_signals.h"

namespace mbk::explore {
namespace periodic_response_test {

using Complex = std::complex<double>;
constexpr double kStep = 0.01;
constexpr Index kPeriod = 200;  // 2 s
constexpr double kA = 2.0, kB = -1.2;

/// In steady state: the first period is thrown away.
Vector settled(const Vector& y) {
  return y.tail(y.size() - kPeriod);
}

/// One realisation of P periods of y = a u + b u[−1] + cubic u³ + noise.
ExplorationTrial realisation(const std::vector<int>& lines, unsigned seed, Index periods, double noise, double cubic,
                             double square = 0.0) {
  const Vector u = periodic_signal(lines, kPeriod, (periods + 1) * kPeriod, seed);
  const Vector y = two_taps(u, kA, kB) + cubic * u.cwiseProduct(u.cwiseProduct(u)) + square * u.cwiseProduct(u);
  const Vector v = noise * white_noise(periods * kPeriod, seed + 50'000);
  return trial_of(settled(u), settled(y) + v, kStep, settled(u));
}

std::vector<ExplorationTrial> realisations(Index count, unsigned seed, Index periods, double noise, double cubic) {
  std::vector<ExplorationTrial> trials;
  for (Index m = 0; m < count; ++m) {
    trials.push_back(realisation(odd_lines(39), seed + 10 * static_cast<unsigned>(m), periods, noise, cubic));
  }
  return trials;
}

TEST(PeriodicResponse, WithoutNoiseIsExact) {
  auto trial = realisation(odd_lines(39), 1, 4, 0.0, 0.0);
  for (const bool with_reference : {true, false}) {
    if (!with_reference) trial.reference.resize(0, 0);
    const auto found = periodic_response({&trial, 1});
    ASSERT_TRUE(found.has_value()) << found.error().line();
    EXPECT_EQ(found->method, FrequencyResponseMethod::fast);
    EXPECT_NEAR(found->periodic->period_s, 2.0, 1e-12);
    EXPECT_EQ(found->periodic->periods, 4);
    ASSERT_EQ(found->size(), 20);
    for (Index k = 0; k < found->size(); ++k) {
      EXPECT_NEAR(found->frequency[k], 0.5 * static_cast<double>(2 * k + 1), 1e-12);
      const Complex truth = two_taps_response(kA, kB, found->frequency[k], kStep);
      EXPECT_NEAR(std::abs(found->response[static_cast<std::size_t>(k)](0, 0) - truth), 0.0, 1e-11);
    }
  }
}

TEST(PeriodicResponse, WithoutAReferenceFindsTheLinesThatWereExcited) {
  for (const std::vector<int>& lines : {std::vector<int>{1, 5, 9, 13, 17, 21, 25, 29, 33, 37},
                                        std::vector<int>{1, 3, 5, 9, 11, 13, 15, 19, 21, 23, 25, 29, 31, 33, 35, 39},
                                        std::vector<int>{2, 7, 12, 17, 22, 27, 32}}) {
    auto trial = realisation(lines, 3, 8, 1e-3, 0.0);
    trial.reference.resize(0, 0);
    trial.input.col(0) += 2e-3 * white_noise(trial.input.rows(), 99);
    const auto found = periodic_response({&trial, 1}, {.period_s = 2.0});
    ASSERT_TRUE(found.has_value()) << found.error().line();
    std::vector<int> at;
    for (Index k = 0; k < found->size(); ++k) at.push_back(static_cast<int>(std::lround(2.0 * found->frequency[k])));
    EXPECT_EQ(at, lines);
  }
}

TEST(PeriodicResponse, LeavesNoLineOutWhosePowerFallsWithFrequency) {
  Vector u = Vector::Zero(9 * kPeriod);
  for (int line = 1; line <= 36; ++line) {
    for (Index i = 0; i < u.size(); ++i) {
      u[i] += std::cos(2.0 * M_PI * line * static_cast<double>(i) / static_cast<double>(kPeriod) + line * line) / line;
    }
  }
  const Vector y = two_taps(u, kA, kB) + 1e-3 * white_noise(u.size(), 4);
  for (const bool with_reference : {true, false}) {
    const auto trial = with_reference ? trial_of(settled(u), settled(y), kStep, settled(u))
                                      : trial_of(settled(u) + 1e-4 * white_noise(8 * kPeriod, 5), settled(y), kStep);
    const auto found = periodic_response({&trial, 1}, {.period_s = 2.0});
    ASSERT_TRUE(found.has_value()) << found.error().line();
    EXPECT_GE(found->size(), 34) << with_reference;
  }
}

TEST(PeriodicResponse, CountsTheLinesWhosePowerIsTooLittle) {
  for (const bool with_reference : {true, false}) {
    Vector u = Vector::Zero(9 * kPeriod);
    for (int line = 1; line <= 30; ++line) {
      const double amplitude = line <= 20 ? 1.0 : 3e-3;
      for (Index i = 0; i < u.size(); ++i) {
        u[i] += amplitude *
                std::cos(2.0 * M_PI * line * static_cast<double>(i) / static_cast<double>(kPeriod) + line * line);
      }
    }
    const Vector y = two_taps(u, kA, kB) + 1e-5 * white_noise(u.size(), 4);
    const auto trial = with_reference ? trial_of(settled(u), settled(y), kStep, settled(u))
                                      : trial_of(settled(u) + 1e-5 * white_noise(8 * kPeriod, 5), settled(y), kStep);
    const auto found = periodic_response({&trial, 1}, {.period_s = 2.0});
    ASSERT_TRUE(found.has_value()) << found.error().line();
    EXPECT_EQ(found->size(), 20) << with_reference;
    EXPECT_EQ(found->periodic->weak_lines, 10) << with_reference;
    EXPECT_EQ(found->periodic->skipped_lines, 10) << with_reference;
  }
}

TEST(PeriodicResponse, OfALinearSystemHasNoMoreVarianceOverRealisationsThanOverPeriods) {
  double total = 0.0, noise = 0.0;
  int alarms = 0;
  for (unsigned run = 0; run < 100; ++run) {
    const auto found = periodic_response(realisations(4, 1000 * run + 1, 3, 1.0, 0.0));
    ASSERT_TRUE(found.has_value()) << found.error().line();
    ASSERT_EQ(found->method, FrequencyResponseMethod::robust);
    EXPECT_EQ(found->periodic->realisations, 4);
    for (std::size_t k = 0; k < found->covariance.size(); ++k) {
      total += found->covariance[k](0, 0).real();
      noise += found->noise_covariance[k](0, 0).real();
    }
    alarms += found->periodic->total_over_noise_p < 0.01 ? 1 : 0;
  }
  EXPECT_GT(total / noise, 0.9);
  EXPECT_LT(total / noise, 1.1);
  EXPECT_LE(alarms, 6) << "of 100 at 1 %";
}

TEST(PeriodicResponse, OfACubicSystemShowsIt) {
  const auto found = periodic_response(realisations(6, 7, 3, 0.1, 0.01));
  ASSERT_TRUE(found.has_value());
  EXPECT_GT(found->periodic->total_over_noise.value(), 10.0);
  EXPECT_LT(found->periodic->total_over_noise_p, 1e-6);
}

TEST(PeriodicResponse, IntervalsCoverTheTruth) {
  int inside = 0, magnitude_inside = 0, all = 0;
  for (unsigned run = 0; run < 150; ++run) {
    for (const Index count : {1, 5}) {
      const auto found = periodic_response(realisations(count, 900'000 + 777 * run, 4, 1.0, 0.0));
      ASSERT_TRUE(found.has_value()) << found.error().line();
      for (Index k = 0; k < found->size(); ++k) {
        const Complex truth = two_taps_response(kA, kB, found->frequency[k], kStep);
        const double error = std::abs(found->response[static_cast<std::size_t>(k)](0, 0) - truth);
        inside += error <= found->radius95(k, 0) ? 1 : 0;
        const bool within =
            std::abs(truth) >= found->magnitude_low(k, 0) && std::abs(truth) <= found->magnitude_high(k, 0);
        magnitude_inside += within ? 1 : 0;
        ++all;
      }
    }
  }
  for (const int covered : {inside, magnitude_inside}) {
    EXPECT_GT(covered, 0.935 * all);
    EXPECT_LT(covered, 0.965 * all);
  }
}

TEST(PeriodicResponse, TellsEvenFromOddDistortion) {
  std::vector<int> sparse;  // odd lines, every fourth of them left empty
  for (const int k : odd_lines(59)) {
    if (k % 8 != 7) sparse.push_back(k);
  }
  const auto detected = [&](double cubic, double square) {
    const auto trial = realisation(sparse, 11, 6, 0.05, cubic, square);
    const auto found = periodic_response({&trial, 1});
    EXPECT_TRUE(found.has_value());
    EXPECT_TRUE(found->periodic->odd);
    return std::pair(found->periodic->even->detected(), found->periodic->odd_lines->detected());
  };
  EXPECT_EQ(detected(0.0, 0.0), std::pair(false, false));
  EXPECT_EQ(detected(0.002, 0.0), std::pair(false, true));
  EXPECT_EQ(detected(0.0, 0.01), std::pair(true, false));
}

TEST(PeriodicResponse, SubtractsWhatTheInputCarriesAtEmptyLines) {
  // The robot distorts, the limb does not: even lines of u that r does not have pass through G.
  const Vector r = periodic_signal(odd_lines(59), kPeriod, 7 * kPeriod, 12);
  const Vector u = r + 0.02 * r.cwiseProduct(r);
  const Vector y = two_taps(u, kA, kB);
  const auto trial = trial_of(settled(u), settled(y) + 0.05 * white_noise(6 * kPeriod, 13), kStep, settled(r));
  const auto found = periodic_response({&trial, 1});
  ASSERT_TRUE(found.has_value());
  const Distortion& even = found->periodic->even.value();
  EXPECT_FALSE(even.detected()) << even.relative << " noise " << even.noise;
  EXPECT_GT(even.uncorrected, 10.0 * even.relative);
}

TEST(PeriodicResponse, InAClosedLoopIsRightWhereTheMeanOfRatiosIsBiased) {
  // u = r − y, y[i] = 0.9 u[i − 1] + v[i]: noise as strong as the reference goes round the loop.
  const std::vector<int> lines = odd_lines(39);
  std::vector<ExplorationTrial> trials;
  constexpr unsigned kRealisations = 300;
  for (unsigned m = 0; m < kRealisations; ++m) {
    const Vector r = periodic_signal(lines, kPeriod, 4 * kPeriod, 70 + m);
    const Vector v = 8.0 * white_noise(4 * kPeriod, 9000 + m);
    Vector u(r.size()), y(r.size());
    double before = 0.0;
    for (Index i = 0; i < r.size(); ++i) {
      y[i] = 0.9 * before + v[i];
      u[i] = r[i] - y[i];
      before = u[i];
    }
    trials.push_back(trial_of(settled(u), settled(y), kStep, settled(r)));
  }
  const auto projected = periodic_response(trials);
  ASSERT_TRUE(projected.has_value()) << projected.error().line();
  std::vector<Complex> ratios(static_cast<std::size_t>(projected->size()));
  for (const ExplorationTrial& trial : trials) {
    const auto one = periodic_response({&trial, 1});
    ASSERT_TRUE(one.has_value());
    for (std::size_t k = 0; k < ratios.size(); ++k) ratios[k] += one->response[k](0, 0) / double(kRealisations);
  }
  double error = 0.0, bias = 0.0;
  Index inside = 0;
  for (Index k = 0; k < projected->size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Complex truth = two_taps_response(0.0, 0.9, projected->frequency[k], kStep);
    const double one = std::abs(projected->response[at](0, 0) - truth);
    error += one / static_cast<double>(projected->size());
    bias += std::abs(ratios[at] - truth) / static_cast<double>(projected->size());
    inside += one <= projected->radius95(k, 0) ? 1 : 0;
  }
  EXPECT_GE(inside, 16) << "of 20";
  EXPECT_GT(bias, 2.0 * error) << "bias " << bias << " error " << error;
}

/// Two inputs and outputs; realisations in pairs (r₁, r₂), (r₁, −r₂), or each with phases of its own.
std::vector<ExplorationTrial> two_axes(Index count, unsigned seed, bool pairs, double noise) {
  std::vector<ExplorationTrial> trials;
  const Index n = 4 * kPeriod;
  for (Index m = 0; m < count; ++m) {
    const unsigned phases = seed + 100 * static_cast<unsigned>(pairs ? m / 2 : m);
    Matrix u(n, 2), y(n, 2);
    u.col(0) = periodic_signal(odd_lines(39), kPeriod, n, phases);
    u.col(1) = periodic_signal(odd_lines(39), kPeriod, n, phases + 1) * (pairs && m % 2 == 1 ? -1.0 : 1.0);
    y.col(0) = two_taps(u.col(0), kA, kB) + two_taps(u.col(1), 0.3, 0.1);
    y.col(1) = two_taps(u.col(0), -0.5, 0.0) + two_taps(u.col(1), 1.0, 0.8);
    y += noise * white_noise(n, 2, seed + 5000 + static_cast<unsigned>(m));
    trials.push_back(trial_of(u.bottomRows(3 * kPeriod), y.bottomRows(3 * kPeriod), kStep, u.bottomRows(3 * kPeriod)));
  }
  return trials;
}

TEST(PeriodicResponse, OfTwoAxesIsFoundFromOrthogonalPairsAndFromAnyPhases) {
  for (const bool pairs : {true, false}) {
    Index inside = 0, all = 0;
    for (unsigned run = 0; run < 40; ++run) {
      const auto found = periodic_response(two_axes(8, 31'000 * (run + 1), pairs, 1.0));
      ASSERT_TRUE(found.has_value()) << found.error().line();
      EXPECT_EQ(found->periodic->orthogonal, pairs);
      EXPECT_EQ(found->method, FrequencyResponseMethod::robust);
      for (Index k = 0; k < found->size(); ++k) {
        const double f = found->frequency[k];
        const Complex truth[2][2] = {{two_taps_response(kA, kB, f, kStep), two_taps_response(0.3, 0.1, f, kStep)},
                                     {two_taps_response(-0.5, 0.0, f, kStep), two_taps_response(1.0, 0.8, f, kStep)}};
        for (Index j = 0; j < 2; ++j) {
          for (Index i = 0; i < 2; ++i, ++all) {
            const Complex error = found->response[static_cast<std::size_t>(k)](i, j) - truth[i][j];
            inside += std::abs(error) <= found->radius95(k, 2 * j + i) ? 1 : 0;
          }
        }
      }
    }
    EXPECT_GT(static_cast<double>(inside), 0.925 * static_cast<double>(all)) << pairs;
    EXPECT_LT(static_cast<double>(inside), 0.975 * static_cast<double>(all)) << pairs;
  }
}

TEST(PeriodicResponse, OfTwoAxesNeedsTwoRealisations) {
  const auto trials = two_axes(1, 5, false, 0.1);
  const auto found = periodic_response(trials);
  ASSERT_FALSE(found.has_value());
  EXPECT_NE(found.error().line().find("one trial"), std::string::npos) << found.error().line();
}

TEST(PeriodicResponse, TakesTheSameRealisationTwiceForOne) {
  auto trials = realisations(2, 40, 3, 0.5, 0.0);
  const auto alone = periodic_response({trials.data(), 1});
  ExplorationTrial again = realisation(odd_lines(39), 40, 5, 0.5, 0.0);
  again.input = again.input.bottomRows(4 * kPeriod + 57).eval();  // begins elsewhere in the period
  again.output = again.output.bottomRows(4 * kPeriod + 57).eval();
  again.reference = again.reference.bottomRows(4 * kPeriod + 57).eval();
  again.output += 0.5 * white_noise(again.output.rows(), 4242);
  trials[1] = again;
  const auto found = periodic_response(trials);
  ASSERT_TRUE(found.has_value() && alone.has_value());
  EXPECT_EQ(found->periodic->realisations, 1);
  EXPECT_EQ(found->periodic->periods, 7);
  for (Index k = 0; k < found->size(); ++k) {
    const Complex truth = two_taps_response(kA, kB, found->frequency[k], kStep);
    EXPECT_LT(std::abs(found->response[static_cast<std::size_t>(k)](0, 0) - truth), 3.0 * found->radius95(k, 0));
  }
}

TEST(PeriodicResponse, LeavesAFirstPeriodOutThatStillSettles) {
  const Vector u = periodic_signal(odd_lines(39), kPeriod, 6 * kPeriod, 8);
  Vector y = two_taps(u, kA, kB) + 0.05 * white_noise(u.size(), 9);
  for (Index i = 0; i < kPeriod; ++i) y[i] += 20.0 * std::exp(-0.03 * static_cast<double>(i));
  const auto trial = trial_of(u, y, kStep, u);
  const auto found = periodic_response({&trial, 1});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->periodic->dropped_periods, 1);
  const auto honest = realisation(odd_lines(39), 3, 6, 0.05, 0.0);
  EXPECT_EQ(periodic_response({&honest, 1})->periodic->dropped_periods, 0);
}

TEST(PeriodicResponse, RefusesWhatHasNoPeriod) {
  const Vector u = white_noise(4000, 1);
  const auto trial = trial_of(u, u, kStep);
  const auto found = periodic_response({&trial, 1});
  ASSERT_FALSE(found.has_value());
  EXPECT_NE(found.error().line().find("--period"), std::string::npos);
  EXPECT_FALSE(periodic_response({&trial, 1}, {.period_s = 0.005}).has_value()) << "no whole number of samples";
  EXPECT_FALSE(periodic_response({&trial, 1}, {.period_s = 0.05}).has_value()) << "fewer than 8 samples";
  EXPECT_FALSE(periodic_response({&trial, 1}, {.period_s = 30.0}).has_value()) << "fewer than two periods";
}

}  // namespace periodic_response_test
}  // namespace mbk::explore
