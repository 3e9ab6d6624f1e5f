#include "mbk/base/numeric/block_bootstrap.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::numeric {
namespace {

/// Solves every sample in the same units, in which regressors and instruments have unit length over the data.
class Solver {
 public:
  Solver(const Moments& data, const Matrix& Z, const Matrix& R, const std::vector<RowRange>& ranges, const Matrix& S)
      : p_(data.regressors.rows()), q_(data.outputs.cols()), S_(S) {
    Vector z = Vector::Zero(p_), r = Vector::Zero(p_);
    for (const RowRange& range : ranges) {
      z += Z.middleRows(range.begin, range.size()).colwise().squaredNorm().transpose();
      r += R.middleRows(range.begin, range.size()).colwise().squaredNorm().transpose();
    }
    left_ = unit_of(r.cwiseSqrt());
    right_ = unit_of(z.cwiseSqrt());
  }

  /// Nothing where the terms cannot be distinguished.
  [[nodiscard]] std::optional<Vector> solve(const Moments& moments) const {
    constexpr double kApart = 1e-13;
    Matrix A, b;
    if (S_.size() == 0) {
      A = moments.regressors;
      b = moments.outputs;
    } else {
      const Index k = S_.cols();
      A.setZero(k, k);
      b.setZero(k, 1);
      for (Index j = 0; j < q_; ++j) {
        const auto part = S_.middleRows(j * p_, p_);
        A.noalias() += part.transpose() * (moments.regressors * part);
        b.noalias() += part.transpose() * moments.outputs.col(j);
      }
    }
    A = left_.asDiagonal() * A * right_.asDiagonal();
    const Lu lu(A);
    if (!(lu.reciprocal_condition() > kApart)) return std::nullopt;
    const Matrix solution = right_.asDiagonal() * lu.solve(left_.asDiagonal() * b);
    return Vector(solution.reshaped());
  }

 private:
  [[nodiscard]] Vector unit_of(const Vector& lengths) const {
    Vector size = lengths;
    if (S_.size() > 0) size = (lengths.replicate(q_, 1).asDiagonal() * S_).colwise().norm();
    return (size.array() > 0.0).select(size.cwiseInverse(), 1.0);
  }

  Index p_, q_;
  const Matrix& S_;
  Vector left_, right_;
};

/// @param sorted at least one    @param share 0…1
double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - std::floor(place));
}

/// Empty where a value is not a number.
std::vector<double> sorted(const Vector& values) {
  if (!values.allFinite()) return {};
  std::vector<double> result(values.begin(), values.end());
  std::ranges::sort(result);
  return result;
}

constexpr std::pair kNoInterval = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};

}  // namespace

Result<BlockResampler> BlockResampler::make(const Matrix& Z, const Matrix& R, const Matrix& Y,
                                            const std::vector<RowRange>& ranges, Index block_rows) {
  const Index n = Z.rows(), p = Z.cols(), q = Y.cols();
  if (R.rows() != n || R.cols() != p || Y.rows() != n || p == 0 || q == 0) {
    return bad_data(
        fmt::format("regression shapes differ: Z is {}×{}, R {}×{}, Y {}×{}", n, p, R.rows(), R.cols(), Y.rows(), q));
  }
  if (block_rows < 1) return bad_usage(fmt::format("a block of {} rows is too short", block_rows));
  BlockResampler result;
  result.p_ = p;
  result.q_ = q;
  result.block_rows_ = block_rows;
  result.sums_.setZero(p * (p + q), n + 1);
  Index row = 0;
  double blocks = 0.0;
  const auto skip_to = [&](Index end) {
    for (; row < end; ++row) result.sums_.col(row + 1) = result.sums_.col(row);
  };
  for (const RowRange& range : ranges) {
    if (range.begin < row || range.end > n || range.size() < 0) {
      return bad_data(fmt::format("rows {} to {} are out of order, or not among the {} rows of the regression",
                                  range.begin, range.end, n));
    }
    if (range.size() == 0) continue;
    skip_to(range.begin);
    for (; row < range.end; ++row) {
      const double* before = result.sums_.col(row).data();
      double* after = result.sums_.col(row + 1).data();
      for (Index j = 0; j < p + q; ++j) {
        const double factor = j < p ? Z(row, j) : Y(row, j - p);
        for (Index i = 0; i < p; ++i) after[j * p + i] = before[j * p + i] + factor * R(row, i);
      }
      if (!result.sums_.col(row + 1).allFinite()) {
        return bad_data(fmt::format("a value is not finite in row {} of the regression", row));
      }
    }
    blocks += static_cast<double>(range.size()) / static_cast<double>(std::min(range.size(), block_rows));
    result.ranges_.push_back(range);
    result.weights_.push_back(blocks);
    result.rows_ += range.size();
  }
  skip_to(n);
  if (blocks < 2.0) {
    return bad_data(fmt::format("{} rows contain fewer than two blocks of {}", result.rows_, block_rows),
                    "record longer, or choose shorter blocks");
  }
  return result;
}

std::vector<RowRange> BlockResampler::draw(std::uint64_t seed, std::uint32_t number) const {
  Random random(seed, number);
  std::vector<RowRange> drawn;
  for (Index missing = rows_; missing > 0;) {
    const auto place = std::ranges::upper_bound(weights_, random.uniform() * blocks());
    const RowRange& range = ranges_[static_cast<std::size_t>(
        std::min<std::ptrdiff_t>(place - weights_.begin(), static_cast<std::ptrdiff_t>(ranges_.size()) - 1))];
    if (range.size() <= block_rows_) {  // a whole one; the last where that comes nearer to the rows of the data
      if (2 * missing < range.size()) break;
      drawn.push_back(range);
      missing -= range.size();
      continue;
    }
    const Index begin =
        range.begin + static_cast<Index>(random.below(static_cast<std::uint64_t>(range.size() - block_rows_ + 1)));
    const Index size = std::min(block_rows_, missing);
    drawn.push_back({begin, begin + size});
    missing -= size;
  }
  return drawn;
}

Moments BlockResampler::moments(const std::vector<RowRange>& rows) const {
  Vector sum = Vector::Zero(p_ * (p_ + q_));
  for (const RowRange& range : rows) sum += sums_.col(range.end) - sums_.col(range.begin);
  return {sum.head(p_ * p_).reshaped(p_, p_), sum.tail(p_ * q_).reshaped(p_, q_)};
}

Result<BlockBootstrap> block_bootstrap(const Matrix& Z, const Matrix& R, const Matrix& Y, const Matrix& S,
                                       const std::vector<RowRange>& ranges, const BlockBootstrapOptions& options) {
  if (options.replicates < 1) return bad_usage(fmt::format("{} replicates are too few", options.replicates));
  if (S.size() > 0 && S.rows() != Z.cols() * Y.cols()) {
    return bad_usage(
        fmt::format("a structure with {} rows does not fit {} coefficients", S.rows(), Z.cols() * Y.cols()));
  }
  const auto resampler = MBK_TRY(BlockResampler::make(Z, R, Y, ranges, options.block_rows));
  const Moments data = resampler.moments(resampler.ranges());
  const Solver solver(data, Z, R, resampler.ranges(), S);
  auto estimate = solver.solve(data);
  if (!estimate) return fail(ErrorKind::not_usable, "the terms of the regression cannot be distinguished");
  BlockBootstrap result{std::move(*estimate), {}, resampler.blocks()};
  result.coefficients.resize(result.estimate.size(), options.replicates);
  constexpr int kTogether = 64;  // replicates to a turn of a thread
  const auto work = [&](int turn) -> Result<void> {
    for (int i = turn * kTogether; i < std::min((turn + 1) * kTogether, options.replicates); ++i) {
      const auto solution =
          solver.solve(resampler.moments(resampler.draw(options.seed, static_cast<std::uint32_t>(i))));
      if (!solution) {
        return fail(ErrorKind::not_usable, fmt::format("in bootstrap sample {} the terms cannot be distinguished", i),
                    "record longer, or choose shorter blocks");
      }
      result.coefficients.col(i) = *solution;
    }
    return {};
  };
  MBK_TRY(parallel_for((options.replicates - 1) / kTogether + 1, options.threads, work));
  return result;
}

std::pair<double, double> bias_corrected_interval(double estimate, const Vector& replicates, double confidence) {
  const std::vector<double> values = sorted(replicates);
  if (values.empty() || !std::isfinite(estimate)) return kNoInterval;
  // What equals the estimate counts half: replicates of whole numbers would otherwise seem biased.
  const auto [first, last] = std::ranges::equal_range(values, estimate);
  const double below = static_cast<double>(first - values.begin()) + 0.5 * static_cast<double>(last - first);
  const double z0 = normal_quantile(below / static_cast<double>(values.size()));
  const double z = normal_quantile(0.5 * (1.0 + confidence));
  return {quantile(values, normal_probability(2.0 * z0 - z)), quantile(values, normal_probability(2.0 * z0 + z))};
}

}  // namespace mbk::numeric
