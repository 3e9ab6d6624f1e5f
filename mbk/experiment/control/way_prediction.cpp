#include "mbk/experiment/control/way_prediction.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace mbk::control {

void WayPrediction::learn(const Past& past, const Future& future) noexcept {
  A_.noalias() += past * past.transpose();
  C_.noalias() += past * future.reshaped<Eigen::ColMajor>().transpose();
  ++learned_;
}

WayPrediction::Way WayPrediction::predict(const Past& past, const Vector2d& before) const noexcept {
  Eigen::Matrix<double, kFeatures, kFeatures> A = A_;
  for (int i = 1; i < kFeatures; ++i) A(i, i) += learned_ * kSigma * kSigma;
  const Past w = A.ldlt().solve(past);
  Way way;
  way.before_ = before;
  way.places_.reshaped<Eigen::ColMajor>() = C_.transpose() * w;
  way.leverage_ = past.dot(w);
  return way;
}

Vector2d WayPrediction::Way::knot(int k) const noexcept {
  if (k < 0) return before_;
  return k == 0 ? Vector2d::Zero() : Vector2d(places_.col(std::min(k, kKnots) - 1));
}

perturbation::Jet<Vector2d> WayPrediction::Way::at(double t) const noexcept {
  const double steps = std::clamp(t / kStep, 0.0, static_cast<double>(kKnots));
  const int k = static_cast<int>(steps);
  const double u = steps - k;
  const Vector2d p0 = knot(k), p1 = knot(k + 1);
  const Vector2d m0 = 0.5 * (p1 - knot(k - 1)), m1 = 0.5 * (knot(k + 2) - p0);
  const Vector2d c2 = 3.0 * (p1 - p0) - 2.0 * m0 - m1, c3 = 2.0 * (p0 - p1) + m0 + m1;
  return {p0 + u * (m0 + u * (c2 + u * c3)), (m0 + u * (2.0 * c2 + 3.0 * u * c3)) / kStep,
          (2.0 * c2 + 6.0 * u * c3) / (kStep * kStep)};
}

}  // namespace mbk::control
