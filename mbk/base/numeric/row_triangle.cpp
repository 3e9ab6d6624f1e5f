#include "mbk/base/numeric/row_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "mbk/base/core/vector4.h"

namespace mbk::numeric {
namespace {

struct alignas(64) Lines {
  std::array<double, 16> values;
};
constexpr Index kLines = 16;       // rows come in multiples
constexpr Index kColumnBlock = 4;  // columns that are taken with one reading of the reflection

/// Dot products with `Count` columns, and what a multiple of v adds to them.
template <class Lanes, int Count>
[[gnu::always_inline]] inline void dots(const double* v, const double* columns, Index rows, double* to) {
  typename Lanes::V sum[Count] = {};
  for (Index i = 0; i < rows; i += Lanes::kWidth) {
    const typename Lanes::V a = Lanes::at(v + i);
    for (int j = 0; j < Count; ++j) sum[j] += a * Lanes::at(columns + j * rows + i);
  }
  for (int j = 0; j < Count; ++j) {
    to[j] = 0.0;
    for (Index lane = 0; lane < Lanes::kWidth; ++lane) to[j] += sum[j][lane];
  }
}
template <class Lanes, int Count>
[[gnu::always_inline]] inline void add_multiples(const double* v, const double* times, Index rows, double* columns) {
  for (Index i = 0; i < rows; i += Lanes::kWidth) {
    const typename Lanes::V a = Lanes::at(v + i);
    for (int j = 0; j < Count; ++j) Lanes::at(columns + j * rows + i) += times[j] * a;
  }
}

/// Reflects `Count` columns and their elements in a row of R, `size` apart, by I + (v₀; v)(v₀; v)ᵀ·scale.
template <class Lanes, int Count>
[[gnu::always_inline]] inline void reflect(double v0, const double* v, double scale, Index rows, double* columns,
                                           double* R, Index size) {
  double times[Count];
  dots<Lanes, Count>(v, columns, rows, times);
  for (int j = 0; j < Count; ++j) {
    times[j] = (times[j] + v0 * R[j * size]) * scale;
    R[j * size] += times[j] * v0;
  }
  add_multiples<Lanes, Count>(v, times, rows, columns);
}

/// @param block  column after column, of which nothing is left    @param R size×size, column after column
template <class Lanes>
[[gnu::always_inline]] inline void add_block(double* block, Index rows, double* R, Index size) {
  for (Index k = 0; k < size; ++k) {
    const double* const v = block + k * rows;
    double squares;
    dots<Lanes, 1>(v, v, rows, &squares);
    if (squares < std::numeric_limits<double>::min()) continue;
    double& diagonal = R[k + size * k];
    const double length = std::sqrt(diagonal * diagonal + squares), reflected = diagonal > 0.0 ? -length : length;
    const double v0 = diagonal - reflected, scale = 1.0 / (reflected * v0);
    diagonal = reflected;
    Index j = k + 1;
    for (; j + kColumnBlock <= size; j += kColumnBlock) {
      reflect<Lanes, kColumnBlock>(v0, v, scale, rows, block + j * rows, R + k + size * j, size);
    }
    for (; j < size; ++j) reflect<Lanes, 1>(v0, v, scale, rows, block + j * rows, R + k + size * j, size);
  }
}
void add_block_any(double* block, Index rows, double* R, Index size) {
  add_block<Four>(block, rows, R, size);
}
MBK_X86_64_V3 void add_block_v3(double* block, Index rows, double* R, Index size) {
  add_block<Four>(block, rows, R, size);
}
MBK_X86_64_V4 void add_block_v4(double* block, Index rows, double* R, Index size) {
  add_block<Eight>(block, rows, R, size);
}

}  // namespace

void RowTriangle::add(const Eigen::Ref<const Matrix>& rows) {
  constexpr Index kInCache = 2048;  // numbers of a block
  const Index size = R_.cols();
  if (size == 0) return;
  const auto run = has_x86_64_v4() ? add_block_v4 : has_x86_64_v3() ? add_block_v3 : add_block_any;
  const Index together = std::max(kInCache / size, 2 * size) / kLines * kLines + kLines;
  std::vector<Lines> lines(static_cast<std::size_t>(together / kLines * size));
  Eigen::Map<Matrix> block(lines.front().values.data(), together, size);
  for (Index begin = 0; begin < rows.rows(); begin += together) {
    const Index count = std::min(together, rows.rows() - begin);
    block.topRows(count) = rows.middleRows(begin, count);
    block.bottomRows(together - count).setZero();
    run(block.data(), together, R_.data(), size);
  }
}

}  // namespace mbk::numeric
