#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk {

/// A view of columns of numbers that are stored elsewhere: signals, one row per sample. The storage must outlive it.
class Columns {
 public:
  using Column = Eigen::Map<const Vector>;

  Columns() = default;
  /// Those of a matrix, or one vector.
  template <class Derived>
  Columns(const Eigen::PlainObjectBase<Derived>& matrix)
      : rows_(matrix.rows()) {  // NOLINT(google-explicit-constructor)
    static_assert(!Derived::IsRowMajor || Derived::ColsAtCompileTime == 1, "columns are contiguous");
    for (Index k = 0; k < matrix.cols(); ++k) data_.push_back(matrix.derived().data() + k * rows_);
  }

  /// One more, of as many rows.
  void add(const Vector& column) {
    rows_ = column.size();
    data_.push_back(column.data());
  }

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index cols() const { return static_cast<Index>(data_.size()); }
  [[nodiscard]] Index size() const { return rows() * cols(); }
  [[nodiscard]] Column col(Index k) const { return {data_[static_cast<std::size_t>(k)], rows_}; }
  [[nodiscard]] double operator()(Index i, Index k) const { return data_[static_cast<std::size_t>(k)][i]; }
  /// Rows [first, first + count) of them all, where they stand.
  [[nodiscard]] Columns part(Index first, Index count) const {
    Columns part = *this;
    part.rows_ = count;
    for (const double*& column : part.data_) column += first;
    return part;
  }
  /// The same as a copy.
  [[nodiscard]] Matrix middle_rows(Index first, Index count) const {
    Matrix copy(count, cols());
    for (Index k = 0; k < cols(); ++k) copy.col(k) = col(k).segment(first, count);
    return copy;
  }

 private:
  std::vector<const double*> data_;
  Index rows_ = 0;
};

}  // namespace mbk
