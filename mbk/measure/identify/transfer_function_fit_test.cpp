#include "mbk/measure/identify/transfer_function_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <regex>
#include <string>

#include "mbk/base/dsp/derivative_filter.h"
#include "mbk/base/numeric/random.h"
#include "mbk/measure/identify/srivc.h"

namespace mbk::identify {
namespace {

/// A pair of poles at 2 Hz with ζ = 0.1, gain 3, behind a random binary input and a delay of whole samples.
SignalPair oscillator(Index delay, double noise, std::uint64_t seed) {
  constexpr Index kSamples = 4000;
  const double w = 2.0 * std::numbers::pi * 2.0;
  SignalPair pair;
  pair.step = 0.01;
  pair.time = Vector::LinSpaced(kSamples, 0.0, static_cast<double>(kSamples - 1)) * 0.01;
  pair.input.resize(kSamples);
  pair.output = pair.input;
  numeric::Random random(seed);
  for (Index i = 0; i < kSamples; ++i) {
    pair.input[i] = i % 10 == 0 ? (random.uniform() < 0.5 ? -1.0 : 1.0) : pair.input[i - 1];
  }
  SignalPair late = pair;
  late.held = 1.0;
  late.input.tail(kSamples - delay) = pair.input.head(kSamples - delay);
  late.input.head(delay).setConstant(pair.input[0]);
  pair.output = simulate_continuous(Vector{{w * w, 0.2 * w}}, Vector{{3.0 * w * w}}, late);
  for (double& y : pair.output) y += noise * random.normal();
  return pair;
}

TransferFunctionOptions two_poles() {
  TransferFunctionOptions options;
  options.poles = 2;
  options.zeros = 0;
  return options;
}

TEST(TransferFunctionFit, GivesFrequencyAndDampingWithIntervals) {
  const auto found = identify_transfer_function({oscillator(0, 0.5, 1)}, {oscillator(0, 0.0, 2)}, two_poles());
  ASSERT_TRUE(found.has_value());
  ASSERT_EQ(found->poles.size(), 1U);
  const Root& pole = found->poles[0];
  EXPECT_TRUE(pole.pair);
  EXPECT_NEAR(pole.frequency, 2.0, 4.0 * pole.frequency_standard_error);
  EXPECT_NEAR(pole.damping, 0.1, 4.0 * pole.damping_standard_error);
  EXPECT_LT(pole.frequency_standard_error, 0.01);
  EXPECT_NEAR(found->gain, 3.0, 4.0 * found->gain_standard_error);
  EXPECT_GT(found->held_out_fit.value(), 0.999);
  EXPECT_TRUE(found->residuals.white());
  EXPECT_TRUE(found->residuals.independent());
  EXPECT_FALSE(pole.outside_band);
}

TEST(TransferFunctionFit, FindsADelay) {
  TransferFunctionOptions options = two_poles();
  options.find_delay = true;
  const auto found = identify_transfer_function({oscillator(4, 0.2, 1)}, {}, options);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->model.delay, 0.04, 0.002);
  EXPECT_TRUE(found->delay_found);
}

TEST(TransferFunctionFit, WithoutThatDelaySaysThatTheInputExplainsWhatIsLeft) {
  const auto found = identify_transfer_function({oscillator(6, 0.2, 1)}, {}, two_poles());
  ASSERT_TRUE(found.has_value());
  EXPECT_FALSE(found->residuals.independent());
}

/// A pair of poles at 2 Hz, and one at 5 Hz beside it if `second`, in a loop that holds its input, u = r − 0.3 y; r is
/// random binary, and noise of one pole has half the deviation of the output.
SignalPair in_a_loop(std::uint64_t seed, bool second) {
  constexpr Index kSamples = 4000;
  constexpr double kStep = 0.01, kFeedback = 0.3, kMemory = 0.9;
  const double w = 2.0 * std::numbers::pi * 2.0, v = 2.5 * w;
  dsp::DerivativeFilter slow(Vector{{w * w, 0.6 * w}}, 1.0), fast(Vector{{v * v, 0.4 * v}}, 1.0);
  SignalPair pair;
  pair.step = kStep;
  pair.time = Vector::LinSpaced(kSamples, 0.0, static_cast<double>(kSamples - 1)) * kStep;
  pair.input = pair.output = pair.reference = Vector::Zero(kSamples);
  numeric::Random random(seed);
  double noise = 0.0;
  for (Index i = 0; i < kSamples; ++i) {
    noise = kMemory * noise + 0.2 * random.normal();
    pair.output[i] = w * w * slow.state()[0] + (second ? 0.5 * v * v * fast.state()[0] : 0.0) + noise;
    pair.reference[i] = i % 10 == 0 ? (random.uniform() < 0.5 ? -1.0 : 1.0) : pair.reference[i - 1];
    pair.input[i] = pair.reference[i] - kFeedback * pair.output[i];
    for (auto* const filter : {&slow, &fast}) {
      Matrix state(2, 1);
      filter->begin(pair.input[i]);
      filter->run(kStep, &pair.input[i], 1, state);
    }
  }
  return pair;
}

int said_that_the_input_explains_the_residual(bool second, int runs) {
  TransferFunctionOptions options = two_poles();
  options.method = TransferFunctionMethod::closed_loop;
  options.hold = InputHold::zero;
  int said = 0;
  for (int run = 0; run < runs; ++run) {
    const auto found = identify_transfer_function({in_a_loop(static_cast<std::uint64_t>(run), second)}, {}, options);
    EXPECT_TRUE(found.has_value()) << run;
    said += found && !found->residuals.independent() ? 1 : 0;
  }
  return said;
}

TEST(TransferFunctionFit, InALoopSaysThatTheInputExplainsTheResidualOnlyWhereAPartIsMissing) {
  // The level is 1 %: more than 4 of 60 come with probability 3·10⁻⁴.
  EXPECT_LE(said_that_the_input_explains_the_residual(false, 60), 4);
  EXPECT_EQ(said_that_the_input_explains_the_residual(true, 10), 10);
}

Vector autoregressive_noise(Index samples, double memory, std::uint64_t seed) {
  Vector e(samples);
  numeric::Random random(seed);
  double last = 0.0;
  for (double& value : e) value = last = memory * last + random.normal();
  return e;
}

TEST(ResidualTests, KeepTheirLevelWhateverTheColourOfInputAndResidual) {
  constexpr int kRuns = 1000;
  for (const double memory : {0.0, 0.9, 0.98}) {
    for (const double of_input : {0.0, 0.98}) {
      int said = 0;
      for (int run = 0; run < kRuns; ++run) {
        const auto seed = static_cast<std::uint64_t>(2 * run);
        const ResidualTests tests = test_residuals({autoregressive_noise(2000, memory, seed)},
                                                   {autoregressive_noise(2000, of_input, seed + 1)}, 50);
        said += tests.independent() ? 0 : 1;
      }
      EXPECT_LE(said, 21) << memory << " " << of_input;  // 10 are expected; P(> 21) = 5·10⁻⁴
    }
  }
}

TEST(ResidualTests, FindWhatTheInputStillExplains) {
  const Vector u = autoregressive_noise(2000, 0.9, 1);
  Vector e = autoregressive_noise(2000, 0.95, 2);
  EXPECT_TRUE(test_residuals({e}, {u}, 50).independent());
  e.tail(1990) += 0.15 * u.head(1990);  // ten samples late, 2 % of the variance
  EXPECT_FALSE(test_residuals({e}, {u}, 50).independent());
}

TEST(TransferFunctionFit, ChoosesTheTrueOrder) {
  TransferFunctionOptions options;
  options.orders = {{1, 0}, {2, 0}, {2, 1}, {3, 0}, {3, 1}, {3, 2}, {4, 1}};
  const auto found = identify_transfer_function({oscillator(0, 0.5, 1)}, {}, options);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->model.poles(), 2);
  EXPECT_EQ(found->model.zeros(), 0);
  EXPECT_EQ(found->orders.size(), options.orders.size());
}

TEST(TransferFunctionFit, ChoosesRaoAndGarniersOrder) {
  SignalPair pair = oscillator(0, 0.0, 9);
  pair.held = 1.0;
  const Vector a{{1600.0, 416.0, 408.0, 5.0}}, b{{1600.0, -6400.0}};
  pair.output = simulate_continuous(a, b, pair);
  const double level = std::sqrt((pair.output.array() - pair.output.mean()).square().mean() / 10.0);
  numeric::Random random(4);
  for (double& y : pair.output) y += level * random.normal();
  TransferFunctionOptions options;
  options.orders = {{2, 0}, {2, 1}, {3, 0}, {3, 1}, {3, 2}, {4, 0}, {4, 1}, {4, 2}, {4, 3}, {5, 1}, {5, 2}};
  const auto found = identify_transfer_function({pair}, {}, options);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->model.poles(), 4);
  EXPECT_EQ(found->model.zeros(), 1);
}

TEST(TransferFunctionFit, RefusesWhatDidNotSettle) {
  SignalPair pair = oscillator(0, 0.0, 1);
  numeric::Random random(2);
  for (double& y : pair.output) y = random.normal();  // nothing of the input
  TransferFunctionOptions options;
  options.poles = 6;
  options.zeros = 5;
  const auto found = identify_transfer_function({pair}, {}, options);
  if (found) {
    EXPECT_LT(found->fit, 0.1);
    EXPECT_FALSE(found->warnings.empty());
    for (const Root& pole : found->poles) EXPECT_LT(pole.value.real(), 0.0);
  } else {
    EXPECT_EQ(found.error().kind, ErrorKind::not_usable);
  }
}

/// x″ = a x − b x′ + u, unstable, held by u = r − 40 x − 8 x′.
SignalPair held_by_a_loop(double a, double b) {
  constexpr Index kSamples = 4000;
  constexpr int kParts = 10;
  constexpr double kStep = 0.01;
  SignalPair pair;
  pair.step = kStep;
  pair.time = Vector::LinSpaced(kSamples, 0.0, static_cast<double>(kSamples - 1)) * kStep;
  pair.input = pair.output = pair.reference = Vector::Zero(kSamples);
  numeric::Random random(3);
  double x = 0.0, v = 0.0, r = 0.0;
  for (Index i = 0; i < kSamples; ++i) {
    pair.reference[i] = r = 0.9 * r + random.normal();
    pair.input[i] = r - 40.0 * x - 8.0 * v;
    pair.output[i] = x + 0.001 * random.normal();
    for (int k = 0; k < kParts; ++k) {
      v += kStep / kParts * (a * x - b * v + pair.input[i]);
      x += kStep / kParts * v;
    }
  }
  return pair;
}

TEST(TransferFunctionFit, OfAnUnstableSystemInALoopSaysToIdentifyTheLoop) {
  for (const auto& [a, b] : {std::pair{9.0, 0.5}, {-20.0, -1.0}}) {
    SignalPair pair = held_by_a_loop(a, b);
    TransferFunctionOptions options = two_poles();
    options.hold = InputHold::zero;
    for (const auto method : {TransferFunctionMethod::closed_loop, TransferFunctionMethod::srivc}) {
      options.method = method;
      const auto found = identify_transfer_function({pair}, {}, options);
      ASSERT_FALSE(found.has_value());
      EXPECT_EQ(found.error().kind, ErrorKind::not_usable);
      const std::string& remedy = found.error().remedy;
      EXPECT_LT(remedy.find("--output INPUT"), remedy.find("--start-pole")) << remedy;
    }
    options.method = TransferFunctionMethod::closed_loop;
    const auto found = identify_transfer_function({pair}, {}, options);
    const std::string message = found.error().message;
    std::smatch seconds;  // in which its motion grows by e
    ASSERT_TRUE(std::regex_search(message, seconds, std::regex(R"(([\d.]+) s\b)"))) << message;
    const double root = 0.5 * (std::sqrt(std::max(b * b + 4.0 * a, 0.0)) - b);
    EXPECT_NEAR(std::stod(seconds[1].str()), 1.0 / root, 0.1 / root);
    pair.input = pair.reference;
    const auto loop = identify_transfer_function({pair}, {}, two_poles());
    ASSERT_TRUE(loop.has_value()) << loop.error().line();
    EXPECT_NEAR(loop->model.denominator[0], 40.0 - a, 1.5);
  }
}

TransferFunctionOptions discrete(TransferFunctionMethod method) {
  TransferFunctionOptions options;
  options.method = method;
  options.poles = options.zeros = 2;  // an input of straight lines makes as many zeros as poles
  return options;
}

TEST(TransferFunctionFit, GivesADiscreteModelInHertzToo) {
  for (const auto method : {TransferFunctionMethod::output_error, TransferFunctionMethod::box_jenkins}) {
    const auto found = identify_transfer_function({oscillator(0, 0.5, 1)}, {oscillator(0, 0.0, 2)}, discrete(method));
    ASSERT_TRUE(found.has_value()) << found.error().line();
    EXPECT_NEAR(found->model.sample_time, 0.01, 1e-12);
    EXPECT_EQ(found->model.denominator[0], 1.0);
    ASSERT_EQ(found->poles.size(), 1U);
    const Root& pole = found->poles[0];
    EXPECT_TRUE(pole.pair);
    EXPECT_NEAR(pole.frequency, 2.0, 4.0 * pole.frequency_standard_error);
    EXPECT_NEAR(pole.damping, 0.1, 4.0 * pole.damping_standard_error);
    EXPECT_LT(pole.frequency_standard_error, 0.01);
    EXPECT_NEAR(found->gain, 3.0, 4.0 * found->gain_standard_error);
    EXPECT_GT(found->held_out_fit.value(), 0.999);
    EXPECT_TRUE(found->residuals.white());
    EXPECT_TRUE(found->residuals.independent());
  }
}

TEST(TransferFunctionFit, FindsADelayOfWholeSamplesInDiscreteTime) {
  TransferFunctionOptions options = discrete(TransferFunctionMethod::output_error);
  options.zeros = 1;  // what is held makes one fewer, and answers a sample later
  options.find_delay = true;
  options.max_delay = 0.08;
  const auto found = identify_transfer_function({oscillator(4, 0.05, 1)}, {}, options);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->model.delay, 0.05, 1e-12);
  options.find_delay = false;
  options.delay = 0.043;
  const auto between = identify_transfer_function({oscillator(4, 0.05, 1)}, {}, options);
  ASSERT_FALSE(between.has_value());
  EXPECT_EQ(between.error().kind, ErrorKind::usage);
  for (const char* const delay : {"0.04 ", "0.05 "})
    EXPECT_NE(between.error().remedy.find(delay), std::string::npos) << between.error().remedy;
}

TEST(TransferFunctionFit, ChoosesTheTrueOrderInDiscreteTime) {
  TransferFunctionOptions options = discrete(TransferFunctionMethod::output_error);
  options.orders = {{1, 0}, {1, 1}, {2, 0}, {2, 1}, {2, 2}, {3, 2}, {4, 3}};
  const auto found = identify_transfer_function({oscillator(0, 0.02, 1)}, {}, options);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->model.poles(), 2);
  EXPECT_EQ(found->orders.size(), options.orders.size());
}

TEST(RootsWithIntervals, AgreeWithMovedCoefficientsInDiscreteTime) {
  const Vector c{{0.7, -1.9, 2.6, -2.3, 1.0}};  // of z⁰ … z⁴
  constexpr double T = 0.02;
  for (Index k = 0; k < 4; ++k) {
    Matrix covariance = Matrix::Zero(4, 4);
    const double h = 1e-6 * c[k];
    covariance(k, k) = h * h;
    Vector moved = c;
    moved[k] += h;
    const auto roots = roots_with_intervals(c, covariance, T), at = roots_with_intervals(moved, covariance, T);
    ASSERT_EQ(roots.size(), at.size());
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const auto z = std::exp(roots[i].value * T);
      EXPECT_LT(std::abs((((z + c[3]) * z + c[2]) * z + c[1]) * z + c[0]), 1e-12);
      EXPECT_NEAR(std::abs(at[i].frequency - roots[i].frequency), roots[i].frequency_standard_error, 1e-8);
      if (!roots[i].pair) continue;
      EXPECT_NEAR(std::abs(at[i].damping - roots[i].damping), roots[i].damping_standard_error, 1e-8);
    }
  }
}

TEST(RootsWithIntervals, AgreeWithMovedCoefficients) {
  const Vector c{{1600.0, 416.0, 408.0, 5.0, 1.0}};
  for (Index k = 0; k < 4; ++k) {
    Matrix covariance = Matrix::Zero(4, 4);
    const double h = 1e-6 * c[k];
    covariance(k, k) = h * h;
    Vector moved = c;
    moved[k] += h;
    const auto roots = roots_with_intervals(c, covariance), at = roots_with_intervals(moved, covariance);
    ASSERT_EQ(roots.size(), 2U);
    for (std::size_t i = 0; i < roots.size(); ++i) {
      EXPECT_NEAR(std::abs(at[i].frequency - roots[i].frequency), roots[i].frequency_standard_error, 1e-9);
      EXPECT_NEAR(std::abs(at[i].damping - roots[i].damping), roots[i].damping_standard_error, 1e-9);
    }
  }
}

}  // namespace
}  // namespace mbk::identify
