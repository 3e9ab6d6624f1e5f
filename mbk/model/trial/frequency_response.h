#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/identification.h"

namespace mbk {

/// A frequency response with its uncertainty, one entry per frequency.
struct FrequencyResponse {
  Vector frequency;        ///< [Hz], rising, > 0
  Eigen::VectorXcd value;  ///< H(jω) [unit of the output per unit of the input]
  Vector phase;            ///< arg H [rad], without jumps of 2π from one frequency to the next
  Matrix relative;  ///< N×3 covariance of δH/H = δln|H| + jδφ: var ln|H|, cov(ln|H|, φ), var φ [1, rad, rad²]
  Matrix magnitude95;       ///< N×2: ends of the 95 % interval of |H|, assuming a normal error of its logarithm
  Vector phase_half_width;  ///< of the 95 % interval [rad]
  Vector real_half_width;   ///< of the 95 % interval of Re H
  Matrix region95;          ///< N×3: half axes of the 95 % ellipse of H, the longer first, and the angle
                            ///< of the longer from the real axis [rad]
  [[nodiscard]] Index size() const { return frequency.size(); }
};

/// The output quantity of an admittance: force → this.
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
  /// s Z = M s² + B s + K if the model has this form: continuous, without zeros and delay. K is absent if the output is
  /// a velocity, B and K if it is an acceleration.
  std::optional<Estimate> M, B, K;
  bool unstable =
      false;  ///< the admittance has zeros in the right half plane, which are unstable poles of the impedance
};

/// Measured and simulated output.
struct SimulatedOutput {
  Vector time, measured, simulated;  ///< of equal length [s, unit of the output]
};

/// Results derived from a transfer function.
struct TransferFunctionFindings {
  FrequencyResponse response;
  std::optional<InvertedAdmittance> inverse;
  SimulatedOutput drawn;  ///< decimated; NaN between two segments
};

}  // namespace mbk
