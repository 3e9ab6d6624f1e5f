#pragma once

#include <optional>

#include "mbk/base/core/linear_algebra.h"

namespace mbk {

/// Measured force beside that of the model, over the segments on which the fit was judged. Where data were held out,
/// the model is that of the other data alone, whatever data stand behind the reported one, so that the VAF of these
/// rows is the VAF of the fit. Decimated for display; a row of NaN stands between two segments. Empty where there is no
/// model. Where decimation keeps extremes (no low-pass, or very long data), those of each column stand side by side
/// though they may lie some rows apart.
struct ForcePrediction {
  bool held_out = true;  ///< false: nothing was held out, and these samples made the parameters
  Vector time;           ///< [s] from the recording's first sample
  Matrix measured;       ///< N×n, F_h [N]: what the hand exerts on the robot, as filtered
  Matrix predicted;      ///< N×n, −((M + Λ I) ẍ + B ẋ + K (x − x₀)) [N], Λ the handle's mass
  Matrix residual;       ///< N×n, measured − predicted [N]
};

/// How far the residual of the reported model remembers itself: its autocorrelation, from 1 at lag 0, over lags of up
/// to 2 s or a quarter of the longest segment. Biased towards zero by the missing pairs; no pair reaches across a
/// break. Empty where there is no model.
struct Autocorrelation {
  Vector lag;            ///< [s], from 0; about four hundred at most
  Matrix value;          ///< L×n, of each axis
  double white95 = 0;    ///< ±1.96/√N: 95 % of the values of white noise of this length lie within
  Vector time_constant;  ///< n, where it first falls below 1/e [s], over all lags; NaN where it does not
};

/// Power spectral densities of what was recorded, and how much of the force the motion can explain at each frequency.
/// Empty where no segment is long enough.
struct Spectra {
  Vector frequency;  ///< [Hz]
  Matrix position;   ///< F×n [m²/Hz], as recorded
  Matrix force;      ///< F×n [N²/Hz], as recorded
  Matrix residual;   ///< F×n [N²/Hz], of the fit, after the filters; NaN beyond half the rate of its rows; empty
                     ///< without a model
  Matrix coherence;  ///< F×n, 0…1: of each force with all axes of the position (multiple coherence); NaN where the axes
                     ///< cannot be distinguished
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
  Vector time;            ///< [s] from the recording's first sample, decimated; a break as in ForcePrediction
  Matrix derivative;      ///< N×n [m/s²]
  Matrix sensor;          ///< N×n [m/s²]
  Vector rms_difference;  ///< n [m/s²], over every row that counts, means removed
  Vector vaf;             ///< n [%], of the sensor's by the derivative
};

/// x beside the double integral of the ẍ that the fit took, over the longest segment (Dyck 2013, fig. 3.6). Where the
/// integral starts and how fast is not in ẍ, so that a straight line is removed from both. One period of the cutoff is
/// left out at each end, where the low-pass knows the signals by their continuation only.
struct DoubleIntegral {
  Vector rms_difference;  ///< n [m]
  Vector vaf;             ///< n [%], of the position by the integral
};

/// Everything that shows how good one measurement is, ready to be drawn.
struct Diagnostics {
  ForcePrediction prediction;
  Autocorrelation autocorrelation;
  Spectra spectra;
  FilterResponse filters;
  std::optional<AccelerationAgreement> acceleration;  ///< only where the recording holds an accelerometer
  DoubleIntegral double_integral;
  /// The whole recording: the smallest and the largest value of each so many samples in their order, so that no spike
  /// is lost. A row of NaN stands where its clock has a gap that can be seen.
  Vector time;       ///< [s] from the recording's first sample
  Matrix position;   ///< N×n [m]
  Matrix force;      ///< N×n [N]
  Matrix reference;  ///< N×n; empty where none was recorded
};

}  // namespace mbk
