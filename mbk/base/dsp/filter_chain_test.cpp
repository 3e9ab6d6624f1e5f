#include "mbk/base/dsp/filter_chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "mbk/base/dsp/test_twins.h"

namespace mbk::dsp {
namespace filter_chain_test {

const Hertz kRate(1000.0);

FilterChain chain(SavitzkyGolay smoothing, double cutoff_hz) {
  return {smoothing, butterworth_lowpass(5, Hertz(cutoff_hz), kRate).value(), {}};
}

/// Motions of a few millimetres about a place, and forces, with the noise of sensors.
std::vector<Vector> signals(Index samples, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vector> all;
  for (std::size_t k = 0; k < count; ++k) {
    Vector& signal = all.emplace_back(samples);
    const double place = k % 2 == 0 ? 0.3 : -7.0, noise = k % 2 == 0 ? 1e-6 : 0.02, size = k % 2 == 0 ? 0.004 : 3.0;
    for (Index i = 0; i < samples; ++i) {
      const double t = static_cast<double>(i) / kRate.value;
      signal[i] = place + size * (std::sin(7.0 * t + static_cast<double>(k)) + 0.5 * std::sin(18.0 * t)) +
                  noise * normal(random);
    }
  }
  return all;
}

std::vector<Column> columns_of(const std::vector<Vector>& signals) {
  std::vector<Column> columns;
  for (const Vector& signal : signals) columns.emplace_back(signal.data(), signal.size());
  return columns;
}

const std::vector<FilterOutput> kTwoAxes = {{0, 0}, {2, 0}, {0, 1}, {2, 1}, {0, 2}, {2, 2}, {1, 0}, {3, 0}};

/// The slow plain twin: one filter after the other, one signal after the other.
Vector plain(const FilterChain& chain, const Vector& signal, int derivative) {
  twin::Signal values = twin::smoothed(chain.smoothing, derivative, twin::signal_of(signal), kRate);
  if (!chain.lowpass.empty()) values = twin::zero_phase(chain.lowpass, values, chain.padding);
  Vector result(static_cast<Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) result[static_cast<Index>(i)] = static_cast<double>(values[i]);
  return result;
}

double largest(const Vector& values) {
  return values.cwiseAbs().maxCoeff();
}

TEST(FilterChain, AgreesWithOneFilterAfterTheOther) {
  constexpr double kTolerance = 1.5e-10;  // of the largest value; the least windows lose most, without FMA 1.06e-10
  const auto all = signals(3000, 4, 1);
  for (const SavitzkyGolay smoothing :
       {SavitzkyGolay{6, 101}, {6, 151}, {6, 31}, {4, 99}, {2, 41}, {3, 101}, {6, 21}}) {
    {
      for (FilterChain c : {chain(smoothing, 5.0), chain(smoothing, 40.0), FilterChain{smoothing, {}, {}}}) {
        const Matrix filtered = smooth_then_lowpass(c, columns_of(all), kTwoAxes, kRate).value();
        for (std::size_t k = 0; k < kTwoAxes.size(); ++k) {
          const Vector want = plain(c, all[static_cast<std::size_t>(kTwoAxes[k].column)], kTwoAxes[k].derivative);
          ASSERT_EQ(filtered.rows(), want.size());
          EXPECT_LT(largest(filtered.col(static_cast<Index>(k)) - want), kTolerance * largest(want))
              << "N " << smoothing.order << ", W " << smoothing.window << ", signal " << k;
        }
      }
    }
  }
}

TEST(FilterChain, TakesAnyNumberOfColumnsAndDerivatives) {
  const auto all = signals(800, 6, 2);
  std::vector<FilterOutput> outputs;
  for (Index column = 0; column < 6; ++column) {
    for (int derivative = 0; derivative <= static_cast<int>(column % 5); ++derivative) {
      outputs.push_back({column, derivative});
    }
  }
  const FilterChain c = chain({6, 61}, 15.0);
  const Matrix filtered = smooth_then_lowpass(c, columns_of(all), outputs, kRate).value();
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const Vector want = plain(c, all[static_cast<std::size_t>(outputs[k].column)], outputs[k].derivative);
    EXPECT_LT(largest(filtered.col(static_cast<Index>(k)) - want),
              std::pow(10.0, std::max(outputs[k].derivative, 2) - 12.0) * largest(want))
        << k << ", derivative " << outputs[k].derivative;
  }
}

TEST(FilterChain, ContinuesSignalsAsAsked) {
  const auto all = signals(900, 2, 3);
  const std::vector<FilterOutput> outputs = {{0, 0}, {1, 0}};
  for (const Extension extension : {Extension::odd, Extension::even, Extension::constant}) {
    FilterChain c = chain({6, 101}, 5.0);
    c.padding = {extension, 60};
    const Matrix filtered = smooth_then_lowpass(c, columns_of(all), outputs, kRate).value();
    for (Index k = 0; k < 2; ++k) {
      const Vector want = plain(c, all[static_cast<std::size_t>(k)], 0);
      EXPECT_LT(largest(filtered.col(k) - want), 1e-11 * largest(want));
    }
  }
}

TEST(FilterChain, KeepsAConstantExactlyAndHasNoDerivativeOfIt) {
  const std::vector<Vector> constant = {Vector::Constant(500, 0.3)};
  const std::vector<FilterOutput> outputs = {{0, 0}, {0, 1}, {0, 2}};
  for (const Matrix& filtered :
       {smooth_then_lowpass(chain({6, 101}, 5.0), columns_of(constant), outputs, kRate).value(),
        smooth_then_lowpass(chain({6, 101}, 5.0), columns_of(constant), outputs, kRate, 7).value()}) {
    EXPECT_TRUE((filtered.col(0).array() == 0.3).all());
    EXPECT_TRUE((filtered.rightCols(2).array() == 0.0).all());
  }
}

TEST(FilterChain, GivesEveryStepthRowOfTheWhole) {
  const std::vector<FilterOutput> three = {{0, 0}, {0, 1}, {0, 2}};
  for (const Index samples : {1200, 9000, 15001, 30000}) {
    const auto all = signals(samples, 4, 4);
    for (FilterChain c : {chain({6, 101}, 5.0), chain({4, 35}, 30.0), FilterChain{{6, 31}, {}, {}}}) {
      c.padding.samples = 30;
      for (const Index step : {1, 7, 20, 500}) {
        for (const std::vector<FilterOutput>& outputs : {kTwoAxes, three}) {
          const Matrix full = smooth_then_lowpass(c, columns_of(all), outputs, kRate).value();
          const Matrix some = smooth_then_lowpass(c, columns_of(all), outputs, kRate, step).value();
          ASSERT_EQ(some.rows(), (full.rows() - 1) / step + 1);
          const Matrix want = full(Eigen::seqN(0, some.rows(), step), Eigen::all);
          for (Index k = 0; k < full.cols(); ++k) {
            EXPECT_LT(largest(some.col(k) - want.col(k)), kDecimationError * largest(full.col(k)))
                << samples << " samples, every " << step << "th, signal " << k;
          }
        }
      }
    }
  }
}

TEST(FilterChain, GivesEveryStepthRowOfTheEndsHoweverTheyAreContinued) {
  const auto all = signals(2600, 4, 5);
  for (const Extension extension : {Extension::odd, Extension::even, Extension::constant}) {
    for (const Index padding : {0, 1, 15, 400}) {
      for (const double cutoff_hz : {3.0, 5.0, 11.0}) {
        for (const Index step : {2, 9, 20}) {
          FilterChain c = chain({6, 101}, cutoff_hz);
          c.padding = {extension, padding};
          const Matrix full = smooth_then_lowpass(c, columns_of(all), kTwoAxes, kRate).value();
          const Matrix some = smooth_then_lowpass(c, columns_of(all), kTwoAxes, kRate, step).value();
          const Matrix want = full(Eigen::seqN(0, some.rows(), step), Eigen::all);
          for (Index k = 0; k < full.cols(); ++k) {
            EXPECT_LT(largest(some.col(k) - want.col(k)), kDecimationError * largest(full.col(k)))
                << word_of(extension) << ", padding " << padding << ", " << cutoff_hz << " Hz, every " << step
                << "th, signal " << k;
          }
        }
      }
    }
  }
}

TEST(FilterChain, KeepsALinearRelationOfSignalsInEveryStepthRow) {
  // All signals pass the same linear filter, ends included, or −F = M ẍ + B ẋ + K x would not survive it.
  constexpr double kRounding = 1e-12;
  auto all = signals(20000, 2, 9);
  all.push_back(2.0 * all[0] - 3.0 * all[1]);
  const std::vector<FilterOutput> outputs = {{0, 0}, {1, 0}, {2, 0}, {0, 2}, {1, 2}, {2, 2}};
  const Matrix some = smooth_then_lowpass(chain({6, 101}, 5.0), columns_of(all), outputs, kRate, 20).value();
  for (const Index first : {0, 3}) {
    const Vector left = some.col(first + 2) - 2.0 * some.col(first) + 3.0 * some.col(first + 1);
    EXPECT_LT(largest(left), kRounding * largest(some.col(first + 1)));
  }
}

TEST(FilterChain, GoesThroughALongSignalInBlocksThatLeaveNoTrace) {
  constexpr Index kLong = 2'300'000;  // more than two blocks
  const auto all = signals(kLong, 1, 8);
  const std::vector<FilterOutput> outputs = {{0, 0}, {0, 2}};
  const FilterChain c = chain({6, 101}, 5.0);
  const Matrix some = smooth_then_lowpass(c, columns_of(all), outputs, kRate, 20).value();
  // About the end of the first block, and by itself a piece in one block, of which the ends do not count.
  constexpr Index kFirst = 1'000'000, kCount = 100'000, kEnds = 10'000;
  const std::vector<Vector> piece = {all[0].segment(kFirst, kCount)};
  const Matrix by_itself = smooth_then_lowpass(c, columns_of(piece), outputs, kRate, 20).value();
  constexpr Index kSkip = kEnds / 20, kRows = (kCount - 2 * kEnds) / 20;
  for (Index k = 0; k < 2; ++k) {
    const Vector difference = some.col(k).segment(kFirst / 20 + kSkip, kRows) - by_itself.col(k).segment(kSkip, kRows);
    EXPECT_LT(largest(difference), 1e-12 * largest(some.col(k))) << k;
  }
}

TEST(FilterChain, RefusesWhatItCannotFilter) {
  const auto all = signals(110, 2, 6);
  const std::vector<FilterOutput> outputs = {{0, 0}};
  const auto message = [&](const auto& result) { return result ? std::string() : result.error().message; };
  EXPECT_NE(message(smooth_then_lowpass(chain({6, 151}, 5.0), columns_of(all), outputs, kRate)).find("151"),
            std::string::npos);
  EXPECT_NE(message(smooth_then_lowpass(chain({6, 101}, 5.0), columns_of(all), outputs, kRate)).find("padding"),
            std::string::npos);
  EXPECT_NE(message(smooth_then_lowpass(chain({6, 101}, 5.0), columns_of(all), outputs, kRate, 1)).find("padding"),
            std::string::npos);
  EXPECT_FALSE(smooth_then_lowpass(chain({6, 31}, 5.0), columns_of(all), outputs, kRate, 0));
  EXPECT_FALSE(smooth_then_lowpass(chain({6, 100}, 5.0), columns_of(all), outputs, kRate));
  std::vector<Vector> unequal = {all[0], all[1].head(50)};
  EXPECT_FALSE(smooth_then_lowpass(chain({6, 31}, 5.0), columns_of(unequal), outputs, kRate));
}

}  // namespace filter_chain_test
}  // namespace mbk::dsp
