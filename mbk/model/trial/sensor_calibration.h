#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/recording.h"

namespace mbk {

/// Reasons for caution with a calibration.
enum class SensorWarningCode {
  few_loads,
  one_sided_loads,
  loads_nearly_collinear,
  clipping,
  nonlinear,
  hysteresis,
  noise_below_resolution,
  zero_changed,
  voltage_unlikely,
  step_contradicts_converter,
};

/// Stable: scripts may test for these words.
[[nodiscard]] constexpr auto word_table(SensorWarningCode) {
  using enum SensorWarningCode;
  return std::to_array<Word<SensorWarningCode>>({
      {few_loads, "few-loads"},
      {one_sided_loads, "one-sided-loads"},
      {loads_nearly_collinear, "loads-nearly-collinear"},
      {clipping, "clipping"},
      {nonlinear, "nonlinear"},
      {hysteresis, "hysteresis"},
      {noise_below_resolution, "noise-below-resolution"},
      {zero_changed, "zero-changed"},
      {voltage_unlikely, "voltage-unlikely"},
      {step_contradicts_converter, "step-contradicts-converter"},
  });
}

struct SensorWarning {
  SensorWarningCode code;
  std::string message;
  std::string remedy;  ///< what to try next; "try" in JSON
};

/// A line F = slope · V + intercept by regression of the force on the voltage (the form of Dyck 2013, eq. E.2).
struct ForceOnVoltage {
  double slope = 0.0, slope_error = 0.0;          ///< and its standard error [N/V]
  double intercept = 0.0, intercept_error = 0.0;  ///< force at 0 V, and its standard error [N]
  double r_squared = 0.0;
};

/// One axis of a calibrated force sensor.
struct SensorAxis {
  std::string name;                                     ///< "x" or "y", of force_x and voltage_x
  double zero_voltage = 0.0, zero_voltage_error = 0.0;  ///< V₀, voltage of no force, and its standard error [V]
  double intercept = 0.0, intercept_error = 0.0;        ///< force at 0 V on every axis, −(S V₀)ᵢ [N]
  double r_squared = 0.0;            ///< share of the voltage variance within runs explained by the loads
  double rmse = 0.0;                 ///< of F − S (V − V₀) [N]
  ForceOnVoltage published;          ///< this axis alone, in the inverse direction
  double full_scale = 0.0;           ///< largest |load| [N]
  Index loads = 0;                   ///< number of different loads on this axis, or of the load intervals
  double nonlinearity = 0.0;         ///< largest mean deviation from the line at one load [N]
  std::optional<double> hysteresis;  ///< largest difference between loading and unloading at one load [N]
  std::optional<double> noise;       ///< standard deviation at constant load [V]; absent if no load repeats
  std::optional<double> step;        ///< smallest step between voltages in the data [V]; absent if none is seen
  std::optional<double> conversion;  ///< stated step of the converter, 2·range/2ᵇⁱᵗˢ [V]
  /// The step to use: the stated one before the observed one.
  [[nodiscard]] std::optional<double> resolution() const { return conversion ? conversion : step; }
};

/// F = S (V − V₀) of a force sensor of one or two axes, in its own axes.
struct SensorCalibration {
  std::vector<SourceFile> sources;
  std::vector<SensorAxis> axes;  ///< n
  Matrix slope, slope_error;     ///< S and its standard errors, n×n [N/V]; diagonal without fitted crosstalk
  Matrix crosstalk,
      crosstalk_error;              ///< row j, column i: response of axis j to a load on axis i [N/N]; 0×0: not fitted
  std::optional<double> lever_arm;  ///< L₀ from the gauges to the load during the calibration [m]
  double delay = 0.0;               ///< delay of the voltage after the load [s]; 0 if none is seen
  std::vector<Vector> zero_voltages;  ///< V₀ of each run [V]; the last one is in `axes`
  Index rows = 0;                     ///< rows of tables, or samples
  bool continuous = false;            ///< from recordings over time; otherwise one row per load
  double hac_lag_s = 0.0;             ///< length of the residual correlation used in the standard errors, if continuous
  std::vector<SensorWarning> warnings;
  std::vector<std::string> notes;
};

}  // namespace mbk
