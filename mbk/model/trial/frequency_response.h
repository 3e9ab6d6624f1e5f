#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/identification.h"

namespace mbk {

/// A response along the frequency axis and how sure it is, one entry for each frequency.
struct FrequencyResponse {
  Vector frequency;        ///< [Hz], rising, > 0
  Eigen::VectorXcd value;  ///< H(jω) [unit of the output per unit of the input]
  Vector phase;            ///< arg H [rad], without jumps of 2π from one frequency to the next
  Matrix relative;  ///< N×3 covariance of δH/H = δln|H| + jδφ: var ln|H|, cov(ln|H|, φ), var φ [1, rad, rad²]
  Matrix magnitude95;       ///< N×2: ends of the 95 % interval of |H|, of whose logarithm the error is taken as normal
  Vector phase_half_width;  ///< of the 95 % interval [rad]
  Vector real_half_width;   ///< of the 95 % interval of Re H
  Matrix region95;          ///< N×3: half axes of the ellipse that holds H with 95 %, the longer first, and the angle
                            ///< of the longer from the real axis [rad]
  [[nodiscard]] Index size() const { return frequency.size(); }
};

/// What the output of an admittance is: force → this.
enum class AdmittanceOutput { position, velocity, acceleration };

[[nodiscard]] constexpr auto word_table(AdmittanceOutput) {
  using enum AdmittanceOutput;
  return std::to_array<Word<AdmittanceOutput>>(
      {{position, "position"}, {velocity, "velocity"}, {acceleration, "acceleration"}});
}

/// A value and its standard error.
struct Estimate {
  double value = 0, standard_error = 0;
};

/// The impedance Z = F/V behind an identified admittance, within the excited band.
struct InvertedAdmittance {
  AdmittanceOutput output = AdmittanceOutput::position;
  Motion motion = Motion::unknown;  ///< by the unit of the force
  FrequencyResponse impedance;      ///< force per velocity
  FrequencyResponse stiffness;      ///< force per displacement, s Z
  /// s Z = M s² + B s + K where the model says just that: a continuous one without zeros and delay. K is absent where
  /// the output is a velocity, B and K where it is an acceleration.
  std::optional<Estimate> M, B, K;
  bool unstable = false;  ///< the admittance has zeros on the right, which are unstable poles of the impedance
};

/// Measured output beside the simulated one.
struct SimulatedOutput {
  Vector time, measured, simulated;  ///< as long as each other [s, unit of the output]
};

/// What follows from a transfer function.
struct TransferFunctionFindings {
  FrequencyResponse response;
  std::optional<InvertedAdmittance> inverse;
  SimulatedOutput drawn;  ///< decimated; NaN between two segments
};

}  // namespace mbk
