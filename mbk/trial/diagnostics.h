#pragma once

#include <optional>

#include "mbk/core/linear_algebra.h"

namespace mbk {

/// Measured force beside that of the model, over the stretches on which the fit was judged. Thinned for display; a row
/// of NaN stands between two stretches. Empty where there is no model.
struct ForcePrediction {
  bool held_back = true;  ///< false: nothing was held back, and these samples made the parameters
  Vector time;            ///< [s] from the recording's first sample
  Matrix measured;        ///< N×n, F_h [N]: what the hand exerts on the robot, as filtered
  Matrix predicted;       ///< N×n, −((M + Λ I) ẍ + B ẋ + K (x − x₀)) [N], Λ the handle's mass
  Matrix residual;        ///< N×n, measured − predicted [N]
};

/// How far the residual remembers itself: its autocorrelation, from 1 at lag 0. Empty where there is no model.
struct Autocorrelation {
  Vector lag;            ///< [s], from 0
  Matrix value;          ///< L×n, of each axis
  double white95 = 0;    ///< ±1.96/√N: 95 % of the values of white noise of this length lie within
  Vector time_constant;  ///< n, where it first falls below 1/e [s]; NaN where it does not within the lags
};

/// Power spectral densities of what was recorded, and how much of the force the motion can explain at each frequency.
struct Spectra {
  Vector frequency;  ///< [Hz]
  Matrix position;   ///< F×n [m²/Hz], as recorded
  Matrix force;      ///< F×n [N²/Hz], as recorded
  Matrix residual;   ///< F×n [N²/Hz], of the fit, after the filters; NaN beyond half the rate of its rows
  Matrix coherence;  ///< F×n, 0…1: of each force with all axes of the position (multiple coherence)
  double coherence_significant = 0;  ///< coherence above it is not chance (95 %)
  Index segments = 0;                ///< that were averaged, overlapping by half
};

/// Gain of what the position passes through, filters and derivatives together, against the ideal (Dyck 2013, fig. 3.5).
struct FilterResponse {
  Vector frequency;                  ///< [Hz]
  Vector smoothing;                  ///< gain of x
  Vector first, second;              ///< of ẋ [1/s] and ẍ [1/s²]
  Vector first_ideal, second_ideal;  ///< 2πf, (2πf)²
};

/// The acceleration from the position beside that of the accelerometer, both through the same filters (fig. 3.6).
struct AccelerationAgreement {
  Vector time;            ///< [s] from the recording's first sample, thinned
  Matrix derivative;      ///< N×n [m/s²]
  Matrix sensor;          ///< N×n [m/s²]
  Vector rms_difference;  ///< n [m/s²], over every row that counts, means removed
  Vector vaf;             ///< n [%], of the sensor's by the derivative
};

/// Everything that shows how good one measurement is, ready to be drawn.
struct Diagnostics {
  ForcePrediction prediction;
  Autocorrelation autocorrelation;
  Spectra spectra;
  FilterResponse filters;
  std::optional<AccelerationAgreement> acceleration;  ///< only where the recording holds an accelerometer
  Vector time;                                        ///< [s], thinned: the whole recording
  Matrix position;                                    ///< N×n [m], as recorded, thinned
  Matrix force;                                       ///< N×n [N], as recorded, thinned
  Matrix reference;                                   ///< N×n, thinned; empty where none was recorded
};

}  // namespace mbk
