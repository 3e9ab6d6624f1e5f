#include "mbk/measure/identify/prediction_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/measure/identify/srivc.h"

namespace mbk::identify {
namespace prediction_error_test {

/// Poles at 0.95 e^{±0.3i} and 0.9 e^{±1.2i}, three zeros.
struct Truth {
  Vector f, b{{0.3, 0.2, -0.4, 0.1}};
  Truth() {
    const Vector slow{{1.0, -2.0 * 0.95 * std::cos(0.3), 0.95 * 0.95}};
    const Vector fast{{1.0, -2.0 * 0.9 * std::cos(1.2), 0.9 * 0.9}};
    Vector product = Vector::Zero(5);
    for (Index i = 0; i < 3; ++i) product.segment(i, 3) += slow[i] * fast;
    f = product.tail(4);
  }
  [[nodiscard]] Vector theta() const {
    Vector both(f.size() + b.size());
    both << f, b;
    return both;
  }
};

/// y[t] = Σ b_k u[t − k] − Σ f_k y[t − k], term by term.
Vector plain_response(const Vector& b, const Vector& f, const Vector& u) {
  Vector y = Vector::Zero(u.size());
  for (Index t = 0; t < u.size(); ++t) {
    for (Index k = 0; k < b.size() && k <= t; ++k) y[t] += b[k] * u[t - k];
    for (Index k = 1; k <= f.size() && k <= t; ++k) y[t] -= f[k - 1] * y[t - k];
  }
  return y;
}

SignalPair record(Index samples, double step, const Vector& input) {
  SignalPair pair;
  pair.step = step;
  pair.time = Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1)) * step;
  pair.input = input;
  return pair;
}

Vector random_binary(Index samples, std::uint64_t seed, Index hold = 2) {
  Vector u(samples);
  numeric::Random random(seed, 1);
  for (Index i = 0; i < samples; ++i) {
    u[i] = i % hold == 0 ? (random.uniform() < 0.5 ? -1.0 : 1.0) : u[i - 1];
  }
  return u;
}

/// Behind noise (1 + d q⁻¹)/(1 + c q⁻¹) ε of that standard deviation of ε.
SignalPair noisy(Index samples, std::uint64_t seed, double deviation, double c = 0.0, double d = 0.0) {
  SignalPair pair = record(samples, 0.01, random_binary(samples, seed));
  const Truth truth;
  pair.output = plain_response(truth.b, truth.f, pair.input);
  Vector white(samples);
  numeric::Random random(seed, 2);
  for (double& e : white) e = deviation * random.normal();
  pair.output += plain_response(Vector{{1.0, d}}, Vector{{c}}, white);
  return pair;
}

PredictionErrorOptions four_poles(bool noise_model = false) {
  PredictionErrorOptions options;
  options.poles = 4;
  options.zeros = 3;
  options.noise_model = noise_model;
  return options;
}

Vector both(const PredictionErrorFit& fit) {
  Vector theta(fit.f.size() + fit.b.size());
  theta << fit.f, fit.b;
  return theta;
}

double largest_relative_error(const PredictionErrorFit& fit) {
  const Vector truth = Truth().theta();
  return ((both(fit) - truth).array() / truth.array()).abs().maxCoeff();
}

TEST(PredictionError, GivesANoiseFreeModelToEightDigits) {
  const auto fit = fit_prediction_error({noisy(2000, 1, 0.0)}, four_poles());
  ASSERT_TRUE(fit.has_value()) << fit.error().line();
  EXPECT_TRUE(fit->converged);
  EXPECT_LT(largest_relative_error(*fit), 1e-8) << both(*fit).transpose();
}

TEST(PredictionError, SharesOneModelAmongExperimentsThatBeganInTheMiddle) {
  std::vector<SignalPair> pieces;
  for (const std::uint64_t seed : {3U, 4U}) {
    const SignalPair whole = noisy(1500, seed, 0.0);
    SignalPair piece = record(1000, 0.01, whole.input.tail(1000));
    piece.output = whole.output.tail(1000).array() + static_cast<double>(seed);
    pieces.push_back(std::move(piece));
  }
  const auto fit = fit_prediction_error(pieces, four_poles());
  ASSERT_TRUE(fit.has_value() && fit->converged);
  EXPECT_LT(largest_relative_error(*fit), 1e-8);
  PredictionErrorOptions at_rest = four_poles();
  at_rest.free_start = false;
  const auto wrong = fit_prediction_error(pieces, at_rest);
  ASSERT_TRUE(wrong) << wrong.error().line();
  EXPECT_GT(largest_relative_error(*wrong), 1e-3);
}

/// ε of y = B/F u + D/C ε by the recursion itself, and its minimum by Gauss–Newton on difference quotients.
class PlainTwin {
 public:
  PlainTwin(const SignalPair& pair, Index poles, Index numerator, Index noise)
      : pair_(pair), n_(poles), q_(numerator), k_(noise) {}
  [[nodiscard]] Vector innovations(const Vector& theta) const {
    const Vector v = pair_.output - plain_response(theta.segment(n_, q_), theta.head(n_), pair_.input);
    Vector C(k_ + 1);
    C << 1.0, theta.segment(n_ + q_, k_);
    return plain_response(C, theta.tail(k_), v);
  }
  [[nodiscard]] Vector minimum(Vector theta) const {
    for (int pass = 0; pass < 60; ++pass) {
      const Vector e = innovations(theta);
      Matrix J(e.size(), theta.size());
      for (Index k = 0; k < theta.size(); ++k) {
        constexpr double kStep = 1e-6;
        const Vector move = kStep * Vector::Unit(theta.size(), k);
        J.col(k) = (innovations(theta + move) - innovations(theta - move)) / (2.0 * kStep);
      }
      const Vector step = -numeric::PivotedQr(J).solve(e);
      double share = 1.0;
      while (share > 1e-6 && !(innovations(theta + share * step).squaredNorm() < e.squaredNorm())) share *= 0.5;
      theta += share * step;
      if ((share * step).norm() < 1e-12) break;
    }
    return theta;
  }

 private:
  const SignalPair& pair_;
  Index n_, q_, k_;
};

TEST(PredictionError, AgreesWithAPlainTwinOnDifferenceQuotients) {
  const SignalPair pair = noisy(1500, 5, 0.1, -0.9, 0.3);
  constexpr double kRounding = 1e-6;  // of difference quotients
  for (const bool noise_model : {false, true}) {
    PredictionErrorOptions options = four_poles(noise_model);
    options.free_start = false;
    options.max_noise_order = 1;
    const auto fit = fit_prediction_error({pair}, options);
    ASSERT_TRUE(fit.has_value() && fit->converged);
    const Index k = fit->noise_denominator.size() - 1;
    ASSERT_EQ(k, noise_model ? 1 : 0);
    Vector start(8 + 2 * k);
    start << Truth().theta(), Vector::Constant(k, -0.8), Vector::Constant(k, 0.2);
    const PlainTwin twin(pair, 4, 4, k);
    const Vector least = twin.minimum(start);
    EXPECT_LT((both(*fit) - least.head(8)).cwiseAbs().maxCoeff(), kRounding);
    if (noise_model) {
      EXPECT_NEAR(fit->noise_denominator[1], least[8], kRounding);
      EXPECT_NEAR(fit->noise_numerator[1], least[9], kRounding);
    }
    const double squares = twin.innovations(least).squaredNorm();
    EXPECT_NEAR(fit->innovations[0].squaredNorm() / squares, 1.0, 1e-9);
  }
}

TEST(PredictionError, FromOneGivenStartEndsWhereAllStartsEnd) {
  const SignalPair pair = noisy(3000, 5, 0.1);
  PredictionErrorOptions options = four_poles(false);
  const auto all = fit_prediction_error({pair}, options);
  ASSERT_TRUE(all && all->converged && all->starts.size() > 1);
  options.start_denominator = Truth().theta().head(4);
  const auto one = fit_prediction_error({pair}, options);
  ASSERT_TRUE(one && one->converged);
  EXPECT_EQ(one->starts.size(), 1U);
  EXPECT_NEAR(one->variance / all->variance, 1.0, 1e-12);
  constexpr double kOfAnError = 1e-4;
  const Vector error = all->covariance.diagonal().cwiseSqrt();
  EXPECT_LT((both(*one) - both(*all)).cwiseQuotient(error).lpNorm<Eigen::Infinity>(), kOfAnError);
  options.start_denominator = Vector::Zero(3);
  EXPECT_EQ(fit_prediction_error({pair}, options).error().kind, ErrorKind::usage);
}

TEST(PredictionError, FindsTheOrderOfTheNoise) {
  const auto white = fit_prediction_error({noisy(3000, 6, 0.1)}, four_poles(true));
  ASSERT_TRUE(white.has_value() && white->converged);
  EXPECT_EQ(white->noise_denominator.size(), 1);
  const auto coloured = fit_prediction_error({noisy(3000, 6, 0.1, -0.95, 0.5)}, four_poles(true));
  ASSERT_TRUE(coloured.has_value() && coloured->converged);
  ASSERT_EQ(coloured->noise_denominator.size(), 2);
  EXPECT_NEAR(coloured->noise_denominator[1], -0.95, 0.03);
  EXPECT_NEAR(coloured->noise_numerator[1], 0.5, 0.06);
  EXPECT_NEAR(std::sqrt(coloured->variance), 0.1, 0.005);
}

struct MonteCarlo {
  Matrix estimates;       ///< run×coefficient
  Vector standard_error;  ///< root mean square over the runs
  Vector coverage;
};

MonteCarlo monte_carlo(bool noise_model, double c, double hac_lag_s) {
  constexpr int kRuns = 60;
  const Vector truth = Truth().theta();
  MonteCarlo all{Matrix(kRuns, truth.size()), Vector::Zero(truth.size()), Vector::Zero(truth.size())};
  for (int run = 0; run < kRuns; ++run) {
    PredictionErrorOptions options = four_poles(noise_model);
    options.hac_lag_s = hac_lag_s;
    options.max_noise_order = 2;
    options.threads = 1;
    const auto fit = fit_prediction_error({noisy(1000, 100U + static_cast<std::uint64_t>(run), 0.05, c)}, options);
    EXPECT_TRUE(fit.has_value() && fit->converged) << run;
    if (!fit) return all;  // which says that it failed
    all.estimates.row(run) = both(*fit);
    all.standard_error += fit->covariance.diagonal() / kRuns;
    const Vector off = (both(*fit) - truth).cwiseAbs().cwiseQuotient(fit->covariance.diagonal().cwiseSqrt());
    all.coverage += ((off.array() < 1.96).cast<double>() / kRuns).matrix();
  }
  all.standard_error = all.standard_error.cwiseSqrt();
  return all;
}

Vector spread(const MonteCarlo& all) {
  const Matrix centred = all.estimates.rowwise() - all.estimates.colwise().mean();
  return (centred.colwise().squaredNorm() / static_cast<double>(centred.rows() - 1)).cwiseSqrt().transpose();
}

TEST(PredictionError, ItsIntervalsHoldTheTruthAsOftenAsTheySay) {
  // Of 60 runs at 95 %, fewer than 51 hold with probability 10⁻³ for each coefficient.
  const MonteCarlo white = monte_carlo(false, 0.0, 0.0);
  EXPECT_GE(white.coverage.minCoeff(), 0.85) << white.coverage.transpose();
  const Vector efficiency = spread(white).cwiseQuotient(white.standard_error);  // of the bound of Cramér & Rao
  EXPECT_GT(efficiency.minCoeff(), 0.75);
  EXPECT_LT(efficiency.maxCoeff(), 1.25) << efficiency.transpose();
}

TEST(PredictionError, BoxJenkinsIsSharperThanOutputErrorInColouredNoise) {
  const MonteCarlo plain = monte_carlo(false, -0.95, 1.0), modelled = monte_carlo(true, -0.95, 0.0);
  EXPECT_GE(plain.coverage.minCoeff(), 0.82) << plain.coverage.transpose();  // ten seconds hold few seconds
  EXPECT_GE(modelled.coverage.minCoeff(), 0.85) << modelled.coverage.transpose();
  const Vector ratio = spread(modelled).cwiseQuotient(spread(plain));
  // The noise is strong where the input's gain is, and weak at both modes.
  EXPECT_LT(ratio.tail(4).maxCoeff(), 0.6) << ratio.transpose();
  EXPECT_LT(ratio.head(4).maxCoeff(), 1.1) << ratio.transpose();
}

TEST(PredictionError, DoesNotSettleOnAnUnstableSystem) {
  SignalPair pair = record(400, 0.01, random_binary(400, 7));
  pair.output = plain_response(Vector{{0.1}}, Vector{{-1.01}}, pair.input);
  PredictionErrorOptions options;
  options.poles = 1;
  options.zeros = 0;
  const auto fit = fit_prediction_error({pair}, options);
  ASSERT_TRUE(fit.has_value());
  EXPECT_FALSE(fit->converged);
  EXPECT_FALSE(fit->stable);
}

TEST(PredictionError, NeedsOneEvenClock) {
  SignalPair pair = noisy(500, 1, 0.1), uneven = pair, faster = pair;
  uneven.step.reset();
  EXPECT_EQ(fit_prediction_error({uneven}, four_poles()).error().kind, ErrorKind::usage);
  faster.time *= 0.5;
  *faster.step *= 0.5;
  const auto differ = fit_prediction_error({pair, faster}, four_poles());
  ASSERT_FALSE(differ.has_value());
  for (const char* const step : {" 10 ms", " 5 ms"})
    EXPECT_NE(differ.error().message.find(step), std::string::npos) << differ.error().message;
}

TEST(PredictionError, SaysWhatIsWrongWithItsData) {
  SignalPair pair = noisy(500, 1, 0.1);
  pair.output[17] = std::nan("");
  EXPECT_NE(fit_prediction_error({pair}, four_poles()).error().message.find("sample 18"), std::string::npos);
  EXPECT_EQ(fit_prediction_error({}, four_poles()).error().kind, ErrorKind::usage);
}

TEST(WithoutDiscreteFreeMotion, LeavesNothingOfADecayAndAnOffset) {
  const Truth truth;
  const Vector decay = plain_response(Vector{{1.0, -0.4, 2.0}}, truth.f, Vector::Unit(300, 0));
  const Vector left = without_discrete_free_motion(truth.f, decay.array() + 3.0);
  EXPECT_LT(left.cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace prediction_error_test
}  // namespace mbk::identify
