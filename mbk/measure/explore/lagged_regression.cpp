#include "mbk/measure/explore/lagged_regression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/core/nan.h"
#include "mbk/base/dsp/autoregression.h"
#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::explore {
namespace {

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

/// Fᵀ columns, F = 1/c(q) as a triangular matrix: the autoregression run backward in time in each range, several
/// columns side by side, since each sample waits for those before it.
Matrix coloured_backward(Matrix columns, const Vector& filter, const std::vector<RowRange>& ranges) {
  constexpr Index kLanes = 8;
  const Index order = filter.size() - 1;
  Eigen::Matrix<double, kLanes, Eigen::Dynamic> x;
  for (const RowRange& range : stacked(ranges)) {
    const Index N = range.size();
    for (Index first = 0; first < columns.cols(); first += kLanes) {
      const Index lanes = std::min(kLanes, columns.cols() - first);
      auto part = columns.block(range.begin, first, N, lanes);
      x.setZero(kLanes, N + order);  // nothing comes from beyond the end
      x.topLeftCorner(lanes, N) = part.transpose();
      for (Index t = N - 1; t >= 0; --t) {
        Eigen::Matrix<double, kLanes, 1> sum = x.col(t);
        for (Index lag = 1; lag <= order; ++lag) sum -= filter[lag] * x.col(t + lag);
        x.col(t) = sum;
      }
      part = x.topLeftCorner(lanes, N).transpose();
    }
  }
  return columns;
}

}  // namespace

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
  return principal_directions_of_products(numeric::gram_of({columns}), threshold);
}

Matrix principal_directions_of_products(const Matrix& products, double threshold) {
  const Index p = products.cols();
  if (p == 0) return Matrix(0, 0);
  const auto eigen = numeric::symmetric_eigen(products);  // ascending
  const double largest = eigen.values.tail(1)[0];
  Index rank = 0;
  while (rank < p && eigen.values[p - 1 - rank] > threshold * threshold * largest) ++rank;
  return eigen.vectors.rightCols(rank).rowwise().reverse();
}

std::vector<std::vector<RowRange>> folds_of(const std::vector<RowRange>& ranges, Index folds) {
  const Index N = row_count(ranges);
  std::vector<std::vector<RowRange>> parts(static_cast<std::size_t>(folds));
  for (Index fold = 0; fold < folds; ++fold) {
    Index before = 0;
    for (const RowRange& range : ranges) {  // where the fold's rows, counted through all ranges, lie in this one
      const Index begin = std::max(range.begin, range.begin + fold * N / folds - before);
      const Index end = std::min(range.end, range.begin + (fold + 1) * N / folds - before);
      if (begin < end) parts[static_cast<std::size_t>(fold)].push_back({begin, end});
      before += range.size();
    }
  }
  return parts;
}

Matrix lagged_products(const LaggedSignals& a, const LaggedSignals& b, const std::vector<RowRange>& ranges) {
  Matrix products = Matrix::Zero(a.columns(), b.columns());
  Matrix one(a.lags(), b.lags());
  for (const RowRange& range : ranges) {
    const Index s = range.begin, e = range.end, N = range.size();
    for (Index k = 0; k < a.u.cols(); ++k) {
      for (Index l = 0; l < b.u.cols(); ++l) {
        const auto u = a.u.col(k), v = b.u.col(l);
        for (Index j = 0; j < b.lags(); ++j) {
          one(0, j) = u.segment(s - a.first, N).dot(v.segment(s - b.first - j, N));
        }
        for (Index i = 1; i < a.lags(); ++i) {
          one(i, 0) = u.segment(s - a.first - i, N).dot(v.segment(s - b.first, N));
        }
        for (Index j = 1; j < b.lags(); ++j) {
          const double entering = v[s - b.first - j], leaving = v[e - b.first - j];
          for (Index i = 1; i < a.lags(); ++i) {
            one(i, j) = one(i - 1, j - 1) + u[s - a.first - i] * entering - u[e - a.first - i] * leaving;
          }
        }
        products.block(k * a.lags(), l * b.lags(), a.lags(), b.lags()) += one;
      }
    }
  }
  return products;
}

std::vector<Moments> lagged_moments(const std::vector<LaggedSignals>& signals, const Matrix& Y,
                                    const std::vector<std::vector<RowRange>>& folds) {
  Index p = 0;
  for (const LaggedSignals& one : signals) p += one.columns();
  const Index q = Y.cols();
  std::vector<Moments> moments;
  std::vector<Vector> sums, output_sums;
  Vector mean = Vector::Zero(p), output_mean = Vector::Zero(q);
  Index N = 0;
  for (const auto& ranges : folds) {
    Moments fold{Matrix(p, p), Matrix::Zero(p, q), Vector::Zero(q), row_count(ranges)};
    Vector sum = Vector::Zero(p), output_sum = Vector::Zero(q);
    Index row = 0;
    for (std::size_t a = 0; a < signals.size(); ++a) {
      Index column = row;
      for (std::size_t b = a; b < signals.size(); ++b) {
        const Matrix products = lagged_products(signals[a], signals[b], ranges);
        fold.ZZ.block(row, column, products.rows(), products.cols()) = products;
        fold.ZZ.block(column, row, products.cols(), products.rows()) = products.transpose();
        column += signals[b].columns();
      }
      for (Index k = 0; k < signals[a].columns(); ++k) {
        const Index lag = signals[a].first + k % signals[a].lags();
        for (const RowRange& range : ranges) {
          const auto u = signals[a].u.col(k / signals[a].lags()).segment(range.begin - lag, range.size());
          sum[row + k] += u.sum();
          for (Index j = 0; j < q; ++j) fold.ZY(row + k, j) += u.dot(Y.col(j).segment(range.begin, range.size()));
        }
      }
      row += signals[a].columns();
    }
    for (const RowRange& range : ranges) {
      output_sum += Y.middleRows(range.begin, range.size()).colwise().sum().transpose();
      fold.YY += Y.middleRows(range.begin, range.size()).colwise().squaredNorm().transpose();
    }
    mean += sum;
    output_mean += output_sum;
    N += fold.rows;
    sums.push_back(std::move(sum));
    output_sums.push_back(std::move(output_sum));
    moments.push_back(std::move(fold));
  }
  mean /= static_cast<double>(N);
  output_mean /= static_cast<double>(N);
  for (std::size_t at = 0; at < moments.size(); ++at) {
    Moments& fold = moments[at];
    const auto rows = static_cast<double>(fold.rows);
    const Vector rest = sums[at] - rows * mean;  // of the centred columns
    fold.ZZ -= mean * sums[at].transpose() + rest * mean.transpose();
    fold.ZY -= mean * output_sums[at].transpose() + rest * output_mean.transpose();
    fold.YY -= (2.0 * output_sums[at] - rows * output_mean).cwiseProduct(output_mean);
  }
  return moments;
}

std::vector<Moments> of_columns(const std::vector<Moments>& folds, const std::vector<Index>& columns) {
  std::vector<Moments> kept;
  for (const Moments& one : folds) {
    kept.push_back({one.ZZ(columns, columns), one.ZY(columns, Eigen::all), one.YY, one.rows});
  }
  return kept;
}

std::vector<Moments> in_directions(const std::vector<Moments>& folds, const Matrix& V) {
  std::vector<Moments> turned;
  for (const Moments& one : folds) {
    const Index k = V.rows(), r = V.cols(), rest = one.ZZ.rows() - k;
    Moments now{Matrix(r + rest, r + rest), Matrix(r + rest, one.ZY.cols()), one.YY, one.rows};
    now.ZZ.topLeftCorner(r, r) = V.transpose() * (one.ZZ.topLeftCorner(k, k) * V);
    now.ZZ.topRightCorner(r, rest) = V.transpose() * one.ZZ.topRightCorner(k, rest);
    now.ZZ.bottomLeftCorner(rest, r) = now.ZZ.topRightCorner(r, rest).transpose();
    now.ZZ.bottomRightCorner(rest, rest) = one.ZZ.bottomRightCorner(rest, rest);
    now.ZY << V.transpose() * one.ZY.topRows(k), one.ZY.bottomRows(rest);
    turned.push_back(std::move(now));
  }
  return turned;
}

Matrix cross_validated_errors(const std::vector<Moments>& folds, Index base) {
  const Index p = folds.front().ZZ.rows(), q = folds.front().ZY.cols();
  Matrix gram = Matrix::Zero(p, p), moment = Matrix::Zero(p, q);
  Vector power = Vector::Zero(q);
  Index N = 0;
  for (const Moments& fold : folds) {
    gram += fold.ZZ;
    moment += fold.ZY;
    power += fold.YY;
    N += fold.rows;
  }
  const Vector scale = gram.diagonal().cwiseSqrt().cwiseInverse();
  Matrix errors = Matrix::Zero(std::ssize(folds), p - base + 1);
  constexpr double kRidge = 1e-13;  // of rows that repeat each other, so that the triangle exists
  for (Index at = 0; at < std::ssize(folds); ++at) {
    const Moments& fold = folds[static_cast<std::size_t>(at)];
    Matrix others = scale.asDiagonal() * (gram - fold.ZZ) * scale.asDiagonal();
    others.diagonal().array() += kRidge;
    const Matrix upper = numeric::Cholesky(others).upper();
    const Matrix toward =
        upper.transpose().triangularView<Eigen::Lower>().solve(scale.asDiagonal() * (moment - fold.ZY));
    // c = Σ_{k<r} W_k toward_k with W = U⁻¹ is the fit by the first r columns, so that each column adds to the error
    const Matrix W = upper.triangularView<Eigen::Upper>().solve(Matrix::Identity(p, p));
    const Matrix own = scale.asDiagonal() * fold.ZZ * scale.asDiagonal();
    const Matrix seen = own * W.triangularView<Eigen::Upper>();
    const Matrix own_moment = scale.asDiagonal() * fold.ZY;
    for (Index j = 0; j < q; ++j) {
      const double unit = static_cast<double>(N) / (static_cast<double>(fold.rows * q) * power[j]);
      double error = fold.YY[j];
      Vector c = Vector::Zero(p);
      for (Index r = 0; r <= p; ++r) {
        if (r >= base) errors(at, r - base) += unit * error;
        if (r == p) break;
        const double step = toward(r, j);
        const Index size = r + 1;
        const auto w = W.col(r).head(size), g = seen.col(r).head(size);
        error += step * (step * w.dot(g) + 2.0 * c.head(size).dot(g) - 2.0 * w.dot(own_moment.col(j).head(size)));
        c.head(size) += step * w;
      }
    }
  }
  return errors;
}

Matrix cross_validated_errors(const Matrix& Z, const Matrix& Y, Index base, Index folds) {
  std::vector<Moments> parts;
  for (Index fold = 0; fold < folds; ++fold) {
    const Index begin = fold * Z.rows() / folds, rows = (fold + 1) * Z.rows() / folds - begin;
    const auto part = Z.middleRows(begin, rows);
    const auto output = Y.middleRows(begin, rows);
    parts.push_back({numeric::gram_of({part}), numeric::products_of(part, output),
                     output.colwise().squaredNorm().transpose(), rows});
  }
  return cross_validated_errors(parts, base);
}

LaggedFit fit_lagged(const Matrix& Z, const Matrix& R, const Matrix& Y, const std::vector<RowRange>& ranges) {
  const Index N = Z.rows(), p = Z.cols(), q = Y.cols();
  LaggedFit fit;
  const Vector of_Z = Z.colwise().norm().cwiseInverse(), of_R = R.colwise().norm().cwiseInverse();
  const Matrix moments = of_R.asDiagonal() * numeric::products_of(R, Z) * of_Z.asDiagonal();
  const Matrix A = of_Z.asDiagonal() * numeric::inverse(moments) * of_R.asDiagonal();
  fit.coefficients = A * numeric::products_of(R, Y);
  fit.residual = Y - Z * fit.coefficients;
  for (Index j = 0; j < q; ++j) {
    const Vector noise = autoregression_of(fit.residual.col(j), ranges);
    const Matrix innovations = whitened(fit.residual.col(j), noise, ranges);
    const double left = std::max(1.0, static_cast<double>(N - p - noise.size() + 1));
    const double variance = innovations.squaredNorm() / std::max(1.0, static_cast<double>(innovations.rows())) *
                            static_cast<double>(N) / left;
    const Matrix coloured = coloured_backward(R, noise, ranges);
    fit.covariance.push_back(variance * (A * numeric::gram_of({coloured}) * A.transpose()));
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
  for (const RowRange& range : stacked(ranges)) {
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

Matrix summed_lags(const Matrix& lagged, Index lags, Index wide) {
  const Index signals = lagged.cols() / lags, groups = lags / wide;
  Matrix sums(lagged.rows(), signals * groups);
  for (Index k = 0; k < signals; ++k) {
    for (Index g = 0; g < groups; ++g) {
      sums.col(k * groups + g) = lagged.middleCols(k * lags + g * wide, wide).rowwise().sum();
    }
  }
  return sums;
}

bool predicts_better(const Vector& errors, const Vector& others) {
  const Vector gain = others - errors;
  return gain.mean() > 2.0 * std::sqrt(numeric::variance(gain) / static_cast<double>(gain.size()));
}

std::string chance_text(double p) {
  return p < 1e-12 ? "p < 1e-12" : fmt::format("p = {:.1g}", p);
}

Vector nested_squares(const Matrix& Z, const Vector& y) {
  Matrix all(Z.rows(), Z.cols() + 1);
  const Vector scale = Z.colwise().norm().cwiseInverse();
  all << Z * scale.asDiagonal(), y;
  const Matrix triangle = numeric::householder_triangle(all);
  Vector squares(Z.cols() + 1);
  double left = y.squaredNorm();
  for (Index r = 0; r <= Z.cols(); ++r) {
    squares[r] = left;
    if (r < Z.cols()) left -= triangle(r, Z.cols()) * triangle(r, Z.cols());
  }
  return squares;
}

double chance_of_no_part(const Matrix& Z, Index base, const Matrix& Y, const std::vector<RowRange>& ranges) {
  const LaggedFit fit = fit_lagged(Z, Z, Y, ranges);
  const auto tested = static_cast<double>(Z.cols() - base);
  double least = 1.0;
  for (Index j = 0; j < Y.cols(); ++j) {
    const Vector& noise = fit.noise[static_cast<std::size_t>(j)];
    const Vector squares = nested_squares(whitened(Z, noise, ranges), whitened(Y.col(j), noise, ranges));
    const auto freedom = static_cast<double>(Y.rows() - Z.cols() - noise.size());
    const double with = squares[Z.cols()], without = squares[base];
    least =
        std::min(least, numeric::f_probability_above((without - with) / tested / (with / freedom), tested, freedom));
  }
  return std::min(1.0, least * static_cast<double>(Y.cols()));
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
  const auto under = stacked(ranges);
  const Index lags = std::min<Index>(N - 1, std::llround(kLags / sample_time));
  const Matrix variance = numeric::long_run_covariance(
      1, under, lags, [&](const RowRange& range) { return Matrix(influence.segment(range.begin, range.size())); });
  result.half_width = numeric::kNormal95 * std::sqrt(variance(0, 0)) *
                      numeric::newey_west_widening(static_cast<double>(lags) / static_cast<double>(N));
  return result;
}

}  // namespace mbk::explore
