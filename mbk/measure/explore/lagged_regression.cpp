#include "mbk/measure/explore/lagged_regression.h"

#include <algorithm>
#include <cmath>

#include "mbk/base/core/nan.h"
#include "mbk/base/dsp/autoregression.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::explore {
namespace lagged_detail {

/// The ranges where their rows stand under each other.
std::vector<RowRange> stacked(const std::vector<RowRange>& ranges) {
  std::vector<RowRange> under;
  Index at = 0;
  for (const RowRange& range : ranges) {
    under.push_back({at, at + range.size()});
    at += range.size();
  }
  return under;
}

Vector autoregression_of(const Vector& residual, const std::vector<RowRange>& ranges) {
  constexpr Index kMaxOrder = 25;
  std::vector<Vector> pieces;
  Index shortest = residual.size();
  for (const RowRange& range : stacked(ranges)) {
    const Vector piece = residual.segment(range.begin, range.size());
    pieces.push_back(piece);
    shortest = std::min(shortest, range.size());
  }
  return dsp::autoregression(pieces, std::min(kMaxOrder, shortest / 5));
}

/// Fᵀ columns, F = 1/c(q) as a triangular matrix: the autoregression run backward in time in each range.
Matrix coloured_backward(Matrix columns, const Vector& filter, const std::vector<RowRange>& ranges) {
  const Index order = filter.size() - 1;
  for (const RowRange& range : stacked(ranges)) {
    for (Index k = 0; k < columns.cols(); ++k) {
      double* x = columns.col(k).data();
      for (Index t = range.end - 1; t >= range.begin; --t) {
        double sum = x[t];
        const Index most = std::min(order, range.end - 1 - t);
        for (Index lag = 1; lag <= most; ++lag) sum -= filter[lag] * x[t + lag];
        x[t] = sum;
      }
    }
  }
  return columns;
}

}  // namespace lagged_detail

Index row_count(const std::vector<RowRange>& ranges) {
  Index count = 0;
  for (const RowRange& range : ranges) count += range.size();
  return count;
}

Matrix rows_of(const Matrix& all, const std::vector<RowRange>& ranges) {
  Matrix rows(row_count(ranges), all.cols());
  Index at = 0;
  for (const RowRange& range : ranges) {
    rows.middleRows(at, range.size()) = all.middleRows(range.begin, range.size());
    at += range.size();
  }
  return rows;
}

std::vector<RowRange> rows_inside(const std::vector<RowRange>& ranges, const std::vector<RowRange>& pieces,
                                  Index before, Index after) {
  std::vector<RowRange> inside;
  for (const RowRange& range : ranges) {
    for (const RowRange& piece : pieces) {
      if (range.begin < piece.begin || range.end > piece.end) continue;
      const RowRange kept{std::max(range.begin, piece.begin + before), std::min(range.end, piece.end - after)};
      if (kept.size() > 0) inside.push_back(kept);
      break;
    }
  }
  return inside;
}

Matrix lagged(const Matrix& u, Index first, Index last, const std::vector<RowRange>& ranges) {
  const Index lags = last - first + 1;
  Matrix columns(row_count(ranges), u.cols() * lags);
  for (Index k = 0; k < u.cols(); ++k) {
    for (Index lag = first; lag <= last; ++lag) {
      auto column = columns.col(k * lags + lag - first);
      Index at = 0;
      for (const RowRange& range : ranges) {
        column.segment(at, range.size()) = u.col(k).segment(range.begin - lag, range.size());
        at += range.size();
      }
    }
  }
  return columns;
}

Matrix centred(const Matrix& columns) {
  return columns.rowwise() - columns.colwise().mean().eval();
}

Matrix principal_directions(const Matrix& columns, double threshold) {
  if (columns.cols() == 0) return Matrix(0, 0);
  const auto eigen = numeric::symmetric_eigen(columns.transpose() * columns);  // ascending
  const double largest = eigen.values.tail(1)[0];
  Index rank = 0;
  while (rank < columns.cols() && eigen.values[columns.cols() - 1 - rank] > threshold * threshold * largest) {
    ++rank;
  }
  return eigen.vectors.rightCols(rank).rowwise().reverse();
}

Matrix cross_validated_errors(const Matrix& Z, const Matrix& Y, Index base, Index folds) {
  const Index N = Z.rows(), p = Z.cols(), q = Y.cols();
  const Vector scale = Z.colwise().norm().cwiseInverse();
  std::vector<Matrix> grams, moments;
  Matrix gram = Matrix::Zero(p, p), moment = Matrix::Zero(p, q);
  Vector power = Vector::Zero(q);
  Matrix powers(folds, q);
  for (Index fold = 0; fold < folds; ++fold) {
    const Index begin = fold * N / folds, rows = (fold + 1) * N / folds - begin;
    const Matrix part = Z.middleRows(begin, rows) * scale.asDiagonal();
    Matrix own = Matrix::Zero(p, p);
    own.selfadjointView<Eigen::Lower>().rankUpdate(part.transpose());
    own.triangularView<Eigen::StrictlyUpper>() = own.transpose();
    grams.push_back(std::move(own));
    moments.push_back(part.transpose() * Y.middleRows(begin, rows));
    gram += grams.back();
    moment += moments.back();
    powers.row(fold) = Y.middleRows(begin, rows).colwise().squaredNorm();
    power += powers.row(fold).transpose();
  }
  Matrix errors = Matrix::Zero(folds, p - base + 1);
  constexpr double kRidge = 1e-13;  // of rows that repeat each other, so that the triangle exists
  for (Index fold = 0; fold < folds; ++fold) {
    const auto at = static_cast<std::size_t>(fold);
    Matrix others = gram - grams[at];
    others.diagonal().array() += kRidge;
    const Matrix upper = numeric::Cholesky(others).upper();
    const Matrix toward = upper.transpose().triangularView<Eigen::Lower>().solve(moment - moments[at]);
    const auto rows = static_cast<double>((fold + 1) * N / folds - fold * N / folds);
    for (Index r = base; r <= p; ++r) {
      double error = 0.0;
      if (r == 0) {
        for (Index j = 0; j < q; ++j) error += powers(fold, j) / power[j];
      } else {
        const Matrix c = upper.topLeftCorner(r, r).triangularView<Eigen::Upper>().solve(toward.topRows(r));
        const Matrix predicted = grams[at].topLeftCorner(r, r) * c - 2.0 * moments[at].topRows(r);
        for (Index j = 0; j < q; ++j) error += (powers(fold, j) + c.col(j).dot(predicted.col(j))) / power[j];
      }
      errors(fold, r - base) = error * static_cast<double>(N) / (rows * static_cast<double>(q));
    }
  }
  return errors;
}

LaggedFit fit_lagged(const Matrix& Z, const Matrix& R, const Matrix& Y, const std::vector<RowRange>& ranges) {
  const Index N = Z.rows(), p = Z.cols(), q = Y.cols();
  LaggedFit fit;
  const Vector of_Z = Z.colwise().norm().cwiseInverse(), of_R = R.colwise().norm().cwiseInverse();
  const Matrix moments = of_R.asDiagonal() * (R.transpose() * Z) * of_Z.asDiagonal();
  const Matrix A = of_Z.asDiagonal() * numeric::inverse(moments) * of_R.asDiagonal();
  fit.coefficients = A * (R.transpose() * Y);
  fit.residual = Y - Z * fit.coefficients;
  for (Index j = 0; j < q; ++j) {
    const Vector noise = lagged_detail::autoregression_of(fit.residual.col(j), ranges);
    const Matrix innovations = whitened(fit.residual.col(j), noise, ranges);
    const double left = std::max(1.0, static_cast<double>(N - p - noise.size() + 1));
    const double variance = innovations.squaredNorm() / std::max(1.0, static_cast<double>(innovations.rows())) *
                            static_cast<double>(N) / left;
    const Matrix coloured = lagged_detail::coloured_backward(R, noise, ranges);
    const Matrix half = coloured * A.transpose();
    fit.covariance.push_back(variance * (half.transpose() * half));
    fit.noise.push_back(noise);
  }
  return fit;
}

Matrix whitened(const Matrix& columns, const Vector& filter, const std::vector<RowRange>& ranges) {
  const Index order = filter.size() - 1;
  Index count = 0;
  for (const RowRange& range : ranges) count += std::max<Index>(0, range.size() - order);
  Matrix result(count, columns.cols());
  Index row = 0;
  for (const RowRange& range : lagged_detail::stacked(ranges)) {
    const Index size = range.size() - order;
    if (size <= 0) continue;
    auto block = result.middleRows(row, size);
    block = columns.middleRows(range.begin + order, size);
    for (Index lag = 1; lag <= order; ++lag) {
      block += filter[lag] * columns.middleRows(range.begin + order - lag, size);
    }
    row += size;
  }
  return result;
}

AccountedFor accounted_for(const Vector& y, const Vector& e, const std::vector<RowRange>& ranges, double sample_time) {
  AccountedFor result;
  const Index N = y.size();
  const Vector signal = y.array() - y.mean(), error = e.array() - e.mean();
  const double power = signal.squaredNorm(), ratio = error.squaredNorm() / power;
  if (N < 2 || !(power > 0.0)) return {kNaN, kNaN, kNaN};
  result.percent = 100.0 * (1.0 - ratio);
  result.rmse = numeric::root_mean_square(error);
  const Vector influence = -100.0 * (error.array().square() - ratio * signal.array().square()) / power;
  constexpr double kLags = 0.5;  // [s]
  const auto under = lagged_detail::stacked(ranges);
  const Index lags = std::min<Index>(N - 1, std::llround(kLags / sample_time));
  const Matrix variance = numeric::long_run_covariance(
      1, under, lags, [&](const RowRange& range) { return Matrix(influence.segment(range.begin, range.size())); });
  result.half_width = numeric::kNormal95 * std::sqrt(variance(0, 0)) *
                      numeric::newey_west_widening(static_cast<double>(lags) / static_cast<double>(N));
  return result;
}

}  // namespace mbk::explore
