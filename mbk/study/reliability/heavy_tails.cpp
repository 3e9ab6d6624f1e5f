#include "mbk/study/reliability/heavy_tails.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::reliability {
namespace {

Matrix two_way_residuals(const Matrix& scores) {
  Matrix residuals = scores.array() - scores.mean();
  const Vector of_rows = residuals.rowwise().mean();
  const Eigen::RowVectorXd of_columns = residuals.colwise().mean();
  residuals.colwise() -= of_rows;
  residuals.rowwise() -= of_columns;
  return residuals;
}

double kurtosis_of(const Matrix& residuals) {
  const auto squares = residuals.array().square().eval();
  const double sum = squares.sum();
  return sum > 0.0 ? static_cast<double>(residuals.size()) * squares.square().sum() / (sum * sum) : 0.0;
}

/// Kurtoses of normal tables of one size, sorted.
Vector drawn_kurtoses(Index rows, Index columns) {
  constexpr Index kNumbers = 2'000'000, kMinDraws = 500, kMaxDraws = 8'000;
  const Index draws = std::clamp(kNumbers / (rows * columns), kMinDraws, kMaxDraws);
  numeric::Random random(1, static_cast<std::uint32_t>(1000 * columns + rows));
  Matrix scores(rows, columns);
  Vector drawn(draws);
  for (double& one : drawn) {
    for (double& x : scores.reshaped()) x = random.normal();
    one = kurtosis_of(two_way_residuals(scores));
  }
  std::sort(drawn.begin(), drawn.end());
  return drawn;
}

double chance_of(double kurtosis, Index rows, Index columns) {
  constexpr Index kMaxDrawn = 20'000;
  if (rows * columns > kMaxDrawn) {
    const double spread = std::sqrt(24.0 / (static_cast<double>(rows) * static_cast<double>(columns - 1)));
    return 1.0 - numeric::normal_probability((kurtosis - 3.0) / spread);
  }
  // Outcomes of a study share their sizes, and each size costs as much as two million random numbers.
  static std::mutex mutex;
  static std::map<std::pair<Index, Index>, Vector> known;
  const std::scoped_lock lock(mutex);
  const auto [at, fresh] = known.try_emplace({rows, columns});
  if (fresh) at->second = drawn_kurtoses(rows, columns);
  const Vector& drawn = at->second;
  const auto above = drawn.end() - std::lower_bound(drawn.begin(), drawn.end(), kurtosis);
  return static_cast<double>(above + 1) / static_cast<double>(drawn.size() + 1);
}

}  // namespace

TailTest tail_test(const Matrix& scores) {
  TailTest test;
  if (scores.rows() < kMinPeople || scores.cols() < 2) return test;
  const Matrix residuals = two_way_residuals(scores);
  const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * scores.cwiseAbs().maxCoeff();
  if (!(residuals.cwiseAbs().maxCoeff(&test.row, &test.column) > rounding)) return test;
  test.kurtosis = kurtosis_of(residuals);
  test.p = chance_of(test.kurtosis, scores.rows(), scores.cols());
  return test;
}

Interval widened_for_tails(double estimate, const Interval& normal) {
  if (!(estimate > 0.0)) return normal;
  const double power = std::sqrt((kTailKurtosis - 1.0) / 2.0);
  const auto end = [&](double of_normal) { return estimate * std::pow(of_normal / estimate, power); };
  return {end(normal.first), end(normal.second)};
}

}  // namespace mbk::reliability
