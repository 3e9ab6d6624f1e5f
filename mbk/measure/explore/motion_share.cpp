#include "mbk/measure/explore/motion_share.h"

#include <algorithm>
#include <cmath>

#include "mbk/base/numeric/dense.h"
#include "mbk/model/trial/plateau_stiffness.h"

namespace mbk::explore {
namespace {

constexpr double kEndSlope = 0.02;  // [s] over which the velocity at an end of the window is taken

/// Slope of the straight line through the rows [u/s].
Vector slope_of(const Matrix& values, double sample_time) {
  const Index n = values.rows();
  Vector sum = Vector::Zero(values.cols());
  double squares = 0.0;
  for (Index i = 0; i < n; ++i) {
    const double t = (static_cast<double>(i) - 0.5 * static_cast<double>(n - 1)) * sample_time;
    sum += t * values.row(i).transpose();
    squares += t * t;
  }
  return sum / squares;
}

}  // namespace

void MotionShare::add(const Matrix& place, double sample_time, const Vector& commanded) {
  const Index axes = commanded.size();
  if (squares_.size() == 0) squares_ = velocity_ = acceleration_ = Matrix::Zero(axes, axes);
  const Index rows = place.rows();
  const Index part = std::min(static_cast<Index>(std::llround(kEndSlope / sample_time)), rows / 2);
  if (part < 1) return;
  const Matrix first = place.topRows(part), last = place.bottomRows(part);
  const double apart = static_cast<double>(rows - part) * sample_time;
  squares_ += commanded * commanded.transpose();
  velocity_ += (last.colwise().mean() - first.colwise().mean()).transpose() / apart * commanded.transpose();
  if (part < 2) return;
  acceleration_ += (slope_of(last, sample_time) - slope_of(first, sample_time)) / apart * commanded.transpose();
}

double MotionShare::value() const {
  if (squares_.size() == 0) return 0.0;
  const Matrix inverse = numeric::inverse(squares_);
  return PlateauStiffness::kDampingOverStiffness * numeric::singular_values(velocity_ * inverse)[0] +
         PlateauStiffness::kInertiaOverStiffness * numeric::singular_values(acceleration_ * inverse)[0];
}

}  // namespace mbk::explore
