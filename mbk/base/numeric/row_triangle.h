#pragma once

#include "mbk/base/core/linear_algebra.h"

namespace mbk::numeric {

/// R of the QR decomposition of all rows that were added, by Householder's reflections of a few hundred rows at a time.
/// The inner loops are compiled for several processors; which runs is decided where the program runs.
class RowTriangle {
 public:
  explicit RowTriangle(Index columns) : R_(Matrix::Zero(columns, columns)) {}

  /// @param rows  any number of them, as many columns as above
  void add(const Eigen::Ref<const Matrix>& rows);

  /// Upper triangle with RᵀR = Σ rowᵀrow. The signs of its rows are as they come.
  [[nodiscard]] const Matrix& R() const { return R_; }

 private:
  Matrix R_;
};

}  // namespace mbk::numeric
