#pragma once

#include <optional>

#include "mbk/base/core/linear_algebra.h"

namespace mbk {

/// Measured and modelled force over the segments on which the fit was judged. If data were held out, the model is from
/// the other data only, whichever data the reported model uses, so that the VAF of these rows is the VAF of the fit.
/// Decimated for display; a row of NaN separates two segments. Empty without a model. If decimation keeps extremes (no
/// low-pass, or very long data), those of each column are in one row although they may be some rows apart.
struct ForcePrediction {
  bool held_out = true;  ///< false: nothing was held out, and the parameters are from these samples
  Vector time;           ///< [s] from the recording's first sample
  Matrix measured;       ///< N×n, F_h [N]: force of the hand on the robot, filtered
  Matrix predicted;      ///< N×n, −((M + Λ I) ẍ + B ẋ + K (x − x₀)) [N], Λ the handle's mass
  Matrix residual;       ///< N×n, measured − predicted [N]
};

/// Autocorrelation of the residual of the reported model, from 1 at lag 0, over lags of up
/// to 2 s or a quarter of the longest segment. Biased towards zero by missing pairs; no pair spans a break. Empty
/// without a model.
struct Autocorrelation {
  Vector lag;            ///< [s], from 0; about four hundred at most
  Matrix value;          ///< L×n, of each axis
  double white95 = 0;    ///< ±1.96/√N: 95 % of the values of white noise of this length lie within
  Vector time_constant;  ///< n, first lag below 1/e [s], over all lags; NaN if there is none
};

/// Power spectral densities of the recorded signals, and the share of the force that the motion can explain at each
/// frequency. Empty if no segment is long enough.
struct Spectra {
  Vector frequency;  ///< [Hz]
  Matrix position;   ///< F×n [m²/Hz], as recorded
  Matrix force;      ///< F×n [N²/Hz], as recorded
  Matrix residual;   ///< F×n [N²/Hz], of the fit, after the filters; NaN beyond half the rate of its rows; empty
                     ///< without a model
  Matrix coherence;  ///< F×n, 0…1: of each force with all axes of the position (multiple coherence); NaN where the axes
                     ///< cannot be distinguished
  double coherence_significant = 0;  ///< coherence above it is significant (95 %)
  Index segments = 0;                ///< number of averaged segments, overlapping by half
};

/// Gain from position through filters and derivatives, compared with the ideal (Dyck 2013, fig. 3.5).
struct FilterResponse {
  Vector frequency;                  ///< [Hz]
  Vector smoothing;                  ///< gain of x
  Vector first, second;              ///< of ẋ [1/s] and ẍ [1/s²]
  Vector first_ideal, second_ideal;  ///< 2πf, (2πf)²
};

/// Acceleration from the position and from the accelerometer, with the same filters (fig. 3.6).
struct AccelerationAgreement {
  Vector time;            ///< [s] from the recording's first sample, decimated; a break as in ForcePrediction
  Matrix derivative;      ///< N×n [m/s²]
  Matrix sensor;          ///< N×n [m/s²]
  Vector rms_difference;  ///< n [m/s²], over every analysed row, means removed
  Vector vaf;             ///< n [%], of the sensor's by the derivative
};

/// x and the double integral of the ẍ used in the fit, over the longest segment (Dyck 2013, fig. 3.6). The initial
/// position and velocity of the integral are undetermined, so a straight line is removed from both. One period of the
/// cutoff is omitted at each end, where the low-pass depends on extrapolated signals.
struct DoubleIntegral {
  Vector rms_difference;  ///< n [m]
  Vector vaf;             ///< n [%], of the position by the integral
};

/// All diagnostics of one measurement, ready for plotting.
struct Diagnostics {
  ForcePrediction prediction;
  Autocorrelation autocorrelation;
  Spectra spectra;
  FilterResponse filters;
  std::optional<AccelerationAgreement> acceleration;  ///< only if the recording has an accelerometer
  DoubleIntegral double_integral;
  /// The whole recording: the minimum and maximum of every N samples, in order, so that no spike is lost. A row of NaN
  /// marks a visible gap of the clock.
  Vector time;       ///< [s] from the recording's first sample
  Matrix position;   ///< N×n [m]
  Matrix force;      ///< N×n [N]
  Matrix reference;  ///< N×n; empty where none was recorded
};

}  // namespace mbk
