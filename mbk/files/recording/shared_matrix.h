#pragma once

#include <memory>
#include <new>
#include <utility>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::recording {

/// A matrix in memory of its own, or where its numbers stand already: in the bytes of a file, which it keeps alive. A
/// copy has memory of its own.
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
  SharedMatrix(const SharedMatrix& other) : SharedMatrix(Matrix(other)) {}
  SharedMatrix(SharedMatrix&& other) noexcept
      : Map(other.data(), other.rows(), other.cols()), own_(std::move(other.own_)), keeper_(std::move(other.keeper_)) {
    other.stand_at(nullptr, 0, 0);
  }
  SharedMatrix& operator=(SharedMatrix other) noexcept {
    stand_at(other.data(), other.rows(), other.cols());
    own_ = std::move(other.own_);
    keeper_ = std::move(other.keeper_);
    return *this;
  }
  ~SharedMatrix() = default;

  /// Memory of its own, not set to anything.
  void resize(Index rows, Index columns) { *this = SharedMatrix(Matrix(rows, columns)); }
  /// Memory of its own, in which what is there stays.
  void conservativeResize(Index rows, Index columns) {
    if (!own_) *this = SharedMatrix(Matrix(*this));
    own_->conservativeResize(rows, columns);
    stand_at(own_->data(), rows, columns);
  }

 private:
  void stand_at(double* at, Index rows, Index columns) { new (static_cast<Map*>(this)) Map(at, rows, columns); }

  std::unique_ptr<Matrix> own_;
  std::shared_ptr<void> keeper_;  ///< of numbers that stand elsewhere
};

}  // namespace mbk::recording
