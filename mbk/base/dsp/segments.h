#pragma once

#include <array>
#include <memory>
#include <vector>

#include "mbk/base/dsp/derivative_filter.h"

/// @file
/// A recursive filter over a long record waits for its own last result. Cut into segments of equal length that run
/// side by side it does not, once the state at the beginning of each is known; and that is linear algebra:
///   x(begin of the next) = Φᵐ x(begin) + what the input of m samples adds from rest.
/// The inner loops are compiled for several processors; which runs is decided where the program runs.
namespace mbk::dsp {

inline constexpr Index kSegments = 16;

/// One sample of each segment.
struct alignas(64) SampleBlock {
  std::array<double, kSegments> values;
};

/// Columns of a table whose rows are signals: row r begins at data + r·stride. Columns come in multiples of 16, of
/// which each 16 are `step` apart.
struct Rows {
  double* data;
  Index stride;
  Index step = kSegments;
  [[nodiscard]] double* row(Index r) const { return data + r * stride; }
  [[nodiscard]] Rows from_row(Index r) const { return {row(r), stride, step}; }
};

inline constexpr Index kStride = 8;

/// Signals of N samples as segments: value l of row i is sample l·m + i, m = ⌈N/16⌉, and 0 after the last.
class Segments {
 public:
  Segments() = default;
  /// @param signals  of equal length    @param overlap  rows beyond the m + 1 that lead to the next segment
  explicit Segments(const std::vector<const Vector*>& signals, Index overlap = 0);
  [[nodiscard]] Index length() const { return length_; }  ///< m
  /// Row i of one of the signals; the following ones come after it.
  [[nodiscard]] const double* row(Index signal, Index i) const { return at(signal, i); }
  /// How many strides there are as far as all segments have samples, of `samples` in the record.
  [[nodiscard]] Index strides(Index samples) const;
  /// Every eighth sample by itself, from a stride on: column 16·k + l of row j is sample 8·(stride + k) + j of segment
  /// l.
  [[nodiscard]] Rows strided(Index signal, Index stride) const;

 private:
  [[nodiscard]] double* at(Index signal, Index i) const {
    return rows_[static_cast<std::size_t>(signal * count_ + i)].values.data();
  }

  Index length_ = 0, count_ = 0;  // count: of rows
  std::unique_ptr<SampleBlock[]> rows_;
};

/// States at the beginning of each segment, at rest before the first sample: as many rows as there are states.
/// @param input  which of the signals
[[nodiscard]] Matrix states_at_starts(const HeldStep& system, const Segments& signals, Index input);

/// The same of the free motion from `state` at the first sample, for segments of `length` samples.
[[nodiscard]] Matrix free_at_starts(const Matrix& transition, const Vector& state, Index length);

/// Two filters one behind the other: the second one's input is weightsᵀx + through·u of the first.
/// States are those of the first, then of the second, of which there are as many.
[[nodiscard]] HeldStep cascaded(const HeldStep& first, const HeldStep& second, const Vector& weights, double through);

/// The filter over all segments at once.
class SegmentFilter {
 public:
  /// @param starts  states at the first sample of each segment, n×16
  SegmentFilter(const HeldStep& filter, const Matrix& starts);

  /// The next samples of every segment; the first are those of the start itself.
  /// @param input  rows of 16, the next `count` of them    @param states  n rows, 16·count columns
  void run(const double* input, Index count, Rows states);

 private:
  std::vector<double> coefficients_;  // each row of Φ, then its Γ₀ and Γ₁
  std::vector<SampleBlock> state_;    // and the last input
  Index n_;
  bool begun_ = false;
};

/// The states of a filter over all segments at once, at every eighth sample only.
class StridedFilter {
 public:
  /// @param starts  states at the first sample of each segment, n×16
  StridedFilter(const HeldStep& filter, const Matrix& starts);
  /// Without an input.
  StridedFilter(const Matrix& transition, const Matrix& starts);

  /// @param input  rows of 16, the next 8·count + 1 of them; not needed without one
  /// @param states  n rows, 16·(count + 1) columns: where it stands, and after each stride; it then stands at the last
  void run(const double* input, Index count, Rows states);
  [[nodiscard]] Matrix state() const;  ///< where it stands, n×16

 private:
  std::vector<double> coefficients_;  // [Φ⁸, what each of 9 samples adds], row by row
  std::vector<SampleBlock> state_;
  Index n_, inputs_;
};

/// to = plus + Σ_k weights_k · from(k), column by column.   @param columns a multiple of 16
void combine(const Vector& weights, Rows from, const double* plus, Index columns, double* to);

/// What is yet to be added up.
struct alignas(64) PartialSums {
  std::array<double, 8> values{};
};

/// Sums of products of rows, added up block by block.
class Products {
 public:
  Products(Index left, Index right) : left_(left), right_(right), sums_(static_cast<std::size_t>(left * right)) {}
  /// Those on the left are the first of those on the right, so that their products among themselves are there twice.
  [[nodiscard]] static Products among(Index left, Index right) {
    Products products(left, right);
    products.symmetric_ = true;
    return products;
  }
  /// @param left, right  their first rows    @param columns a multiple of 16
  void add(Rows left, Rows right, Index columns);
  [[nodiscard]] Matrix total() const;  ///< left×right

 private:
  Index left_, right_;
  bool symmetric_ = false;
  std::vector<PartialSums> sums_;
};

/// Sums of squares of rows, added up block by block: the diagonal of their products.
class Squares {
 public:
  explicit Squares(Index rows) : sums_(static_cast<std::size_t>(rows)) {}
  /// @param columns a multiple of 16
  void add(Rows rows, Index columns);
  [[nodiscard]] Vector total() const;

 private:
  std::vector<PartialSums> sums_;
};

}  // namespace mbk::dsp
