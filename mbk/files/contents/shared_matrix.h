#pragma once

#include <memory>
#include <new>
#include <utility>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::recording {

/// A matrix with its own memory, or a view of numbers in the bytes of a file, which it keeps alive. A copy has its own
/// memory.
class SharedMatrix : public Eigen::Map<Matrix> {
  using Map = Eigen::Map<Matrix>;

 public:
  SharedMatrix() : Map(nullptr, 0, 0) {}
  SharedMatrix(Matrix values)  // NOLINT(google-explicit-constructor): as a matrix is a matrix
      : Map(nullptr, 0, 0), own_(std::make_unique<Matrix>(std::move(values))) {
    stand_at(own_->data(), own_->rows(), own_->cols());
  }
  /// @param at rows·columns numbers, column by column    @param keeper whatever owns them
  SharedMatrix(double* at, Index rows, Index columns, std::shared_ptr<void> keeper)
      : Map(at, rows, columns), keeper_(std::move(keeper)) {}
  /// One column, which can be taken out again.
  static SharedMatrix of_column(Vector values) {
    SharedMatrix matrix;
    matrix.column_ = std::make_unique<Vector>(std::move(values));
    matrix.stand_at(matrix.column_->data(), matrix.column_->size(), 1);
    return matrix;
  }
  SharedMatrix(const SharedMatrix& other) : SharedMatrix(Matrix(other)) {}
  SharedMatrix(SharedMatrix&& other) noexcept
      : Map(other.data(), other.rows(), other.cols()),
        own_(std::move(other.own_)),
        column_(std::move(other.column_)),
        keeper_(std::move(other.keeper_)) {
    other.stand_at(nullptr, 0, 0);
  }
  SharedMatrix& operator=(SharedMatrix other) noexcept {
    stand_at(other.data(), other.rows(), other.cols());
    own_ = std::move(other.own_);
    column_ = std::move(other.column_);
    keeper_ = std::move(other.keeper_);
    return *this;
  }
  ~SharedMatrix() = default;

  /// The numbers of a column or row, without a copy where they were given as a column. Nothing is left here.
  [[nodiscard]] Vector take() {
    Vector values = column_ ? std::move(*column_) : Vector(reshaped());
    *this = SharedMatrix();
    return values;
  }

  /// Memory of its own, not set to anything.
  void resize(Index rows, Index columns) { *this = SharedMatrix(Matrix(rows, columns)); }
  /// Memory of its own, in which what is there stays.
  void conservativeResize(Index rows, Index columns) {  // NOLINT(readability-identifier-naming): as Eigen calls it
    if (!own_) *this = SharedMatrix(Matrix(*this));
    own_->conservativeResize(rows, columns);
    stand_at(own_->data(), rows, columns);
  }

 private:
  void stand_at(double* at, Index rows, Index columns) { new (static_cast<Map*>(this)) Map(at, rows, columns); }

  std::unique_ptr<Matrix> own_;
  std::unique_ptr<Vector> column_;  ///< in place of `own_`
  std::shared_ptr<void> keeper_;    ///< of numbers that stand elsewhere
};

}  // namespace mbk::recording
