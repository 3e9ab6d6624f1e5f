#include "mbk/base/numeric/least_squares.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <initializer_list>
#include <limits>
#include <vector>

#include "mbk/base/core/vector4.h"
#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

namespace {

// ---- dot products of columns ----

constexpr Index kBlock = 256;  // rows that stay in the first cache while all pairs of columns are taken
constexpr Index kTile = 3;     // a tile of 3×3 dot products fills the registers, and none waits for another

/// aᵢᵀ bⱼ of a tile over `rows` rows, added to `to` + i + stride·j.
template <class Lanes>
[[gnu::always_inline]] inline void dot_tile(const double* const* a, const double* const* b, Index rows, double* to,
                                            Index stride) {
  typename Lanes::V sum[kTile][kTile] = {};
  Index t = 0;
  for (; t + Lanes::kWidth <= rows; t += Lanes::kWidth) {
    typename Lanes::V left[kTile];
    for (Index i = 0; i < kTile; ++i) left[i] = Lanes::at(a[i] + t);
    for (Index j = 0; j < kTile; ++j) {
      const typename Lanes::V right = Lanes::at(b[j] + t);
      for (Index i = 0; i < kTile; ++i) sum[j][i] += left[i] * right;
    }
  }
  for (Index j = 0; j < kTile; ++j) {
    for (Index i = 0; i < kTile; ++i) {
      double rest = 0.0;
      for (Index k = 0; k < Lanes::kWidth; ++k) rest += sum[j][i][k];
      for (Index r = t; r < rows; ++r) rest += a[i][r] * b[j][r];
      to[i + stride * j] += rest;
    }
  }
}

/// Columns of equal length, in whole tiles: the last one is repeated.
std::vector<const double*> in_tiles(std::initializer_list<const Matrix*> matrices) {
  std::vector<const double*> columns;
  for (const Matrix* matrix : matrices) {
    for (Index j = 0; j < matrix->cols(); ++j) columns.push_back(matrix->col(j).data());
  }
  while (static_cast<Index>(columns.size()) % kTile != 0) columns.push_back(columns.back());
  return columns;
}

template <class Lanes>
[[gnu::always_inline]] inline void gram_body(const double* const* columns, Index count, Index rows, double* gram) {
  const double *a[kTile], *b[kTile];
  for (Index begin = 0; begin < rows; begin += kBlock) {
    const Index size = std::min(rows - begin, kBlock);
    for (Index j = 0; j < count; j += kTile) {
      for (Index k = 0; k < kTile; ++k) b[k] = columns[j + k] + begin;
      for (Index i = 0; i <= j; i += kTile) {
        for (Index k = 0; k < kTile; ++k) a[k] = columns[i + k] + begin;
        dot_tile<Lanes>(a, b, size, gram + i + count * j, count);
      }
    }
  }
}
void gram_any(const double* const* columns, Index count, Index rows, double* gram) {
  gram_body<Four>(columns, count, rows, gram);
}
MBK_X86_64_V3 void gram_v3(const double* const* columns, Index count, Index rows, double* gram) {
  gram_body<Four>(columns, count, rows, gram);
}
MBK_X86_64_V4 void gram_v4(const double* const* columns, Index count, Index rows, double* gram) {
  gram_body<Eight>(columns, count, rows, gram);
}

/// [Z Y]ᵀ[Z Y].
Matrix gram_matrix(const Matrix& Z, const Matrix& Y) {
  const std::vector<const double*> columns = in_tiles({&Z, &Y});
  const auto padded = static_cast<Index>(columns.size()), count = Z.cols() + Y.cols();
  Matrix gram = Matrix::Zero(padded, padded);
  const auto add_up = has_x86_64_v4() ? gram_v4 : has_x86_64_v3() ? gram_v3 : gram_any;
  add_up(columns.data(), padded, Z.rows(), gram.data());
  return Matrix(gram.topLeftCorner(count, count)).selfadjointView<Eigen::Upper>();
}

/// Where the residuals of a block of rows lie while their products with the regressors are taken.
struct Residuals {
  const double* const* regressors;  ///< in whole tiles
  const double* const* outputs;
  const double* coefficients;  ///< p×q
  Index p, q, rows;
};

template <class Lanes>
[[gnu::always_inline]] inline void project_body(const Residuals& of, double* block, double* products, Index stride) {
  const double *a[kTile], *b[kTile];
  for (Index begin = 0; begin < of.rows; begin += kBlock) {
    const Index size = std::min(of.rows - begin, kBlock);
    for (Index j = 0; j < of.q; ++j) {
      const double *y = of.outputs[j] + begin, *c = of.coefficients + j * of.p;
      double* residual = block + kBlock * j;
      Index t = 0;
      for (; t + Lanes::kWidth <= size; t += Lanes::kWidth) {
        typename Lanes::V rest = Lanes::at(y + t);
        for (Index k = 0; k < of.p; ++k) rest -= c[k] * Lanes::at(of.regressors[k] + begin + t);
        Lanes::at(residual + t) = rest;
      }
      for (; t < size; ++t) {
        double rest = y[t];
        for (Index k = 0; k < of.p; ++k) rest -= c[k] * of.regressors[k][begin + t];
        residual[t] = rest;
      }
    }
    for (Index j = 0; j < of.q; j += kTile) {
      for (Index k = 0; k < kTile; ++k) b[k] = block + kBlock * std::min(j + k, of.q - 1);
      for (Index i = 0; i < of.p; i += kTile) {
        for (Index k = 0; k < kTile; ++k) a[k] = of.regressors[i + k] + begin;
        dot_tile<Lanes>(a, b, size, products + i + stride * j, stride);
      }
    }
  }
}
void project_any(const Residuals& of, double* block, double* products, Index stride) {
  project_body<Four>(of, block, products, stride);
}
MBK_X86_64_V3 void project_v3(const Residuals& of, double* block, double* products, Index stride) {
  project_body<Four>(of, block, products, stride);
}
MBK_X86_64_V4 void project_v4(const Residuals& of, double* block, double* products, Index stride) {
  project_body<Eight>(of, block, products, stride);
}

/// Zᵀ(Y − Z θ), p×q, in one pass and without the residuals in memory.
Matrix projected_residuals(const Matrix& Z, const Matrix& Y, const Matrix& theta) {
  const std::vector<const double*> regressors = in_tiles({&Z}), outputs = in_tiles({&Y});
  const auto height = static_cast<Index>(regressors.size()), width = static_cast<Index>(outputs.size());
  Matrix products = Matrix::Zero(height, width);
  std::vector<double> block(static_cast<std::size_t>(kBlock * Y.cols()));
  const auto project = has_x86_64_v4() ? project_v4 : has_x86_64_v3() ? project_v3 : project_any;
  project({regressors.data(), outputs.data(), theta.data(), Z.cols(), Y.cols(), Z.rows()}, block.data(),
          products.data(), height);
  return products.topLeftCorner(Z.cols(), Y.cols());
}

/// What a QR decomposition of Z Λ⁻¹ leaves of the problem: R, p×p, and Qᵀ Y, p×q.
struct Triangle {
  Matrix R, Qty;
};

Triangle reduce_by_householder(const Matrix& Z, const Matrix& Y, const Vector& length) {
  const Index p = Z.cols(), q = Y.cols();
  Matrix work(Z.rows(), p + q);
  work << Z * length.cwiseInverse().asDiagonal(), Y;
  const Matrix reduced = householder_triangle(std::move(work));
  return {reduced.topLeftCorner(p, p), reduced.topRightCorner(p, q)};
}

/// By the Cholesky factor of the scaled ZᵀZ, with one step of refinement from the residuals (corrected seminormal
/// equations, Björck 1987): as exact as Householder's while the condition is moderate, in a third of the time.
Triangle reduce(const Matrix& Z, const Matrix& Y, const Matrix& gram, const Vector& length) {
  constexpr double kModerate = 1e-6;  // squared reciprocal of a condition of 1000
  const Index p = Z.cols(), q = Y.cols();
  const Vector inverse = length.cwiseInverse();
  const Matrix G = inverse.asDiagonal() * gram.topLeftCorner(p, p) * inverse.asDiagonal();
  const Vector eigenvalues = symmetric_eigenvalues(G);
  if (!(eigenvalues[0] > kModerate * eigenvalues[p - 1])) return reduce_by_householder(Z, Y, length);
  const Cholesky cholesky(G);
  Matrix scaled = cholesky.solve(inverse.asDiagonal() * gram.topRightCorner(p, q));
  scaled += cholesky.solve(inverse.asDiagonal() * projected_residuals(Z, Y, inverse.asDiagonal() * scaled));
  const Matrix R = cholesky.upper();
  return {R, R * scaled};
}

}  // namespace

Result<LinearFit> fit_least_squares(const Matrix& Z, const Matrix& Y, const Matrix& S) {
  const Index n = Z.rows(), p = Z.cols(), q = Y.cols();
  if (Y.rows() != n || (S.size() > 0 && S.rows() != p * q)) {
    return bad_data(
        fmt::format("regression shapes differ: Z is {}×{}, Y {}×{}, S {}×{}", n, p, Y.rows(), q, S.rows(), S.cols()));
  }
  if (n < p) return bad_data(fmt::format("{} samples cannot determine {} parameters per axis", n, p), "record longer");
  const auto gram = gram_matrix(Z, Y);
  if (!gram.allFinite()) {
    for (Index row = 0; row < n; ++row) {
      if (Z.row(row).allFinite() && Y.row(row).allFinite()) continue;
      return bad_data(fmt::format("a value is not finite in row {} of the regression", row));
    }
    return bad_data("the values of the regression are too large to be squared", "use SI units");
  }
  Vector length = gram.diagonal().head(p).cwiseSqrt();
  length = (length.array() > 0.0).select(length, 1.0);
  const Triangle triangle = reduce(Z, Y, gram, length);
  const auto& [R, Qty] = triangle;

  LinearFit fit;
  const Vector singular = singular_values(R);
  const double smallest_counted = static_cast<double>(p) * std::numeric_limits<double>::epsilon() * singular[0];
  fit.rank = static_cast<int>((singular.array() > smallest_counted).count());
  fit.condition = fit.rank < p ? std::numeric_limits<double>::infinity() : singular[0] / singular[p - 1];

  fit.structure = S.size() > 0 ? S : Matrix::Identity(p * q, p * q);
  // (I ⊗ R Λ) S φ = vec(Qᵀ Y), with Λ the column lengths.
  const Matrix RL = R * length.asDiagonal();
  Matrix small(p * q, fit.structure.cols());
  for (Index j = 0; j < q; ++j) small.middleRows(j * p, p) = RL * fit.structure.middleRows(j * p, p);
  Vector scale = small.colwise().norm();
  scale = (scale.array() > 0.0).select(scale, 1.0);
  small *= scale.cwiseInverse().asDiagonal();
  const CompleteOrthogonal solver(small);
  fit.free = scale.cwiseInverse().asDiagonal() * solver.solve(Qty.reshaped());
  const Vector theta = fit.structure * fit.free;
  fit.coefficients = theta.reshaped(p, q);
  const Matrix inverse = scale.cwiseInverse().asDiagonal() * solver.pseudo_inverse();
  fit.inverse_gram = inverse * inverse.transpose();
  return fit;
}

Matrix long_run_covariance(Index k, const std::vector<RowRange>& ranges, Index lags,
                           const std::function<Matrix(const RowRange&)>& scores_of) {
  Matrix omega = Matrix::Zero(k, k);
  constexpr Index kBlock = 512;  // window sums are collected in blocks and added to Ω by one matrix product
  Matrix block(k, kBlock);
  for (const RowRange& range : ranges) {
    const Index n = range.size();
    const Matrix scores = scores_of(range);
    Vector sum = Vector::Zero(k);
    Index filled = 0;
    for (Index t = 0; t < n + lags; ++t) {  // the window [t − lags, t], clipped to the range
      if (t < n) sum += scores.col(t);
      if (t - lags - 1 >= 0) sum -= scores.col(t - lags - 1);
      block.col(filled++) = sum;
      if (filled == kBlock || t + 1 == n + lags) {
        omega.selfadjointView<Eigen::Lower>().rankUpdate(block.leftCols(filled));
        filled = 0;
      }
    }
  }
  omega /= static_cast<double>(lags + 1);
  return omega.selfadjointView<Eigen::Lower>();
}

Matrix regression_scores(const Matrix& R, const Matrix& residuals, const Matrix& structure, const RowRange& range) {
  const Index p = R.cols(), q = residuals.cols(), n = range.size();
  Matrix full(p * q, n);
  for (Index j = 0; j < q; ++j) {
    full.middleRows(j * p, p) =
        (R.middleRows(range.begin, n).array().colwise() * residuals.col(j).segment(range.begin, n).array())
            .matrix()
            .transpose();
  }
  const bool tied = structure.rows() != structure.cols() || !structure.isIdentity(0.0);
  return tied ? Matrix(structure.transpose() * full) : full;
}

Matrix newey_west_covariance(const LinearFit& fit, const Matrix& Z, const Matrix& residuals,
                             const std::vector<RowRange>& ranges, Index lags) {
  const Matrix omega = long_run_covariance(fit.free.size(), ranges, lags, [&](const RowRange& range) {
    return regression_scores(Z, residuals, fit.structure, range);
  });
  return fit.inverse_gram * omega * fit.inverse_gram;
}

double newey_west_widening(double b) {
  const double within = std::clamp(b, 0.0, 1.0);
  return 1.0 + within * (2.9694 + within * (0.4160 - within * 0.5324)) / 1.9600;
}

double fitted_widening(double independent, double coefficients) {
  return std::sqrt(1.0 / (1.0 - std::clamp(coefficients / independent, 0.0, 0.5)));
}

}  // namespace mbk::numeric
