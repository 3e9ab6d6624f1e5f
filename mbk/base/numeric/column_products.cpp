#include "mbk/base/numeric/column_products.h"

#include <algorithm>
#include <vector>

#include "mbk/base/core/vector4.h"

namespace mbk::numeric {
namespace {

constexpr Index kBlock = 256;  // rows that stay in the first cache while all pairs of columns are taken
constexpr Index kTile = 3;     // a tile of 3×3 dot products fills 16 registers, and none waits for another

/// The sum of all lanes, by halves.
template <class Lanes>
[[gnu::always_inline]] inline double added_up(const typename Lanes::V& lanes) {
  Vector4 four_left;
  if constexpr (Lanes::kWidth == Eight::kWidth) {
    four_left = __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3) + __builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
  } else {
    four_left = lanes;
  }
  return (four_left[0] + four_left[2]) + (four_left[1] + four_left[3]);
}

/// aᵢᵀ bⱼ of `Left`×`Right` columns over `rows` rows, added to `to` + i + stride·j. Of a triangle, whose `b` is `a`,
/// those on and above the diagonal.
template <class Lanes, Index Left, Index Right, bool Triangle = false>
[[gnu::always_inline]] inline void dot_tile(const double* const* a, const double* const* b, Index rows, double* to,
                                            Index stride) {
  const auto requested = [](Index i, Index j) { return !Triangle || i <= j; };
  typename Lanes::V sum[Right][Left] = {};  // in registers, for loops of known length over them are unrolled
  Index t = 0;
  for (; t + Lanes::kWidth <= rows; t += Lanes::kWidth) {
    typename Lanes::V left[Left];
    for (Index i = 0; i < Left; ++i) {
      left[i] = Lanes::at(a[i] + t);
      keep_in_register<Lanes>(left[i]);
    }
    for (Index j = 0; j < Right; ++j) {
      typename Lanes::V right;
      if constexpr (Triangle) {
        right = left[j];
      } else {
        right = Lanes::at(b[j] + t);
        keep_in_register<Lanes>(right);
      }
      for (Index i = 0; i < Left; ++i) {
        if (requested(i, j)) sum[j][i] += left[i] * right;
      }
    }
  }
  for (Index j = 0; j < Right; ++j) {
    for (Index i = 0; i < Left; ++i) {
      if (!requested(i, j)) continue;
      double rest = added_up<Lanes>(sum[j][i]);
      for (Index r = t; r < rows; ++r) rest += a[i][r] * b[j][r];
      to[i + stride * j] += rest;
    }
  }
}

/// Where each column begins.
std::vector<const double*> columns_of(const std::vector<MatrixPart>& side_by_side) {
  std::vector<const double*> columns;
  for (const MatrixPart& part : side_by_side) {
    for (Index j = 0; j < part.cols(); ++j) columns.push_back(part.data() + j * part.outerStride());
  }
  return columns;
}

/// Columns in whole tiles: the last one is repeated.
class Tiled {
 public:
  explicit Tiled(const MatrixPart& part) : columns_(columns_of({part})) {
    while (!columns_.empty() && columns_.size() % kTile != 0) columns_.push_back(columns_.back());
  }
  [[nodiscard]] const double* const* data() const { return columns_.data(); }
  [[nodiscard]] Index padded() const { return static_cast<Index>(columns_.size()); }

 private:
  std::vector<const double*> columns_;
};

/// left×right products, `left` of them from one column of `to` to the next; both in whole tiles.
struct Task {
  const double* const* left;
  Index left_count;
  const double* const* right;
  Index right_count;
  Index rows;
};

/// The pointers to `Count` columns from a row on.
template <Index Count>
[[gnu::always_inline]] inline void point(const double* (&at)[Count], const double* const* columns, Index row) {
  for (Index k = 0; k < Count; ++k) at[k] = columns[k] + row;
}

template <class Lanes>
[[gnu::always_inline]] inline void products_body(const Task& task, double* to) {
  const double *a[kTile], *b[kTile];
  for (Index begin = 0; begin < task.rows; begin += kBlock) {
    const Index size = std::min(task.rows - begin, kBlock);
    for (Index j = 0; j < task.right_count; j += kTile) {
      point(b, task.right + j, begin);
      for (Index i = 0; i < task.left_count; i += kTile) {
        point(a, task.left + i, begin);
        dot_tile<Lanes, kTile, kTile>(a, b, size, to + i + task.left_count * j, task.left_count);
      }
    }
  }
}
void products_any(const Task& task, double* to) {
  products_body<Four>(task, to);
}
MBK_X86_64_V3 void products_v3(const Task& task, double* to) {
  products_body<Four>(task, to);
}
MBK_X86_64_V4 void products_v4(const Task& task, double* to) {
  products_body<Eight>(task, to);
}

void run_products(const Task& task, double* to) {
  const auto run = has_x86_64_v4() ? products_v4 : has_x86_64_v3() ? products_v3 : products_any;
  run(task, to);
}

/// Columns, and what they have with each other: `count` products from one column to the next.
struct Gram {
  const double* const* columns;
  Index count;
  Index rows;
  double* to;
};

/// Eight at a time have 32 registers. A tile of 4×4 multiplies as often as it reads where what it reads lies across two
/// lines of the cache, as columns of any length do.
template <class Lanes>
constexpr Index kGramTile = Lanes::kWidth == Eight::kWidth ? 4 : kTile;

/// Columns j … j + `Right` − 1 with those before them, whole tiles, and with each other.
template <class Lanes, Index Right>
[[gnu::always_inline]] inline void gram_tiles(const Gram& task, Index j, Index begin, Index size) {
  constexpr Index kLeft = kGramTile<Lanes>;
  const double *a[kLeft], *b[Right];
  point(b, task.columns + j, begin);
  double* to = task.to + task.count * j;
  for (Index i = 0; i < j; i += kLeft) {
    point(a, task.columns + i, begin);
    dot_tile<Lanes, kLeft, Right>(a, b, size, to + i, task.count);
  }
  dot_tile<Lanes, Right, Right, true>(b, b, size, to + j, task.count);
}

/// The last tile is as wide as what is left, and no column is left alone behind others.
template <class Lanes>
[[gnu::always_inline]] inline void gram_body(const Gram& task) {
  constexpr Index kWide = kGramTile<Lanes>;
  for (Index begin = 0; begin < task.rows; begin += kBlock) {
    const Index size = std::min(task.rows - begin, kBlock);
    for (Index j = 0; j < task.count;) {
      const Index left = task.count - j;
      if (left == kWide + 1) {
        gram_tiles<Lanes, kWide + 1>(task, j, begin, size);
        break;
      }
      if (left >= kWide) {
        gram_tiles<Lanes, kWide>(task, j, begin, size);
      } else if (left == kWide - 1) {
        gram_tiles<Lanes, kWide - 1>(task, j, begin, size);
      } else if (left == 2) {
        gram_tiles<Lanes, 2>(task, j, begin, size);
      } else {
        gram_tiles<Lanes, 1>(task, j, begin, size);
      }
      j += kWide;
    }
  }
}
void gram_any(const Gram& task) {
  gram_body<Four>(task);
}
MBK_X86_64_V3 void gram_v3(const Gram& task) {
  gram_body<Four>(task);
}
MBK_X86_64_V4 void gram_v4(const Gram& task) {
  gram_body<Eight>(task);
}

/// Products of all pairs of columns, added to those on and above the diagonal.
void add_products(const std::vector<MatrixPart>& side_by_side, Matrix& sums) {
  const auto columns = columns_of(side_by_side);
  const Index rows = side_by_side.empty() ? 0 : side_by_side.front().rows();
  const auto run = has_x86_64_v4() ? gram_v4 : has_x86_64_v3() ? gram_v3 : gram_any;
  run({columns.data(), std::ssize(columns), rows, sums.data()});
}

/// The symmetric matrix whose upper triangle is there.
Matrix mirrored(const Matrix& sums) {
  return sums.selfadjointView<Eigen::Upper>();
}

/// Outputs y, regressors z, coefficients θ (count×outputs), and where the residuals of each output go.
struct Residuals {
  const double* const* y;
  Index outputs;
  const double* const* z;
  Index count;
  const double* theta;
  double* const* to;
};

constexpr Index kOutputs = 3;  // go together, so that what is read of z serves them all

/// y − Σ θ_k z_k of `Outputs` outputs from the first on, `Together` lanes of rows at a time, as long as there are such.
template <class Lanes, Index Outputs, Index Together>
[[gnu::always_inline]] inline Index residual_rows(const Residuals& task, Index first, Index t, Index end) {
  constexpr Index kRows = Together * Lanes::kWidth;
  for (; t + kRows <= end; t += kRows) {
    typename Lanes::V rest[Outputs][Together];
    for (Index j = 0; j < Outputs; ++j) {
      for (Index i = 0; i < Together; ++i) rest[j][i] = Lanes::at(task.y[first + j] + t + i * Lanes::kWidth);
    }
    for (Index k = 0; k < task.count; ++k) {
      typename Lanes::V z[Together];
      for (Index i = 0; i < Together; ++i) z[i] = Lanes::at(task.z[k] + t + i * Lanes::kWidth);
      for (Index j = 0; j < Outputs; ++j) {
        const double theta = task.theta[k + task.count * (first + j)];
        for (Index i = 0; i < Together; ++i) rest[j][i] -= theta * z[i];
      }
    }
    for (Index j = 0; j < Outputs; ++j) {
      for (Index i = 0; i < Together; ++i) Lanes::at(task.to[first + j] + t + i * Lanes::kWidth) = rest[j][i];
    }
  }
  return t;
}

template <class Lanes, Index Outputs>
[[gnu::always_inline]] inline void residual_columns(const Residuals& task, Index first, Index begin, Index end) {
  Index t = residual_rows<Lanes, Outputs, 2>(task, first, begin, end);
  t = residual_rows<Lanes, Outputs, 1>(task, first, t, end);
  for (; t < end; ++t) {
    for (Index j = first; j < first + Outputs; ++j) {
      double rest = task.y[j][t];
      for (Index k = 0; k < task.count; ++k) rest -= task.theta[k + task.count * j] * task.z[k][t];
      task.to[j][t] = rest;
    }
  }
}

/// In blocks, so that z is read from memory once.
template <class Lanes>
[[gnu::always_inline]] inline void residual_body(const Residuals& task, Index rows) {
  for (Index begin = 0; begin < rows; begin += kBlock) {
    const Index end = std::min(begin + kBlock, rows);
    Index j = 0;
    for (; j + kOutputs <= task.outputs; j += kOutputs) residual_columns<Lanes, kOutputs>(task, j, begin, end);
    if (task.outputs - j == 2) residual_columns<Lanes, 2>(task, j, begin, end);
    if (task.outputs - j == 1) residual_columns<Lanes, 1>(task, j, begin, end);
  }
}
void residual_any(const Residuals& task, Index rows) {
  residual_body<Four>(task, rows);
}
MBK_X86_64_V3 void residual_v3(const Residuals& task, Index rows) {
  residual_body<Four>(task, rows);
}
MBK_X86_64_V4 void residual_v4(const Residuals& task, Index rows) {
  residual_body<Eight>(task, rows);
}

/// The pointers to columns that lie `stride` apart.
template <class Number>
std::vector<Number*> columns_at(Number* first, Index count, Index stride) {
  std::vector<Number*> columns;
  for (Index j = 0; j < count; ++j) columns.push_back(first + j * stride);
  return columns;
}

/// Y − Z θ, into the columns of `to`.
void take_residuals(std::vector<const double*> z, const MatrixPart& Y, const Matrix& theta, Index begin,
                    Eigen::Ref<Matrix> to) {
  for (const double*& column : z) column += begin;
  const auto y = columns_at(Y.data() + begin, Y.cols(), Y.outerStride());
  const auto into = columns_at(to.data(), to.cols(), to.outerStride());
  const auto run = has_x86_64_v4() ? residual_v4 : has_x86_64_v3() ? residual_v3 : residual_any;
  run({y.data(), Y.cols(), z.data(), std::ssize(z), theta.data(), into.data()}, to.rows());
}

}  // namespace

Matrix gram_of(const std::vector<MatrixPart>& side_by_side) {
  Index columns = 0;
  for (const MatrixPart& part : side_by_side) columns += part.cols();
  Matrix sums = Matrix::Zero(columns, columns);
  add_products(side_by_side, sums);
  return mirrored(sums);
}

GramSum::GramSum(Index columns) : sums_(Matrix::Zero(columns, columns)) {}

void GramSum::add(const MatrixPart& block) {
  add_products({block}, sums_);
}

Matrix GramSum::gram() const {
  return mirrored(sums_);
}

Matrix products_of(const MatrixPart& A, const MatrixPart& B) {
  const Tiled left(A), right(B);
  Matrix all = Matrix::Zero(left.padded(), right.padded());
  run_products({left.data(), left.padded(), right.data(), right.padded(), A.rows()}, all.data());
  return all.topLeftCorner(A.cols(), B.cols());
}

Matrix projected_residuals(const MatrixPart& Z, const MatrixPart& Y, const Matrix& theta) {
  const auto regressors = columns_of({Z});
  constexpr Index kRows = 8 * kBlock;  // that stay in the second cache
  Matrix projected = Matrix::Zero(Z.cols(), Y.cols()), block(std::min(kRows, Z.rows()), Y.cols());
  for (Index begin = 0; begin < Z.rows(); begin += kRows) {
    const Index rows = std::min(kRows, Z.rows() - begin);
    take_residuals(regressors, Y, theta, begin, block.topRows(rows));
    projected += products_of(Z.middleRows(begin, rows), block.topRows(rows));
  }
  return projected;
}

Matrix residuals_of(const std::vector<MatrixPart>& Z, const MatrixPart& Y, const Matrix& theta) {
  Matrix left(Y.rows(), Y.cols());
  take_residuals(columns_of(Z), Y, theta, 0, left);
  return left;
}

Vector lagged_products(const Eigen::Ref<const Vector>& e, Index first, Index count) {
  constexpr Index kLags = kTile * kTile;  // of a tile: left is shifted by 0, 1, 2 samples, right by 2, 5, 8 more
  const Index last = first + count - 1, tiles = (count + kLags - 1) / kLags;
  // So many products are there at every shift, those of the lags that fill the last tile included.
  const Index whole = std::max<Index>(0, e.size() - (first + tiles * kLags - 1) - (kTile - 1));
  const double* left[kTile];
  std::vector<const double*> right;
  for (Index i = 0; i < kTile; ++i) left[i] = e.data() + (whole > 0 ? i : 0);
  for (Index j = 0; j < tiles * kTile; ++j) right.push_back(e.data() + (whole > 0 ? first + kTile * j + kTile - 1 : 0));
  Matrix sums = Matrix::Zero(kTile, tiles * kTile);  // (i, j): of lag first + 3j + 2 − i, from sample i on
  run_products({left, kTile, right.data(), tiles * kTile, whole}, sums.data());
  Vector all(count);
  for (Index lag = first; lag <= last; ++lag) {
    const Index j = (lag - first) / kTile, i = kTile - 1 - (lag - first) % kTile;
    const Index pairs = e.size() - lag, before = std::min(i, pairs), end = std::min(i + whole, pairs);
    all[lag - first] = sums(i, j) + e.head(before).dot(e.segment(lag, before)) +
                       e.segment(end, pairs - end).dot(e.segment(end + lag, pairs - end));
  }
  return all;
}

}  // namespace mbk::numeric
