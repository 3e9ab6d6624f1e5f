#include "mbk/base/numeric/long_run_covariances.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace mbk::numeric {
namespace long_run_covariances_test {

constexpr double kTolerance = 1e-12;

/// Σ_l (1 − |l|/(L + 1)) Σ_t s_t s_{t+l}ᵀ as it is written.
Matrix by_lags(const Matrix& scores, const std::vector<RowRange>& ranges, Index lags) {
  Matrix omega = Matrix::Zero(scores.cols(), scores.cols());
  for (const RowRange& range : ranges) {
    const auto s = scores.middleRows(range.begin, range.size());
    for (Index lag = -std::min(lags, range.size() - 1); lag <= std::min(lags, range.size() - 1); ++lag) {
      const Index pairs = range.size() - std::abs(lag), first = std::max<Index>(0, -lag);
      omega += (1.0 - static_cast<double>(std::abs(lag)) / static_cast<double>(lags + 1)) *
               (s.middleRows(first, pairs).transpose() * s.middleRows(first + lag, pairs));
    }
  }
  return omega;
}

/// Two kinds of two scores each, from three factors.
struct Factors {
  Matrix columns;
  [[nodiscard]] ScoreProducts from(Index row) const {
    const auto column = [&](Index k) { return columns.col(k).data() + row; };
    return {{column(0), column(1), column(0), column(2)}, {column(2), column(2), column(1), column(1)}};
  }
  [[nodiscard]] Matrix scores(Index kind) const {
    const auto a = columns.col(0).array(), b = columns.col(1).array(), c = columns.col(2).array();
    Matrix both(columns.rows(), 2);
    if (kind == 0) both << (a * c).matrix(), (b * c).matrix();
    if (kind == 1) both << (a * b).matrix(), (c * b).matrix();
    return both;
  }
};

TEST(LongRunCovariances, AreThoseOfTheSumOverLags) {
  const Factors factors{Matrix::Random(2600, 3)};
  for (const std::vector<RowRange>& ranges :
       {std::vector<RowRange>{{0, 2600}}, std::vector<RowRange>{{3, 4}, {4, 261}, {300, 1324}, {1330, 2600}}}) {
    for (const Index lags : {0, 1, 7, 255, 300, 1500}) {
      const auto omegas =
          long_run_covariances(2, 2, ranges, lags, [&](const RowRange& rows) { return factors.from(rows.begin); });
      ASSERT_EQ(omegas.size(), 2U);
      for (const Index kind : {0, 1}) {
        const Matrix scores = factors.scores(kind), want = by_lags(scores, ranges, lags);
        const double size = kTolerance * scores.squaredNorm() * static_cast<double>(lags + 1);
        EXPECT_LE((omegas[static_cast<std::size_t>(kind)] - want).cwiseAbs().maxCoeff(), size) << lags << " lags";
        const Matrix alone = long_run_covariance(
            2, ranges, lags, [&](const RowRange& rows) { return Matrix(scores.middleRows(rows.begin, rows.size())); });
        EXPECT_LE((alone - want).cwiseAbs().maxCoeff(), size) << lags << " lags";
      }
    }
  }
}

TEST(LongRunCovariances, OfNoKindAreNone) {
  const auto nothing = [](const RowRange&) { return ScoreProducts{}; };
  EXPECT_TRUE(long_run_covariances(0, 2, {{0, 100}}, 5, nothing).empty());
}

TEST(LongRunCovariances, AskForEachScoreOnceAndInOrder) {
  const std::vector<RowRange> ranges = {{0, 5000}, {5001, 5100}};
  for (const Index lags : {0, 40, 3000}) {
    Index next = 0;
    (void)long_run_covariance(1, ranges, lags, [&](const RowRange& rows) {
      EXPECT_EQ(rows.begin, next == 5000 ? 5001 : next);
      next = rows.end;
      return Matrix(Matrix::Ones(rows.size(), 1));
    });
    EXPECT_EQ(next, 5100);
  }
}

}  // namespace long_run_covariances_test
}  // namespace mbk::numeric
