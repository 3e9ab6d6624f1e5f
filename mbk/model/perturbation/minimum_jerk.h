#pragma once

#include "mbk/model/perturbation/jet.h"

namespace mbk::perturbation {

/// The path from one state to another in time D that minimises ∫ (d³r/dt³)² dt: a polynomial of 5th degree with the
/// given value, velocity and acceleration at both ends (Flash & Hogan 1985, eq. A4). Holds the first state's jet
/// for t ≤ 0 and the last state's for t ≥ D.
class MinimumJerk {
 public:
  /// @param duration  D [s] > 0
  MinimumJerk(const Jet<double>& from, const Jet<double>& to, double duration);

  /// r, ṙ, r̈ at t [s] after the start.
  [[nodiscard]] Jet<double> at(double t) const;

 private:
  Jet<double> from_;
  Jet<double> to_;
  double duration_;
  double c_[6];  // r = Σ cₖ (t/D)ᵏ
};

}  // namespace mbk::perturbation
