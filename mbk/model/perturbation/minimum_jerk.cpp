#include "mbk/model/perturbation/minimum_jerk.h"

#include <cassert>

namespace mbk::perturbation {

MinimumJerk::MinimumJerk(const Jet<double>& from, const Jet<double>& to, double duration)
    : from_(from), to_(to), duration_(duration) {
  assert(duration > 0.0);
  const double distance = to.value - from.value;
  const double v0 = from.first * duration, v1 = to.first * duration;
  const double a0 = from.second * duration * duration, a1 = to.second * duration * duration;
  c_[0] = from.value;
  c_[1] = v0;
  c_[2] = 0.5 * a0;
  c_[3] = 10.0 * distance - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
  c_[4] = -15.0 * distance + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
  c_[5] = 6.0 * distance - 3.0 * (v0 + v1) - 0.5 * (a0 - a1);
}

Jet<double> MinimumJerk::at(double t) const {
  if (t <= 0.0) return from_;
  if (t >= duration_) return to_;
  const double s = t / duration_;
  Jet<double> p{0.0, 0.0, 0.0};
  for (int k = 5; k >= 0; --k) {  // Horner's scheme for the value and both derivatives
    p.second = p.second * s + 2.0 * p.first;
    p.first = p.first * s + p.value;
    p.value = p.value * s + c_[k];
  }
  return {p.value, p.first / duration_, p.second / (duration_ * duration_)};
}

}  // namespace mbk::perturbation
