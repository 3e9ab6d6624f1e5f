#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::identify {

using numeric::RowRange;

/// −F on [ẍ ẋ x−x̄ 1]; positions are relative to their mean, which keeps precision and changes nothing else.
struct Regression {
  Matrix Z;          ///< N×(3n+1)
  Matrix Y;          ///< N×n, −F_h
  Matrix reference;  ///< N×(3n+1), [r̈ ṙ r 1] of the known perturbation, filtered like the motion; empty: not known
  Vector centre;     ///< x̄, n
  Matrix force_sensitivity;  ///< N×(n·p), ∂F_h/∂θ of a force computed from coefficients of a robot; empty otherwise
  Matrix robot_covariance;  ///< p×p, of those coefficients; common to all trials
  std::vector<RowRange> identification, validation;
  double sample_time = 0;

  [[nodiscard]] Index axes() const { return Y.cols(); }
  /// r of the known perturbation, N×n.
  [[nodiscard]] auto perturbation() const { return reference.middleCols(2 * axes(), axes()); }
};

/// The segments of all trials, stacked; unused rows are omitted. A break in time always starts a new range; contiguous
/// segments may be merged with `joined`.
[[nodiscard]] Regression stack(const std::vector<PreparedTrial>& trials);

/// The same without the reference and the sensitivity of the force.
[[nodiscard]] Regression stack_motion_and_force(const std::vector<PreparedTrial>& trials);

/// Subtracts the mean over the rows used from the known perturbation and its derivatives.
void centre_reference(Regression& r, const std::vector<RowRange>& ranges);

/// Moves the columns of a long regression to disk, from where the system reads them on demand (disk_pages.h).
void put_on_disk(Regression& r);
void put_on_disk(Matrix& columns);

/// Both lists in order; contiguous neighbours are merged, because the correlation of the residual does not stop at the
/// split.
[[nodiscard]] std::vector<RowRange> joined(const std::vector<RowRange>& a, const std::vector<RowRange>& b);

/// Every `step`-th row of the ranges, stacked.
[[nodiscard]] Matrix rows_of(const Matrix& all, const std::vector<RowRange>& ranges, Index step = 1);

/// The same in place if every row of one range is requested, otherwise a copy. The source must outlive it.
class SelectedRows {
 public:
  SelectedRows(const Matrix& all, const std::vector<RowRange>& ranges, Index step = 1)
      : copy_(in_place(ranges, step) ? Matrix() : rows_of(all, ranges, step)),
        rows_(in_place(ranges, step) ? numeric::MatrixPart(all.middleRows(ranges[0].begin, ranges[0].size()))
                                     : numeric::MatrixPart(copy_)) {}
  SelectedRows(const SelectedRows&) = delete;
  SelectedRows& operator=(const SelectedRows&) = delete;
  ~SelectedRows() = default;
  [[nodiscard]] const numeric::MatrixPart& operator*() const { return rows_; }
  [[nodiscard]] const numeric::MatrixPart* operator->() const { return &rows_; }

 private:
  static bool in_place(const std::vector<RowRange>& ranges, Index step) { return ranges.size() == 1 && step == 1; }
  Matrix copy_;
  numeric::MatrixPart rows_;
};

/// θ = S φ with θ_j = [row j of M, row j of B, row j of K, c_j] stacked over the outputs j.
[[nodiscard]] Matrix structure_matrix(Structure structure, Index n);

/// The model whose coefficients these are, x₀ = x̄ − K⁻¹c.
/// @param coefficients (3n+1)×n    @param handle_mass [kg], subtracted from the diagonal of M
[[nodiscard]] impedance::Model model_of(const Matrix& coefficients, const Vector& centre, double handle_mass);

/// Covariance of [M B K (row by row) x₀] from that of the free coefficients φ, by the delta method:
///   dx₀ = −K⁻¹ (dc − dK (x̄ − x₀))
[[nodiscard]] Matrix model_covariance(const Matrix& structure, const Matrix& V, const impedance::Model& model,
                                      const Vector& centre);

/// Fit of the coefficients to the force, on held-out data or, without them, in sample.
[[nodiscard]] Fit judge(const Regression& r, const Matrix& coefficients);
/// The same from the residual Y − Z θ of every row.
[[nodiscard]] Fit judge_residuals(const Regression& r, const Matrix& residuals);

}  // namespace mbk::identify
