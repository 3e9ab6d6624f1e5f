#include "mbk/base/dsp/segments.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::dsp {
namespace {

/// A damped and a slow pair and, where n is odd, a real root, about 1.
Vector denominator(Index n) {
  Vector a = Vector::Ones(1);  // ascending, monic
  const auto times = [&](const Vector& factor) {
    Vector product = Vector::Zero(a.size() + factor.size() - 1);
    for (Index i = 0; i < factor.size(); ++i) product.segment(i, a.size()) += factor[i] * a;
    a = product;
  };
  for (Index k = 0; k + 1 < n; k += 2) {
    const double w = 1.0 + 0.3 * static_cast<double>(k);
    times(Vector{{w * w, k == 0 ? 0.02 * w : 0.8 * w, 1.0}});
  }
  if (n % 2 == 1) times(Vector{{1.3, 1.0}});
  return a.head(n);
}

Vector wave(Index samples, double rate) {
  Vector u(samples);
  for (Index i = 0; i < samples; ++i) {
    u[i] = std::sin(rate * static_cast<double>(i * i % 977)) + (i % 50 < 25 ? 1.0 : 0.0);
  }
  return u;
}

/// The same sample after sample.
Matrix one_after_the_other(const Vector& a, double step, const Vector& u, const Vector& start) {
  DerivativeFilter filter(a);
  Matrix states(a.size(), u.size());
  filter.set_state(start);
  states.col(0) = start;
  filter.begin(u[0]);
  filter.run(step, u.data() + 1, u.size() - 1, states.rightCols(u.size() - 1));
  return states;
}

/// Largest difference of all segments to `expected`, in blocks of 7 steps.
double difference(SegmentFilter filter, const Segments& signals, const Matrix& expected) {
  constexpr Index kSteps = 7;
  const Index n = expected.rows();
  std::vector<SampleBlock> table(static_cast<std::size_t>(n * kSteps));
  const Rows rows{table.data()->values.data(), kSteps * kSegments};
  double most = 0.0;
  for (Index begin = 0; begin < signals.length(); begin += kSteps) {
    const Index steps = std::min(kSteps, signals.length() - begin);
    filter.run(signals.row(0, begin), steps, rows);
    for (Index i = 0; i < steps; ++i) {
      for (Index l = 0; l < kSegments; ++l) {
        const Index sample = l * signals.length() + begin + i;
        if (sample >= expected.cols()) continue;
        for (Index r = 0; r < n; ++r) {
          most = std::max(most, std::abs(rows.row(r)[kSegments * i + l] - expected(r, sample)));
        }
      }
    }
  }
  return most;
}

constexpr double kStep = 0.11;

TEST(Segments, FilterAsOneSampleAfterTheOther) {
  for (const Index samples : {5, 16, 40, 999, 1600}) {
    for (const Index n : {1, 2, 3, 4, 5, 6, 7, 8, 11}) {
      const Vector a = denominator(n), u = wave(samples, 0.3);
      const Matrix expected = one_after_the_other(a, kStep, u, Vector::Zero(n));
      const HeldStep filter = held_step(a, kStep);
      const Segments signals({&u});
      const double most = difference(SegmentFilter(filter, states_at_starts(filter, signals, 0)), signals, expected);
      EXPECT_LT(most, 1e-12 * std::max(1.0, expected.cwiseAbs().maxCoeff())) << samples << " samples, n = " << n;
    }
  }
}

TEST(Segments, CarryAFreeMotionOn) {
  const Vector a = denominator(4), none = Vector::Zero(700), start{{0.3, -1.0, 2.0, 0.7}};
  const HeldStep filter = held_step(a, kStep);
  const Segments signals({&none});
  const Matrix starts = free_at_starts(filter.transition, start, signals.length());
  EXPECT_LT(difference(SegmentFilter(filter, starts), signals, one_after_the_other(a, kStep, none, start)), 1e-12);
}

TEST(Segments, FindTheStatesOfAFilterBehindAFilter) {
  const Index n = 3;
  const Vector a = denominator(n), u = wave(803, 0.7), weights{{0.4, -1.1, 0.2}};
  const double through = 0.6;
  const Matrix first = one_after_the_other(a, kStep, u, Vector::Zero(n));
  const Vector between = first.transpose() * weights + through * u;
  const Matrix second = one_after_the_other(a, kStep, between, Vector::Zero(n));
  const Segments signals({&u});
  const HeldStep filter = held_step(a, kStep);
  const Matrix starts = states_at_starts(cascaded(filter, filter, weights, through), signals, 0);
  for (Index l = 0; l < kSegments; ++l) {
    const Index begin = l * signals.length();
    ASSERT_LT(begin, u.size());
    EXPECT_LT((starts.col(l).head(n) - first.col(begin)).lpNorm<Eigen::Infinity>(), 1e-12) << l;
    EXPECT_LT((starts.col(l).tail(n) - second.col(begin)).lpNorm<Eigen::Infinity>(), 1e-12) << l;
  }
}

TEST(Segments, HoldEachSampleAndZeroAfterTheLast) {
  const Vector u = Vector::LinSpaced(35, 1.0, 35.0), y = -u;
  const Segments signals({&u, &y}, 2);
  ASSERT_EQ(signals.length(), 3);
  EXPECT_EQ(signals.row(0, 0)[1], 4.0);
  EXPECT_EQ(signals.row(1, 5)[0], -6.0);  // overlap: what the second begins with
  EXPECT_EQ(signals.row(0, 1)[11], 35.0);
  EXPECT_EQ(signals.row(0, 2)[11], 0.0);
}

/// Largest difference of the states at every eighth sample to `expected`, three strides at a time.
double difference(StridedFilter filter, const double* input, Index strides, Index length, const Matrix& expected) {
  constexpr Index kAtOnce = 3, kColumns = (kAtOnce + 1) * kSegments;
  std::vector<SampleBlock> table(static_cast<std::size_t>(expected.rows() * (kAtOnce + 1)));
  const Rows rows{table.data()->values.data(), kColumns};
  double most = 0.0;
  for (Index k = 0; k < strides; k += kAtOnce) {
    const Index count = std::min(kAtOnce, strides - k);
    filter.run(input == nullptr ? nullptr : input + kSegments * kStride * k, count, rows);
    const Matrix behind = filter.state();
    for (Index c = 0; c < kSegments * (count + 1); ++c) {
      const Index sample = c % kSegments * length + kStride * (k + c / kSegments);
      for (Index r = 0; r < expected.rows() && sample < expected.cols(); ++r) {
        most = std::max(most, std::abs(rows.row(r)[c] - expected(r, sample)));
        if (c >= kSegments * count) most = std::max(most, std::abs(behind(r, c % kSegments) - expected(r, sample)));
      }
    }
  }
  return most;
}

TEST(StridedFilter, StandsWhereTheFilterIsAtEveryEighthSample) {
  for (const Index samples : {5, 140, 999, 1600}) {
    for (const Index n : {1, 2, 4, 5, 8, 11}) {
      const Vector a = denominator(n), u = wave(samples, 0.3);
      const Matrix expected = one_after_the_other(a, kStep, u, Vector::Zero(n));
      const HeldStep filter = held_step(a, kStep);
      const Segments signals({&u});
      const Index strides = signals.strides(samples);
      EXPECT_EQ(strides, samples < 16 ? 0 : (samples - 15 * signals.length()) / kStride);
      const StridedFilter strided(filter, states_at_starts(filter, signals, 0));
      EXPECT_LT(difference(strided, signals.row(0, 0), strides, signals.length(), expected),
                1e-12 * std::max(1.0, expected.cwiseAbs().maxCoeff()))
          << samples << " samples, n = " << n;
    }
  }
}

TEST(StridedFilter, CarriesAFreeMotionOn) {
  const Vector a = denominator(4), none = Vector::Zero(700), start{{0.3, -1.0, 2.0, 0.7}};
  const Matrix transition = held_step(a, kStep).transition;
  const Index length = Segments({&none}).length();
  const StridedFilter strided(transition, free_at_starts(transition, start, length));
  EXPECT_LT(difference(strided, nullptr, 5, length, one_after_the_other(a, kStep, none, start)), 1e-12);
}

TEST(Segments, GiveEveryEighthSampleByItself) {
  const Vector u = Vector::LinSpaced(395, 1.0, 395.0), y = -u;  // 25 of each segment but the last
  const Segments signals({&u, &y});
  ASSERT_EQ(signals.strides(u.size()), 2);
  const Rows input = signals.strided(0, 0), output = signals.strided(1, 0);
  EXPECT_EQ(input.row(3)[0], 4.0);
  EXPECT_EQ(signals.strided(0, 1).row(3)[0], 12.0);
  EXPECT_EQ(input.row(3)[input.step + 2], 62.0);
  EXPECT_EQ(output.row(7)[15], -383.0);
  Products products(kStride, kStride);
  products.add(input, output, 2 * kSegments);
  double sum = 0.0;  // of samples 8·k + 3 and 8·k + 7
  for (Index l = 0; l < kSegments; ++l) {
    for (Index k = 0; k < 2; ++k) sum += u[25 * l + 8 * k + 3] * y[25 * l + 8 * k + 7];
  }
  EXPECT_DOUBLE_EQ(products.total()(3, 7), sum);
}

TEST(Segments, ProductsAndCombinationsAreThoseOfMatrices) {
  constexpr Index kColumns = 48;
  for (const Index left : {1, 2, 3, 4, 5, 6, 7, 9}) {
    for (const Index right : {1, 2, 3, 4, 5, 7, 8, 10}) {
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> table(left + right, kColumns);
      for (Index r = 0; r < table.rows(); ++r) table.row(r) = wave(kColumns, 0.1 * static_cast<double>(r + 1));
      const Rows rows{table.data(), kColumns};
      Products products(left, right);
      products.add(rows, {rows.row(left), kColumns}, kColumns);
      products.add(rows, {rows.row(left), kColumns}, 16);
      const Matrix expected = table.topRows(left) * table.bottomRows(right).transpose() +
                              table.topRows(left).leftCols(16) * table.bottomRows(right).leftCols(16).transpose();
      EXPECT_LT((products.total() - expected).lpNorm<Eigen::Infinity>(), 1e-12) << left << "×" << right;
      if (left <= right) {
        Products among = Products::among(left, right);
        among.add(rows, rows, kColumns);
        const Matrix all = table.topRows(left) * table.topRows(right).transpose();
        EXPECT_LT((among.total() - all).lpNorm<Eigen::Infinity>(), 1e-12) << left << "×" << right;
      }
      Squares squares(left);
      squares.add(rows, kColumns);
      squares.add(rows, 16);
      const Vector of_rows =
          table.topRows(left).rowwise().squaredNorm() + table.topRows(left).leftCols(16).rowwise().squaredNorm();
      EXPECT_LT((squares.total() - of_rows).lpNorm<Eigen::Infinity>(), 1e-12) << left;
      Vector sum(kColumns);
      const Vector weights = Vector::LinSpaced(left, -1.0, 2.0);
      combine(weights, rows, rows.row(left), kColumns, sum.data());
      const Vector plain = table.topRows(left).transpose() * weights + table.row(left).transpose();
      EXPECT_LT((sum - plain).lpNorm<Eigen::Infinity>(), 1e-13);
    }
  }
}

}  // namespace
}  // namespace mbk::dsp
