#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/sensor_calibration.h"

namespace mbk::calibration {

/// Loads and voltages of one run, row by row, in the axes of the sensor.
struct SensorRun {
  SourceFile source;
  std::vector<std::string> axes;   ///< n names, the same in every run
  Matrix force;                    ///< N×n [N]
  Matrix voltage;                  ///< N×n [V]
  std::optional<double> interval;  ///< between samples [s] > 0; absent if every row is an independent load
  std::vector<std::string> notes;
};

struct Converter {
  int bits = 12;        ///< 2 … 32
  double range = 10.0;  ///< ± [V] > 0
  [[nodiscard]] double step() const { return 2.0 * range / static_cast<double>(std::int64_t{1} << bits); }
};

struct SensorCalibrationOptions {
  bool crosstalk = true;            ///< false: each axis separately
  std::optional<double> lever_arm;  ///< L₀ [m] > 0
  std::optional<Converter> converter;
  double hac_lag_s = 1.0;       ///< of continuous runs ≥ 0
  double longest_delay = 0.05;  ///< longest delay tried in continuous runs [s] ≥ 0; 0: none
};

/// Frame of the force recorded with the voltages.
enum class SensorFrame {
  automatic,  ///< link if joint_2 is recorded, otherwise base
  link,       ///< the sensor turns with the last link, at joint_2: (E.4)
  base,       ///< sensor and force have the same axes
};

[[nodiscard]] constexpr auto word_table(SensorFrame) {
  using enum SensorFrame;
  return std::to_array<Word<SensorFrame>>({{automatic, "auto"}, {link, "link"}, {base, "base"}});
}

/// Loads and voltages of a recording: force_x with voltage_x, force_y with voltage_y. A recording with both voltages
/// and one force is a run without load on the other axis; a note says so. Where the sensor sits on the last link, the
/// force is turned into its axes, F_S = R_BS(θ₂)ᵀ F_B (Dyck 2013, eq. E.4).
/// @fails  data: no force or no voltage; `link` without joint_2 or one of four channels; a non-finite value (the
///         sample is named); time that does not increase.
[[nodiscard]] Result<SensorRun> sensor_run(const Recording& recording, SensorFrame frame);

/// Slope, zero, errors and quality of a force sensor from runs with known loads.
///
/// The load is known and the voltage is what scatters, so the voltage is regressed on the load and the result inverted:
///   V = a_r + C F(t − τ) + e,   S = C⁻¹,   V₀ = a_r of the last run r,   F = S (V − V₀)
/// Regression of the force on the voltage, the form in which Dyck (2013, eq. E.2) gives his, takes the scatter of the
/// voltage for load and is too flat by the factor R². At his R² = 0.9996 that is 0.04 %, a tenth of his standard error;
/// it stands beside as `SensorAxis::published`. Where the reference is a sensor too, its noise flattens C in the same
/// way, and the true slope lies between the two forms.
///
/// Standard errors are those of least squares with N − p degrees of freedom where every row is a load by itself, and
/// hold for residuals that are correlated over `hac_lag_s` (Newey & West) where runs are continuous; those of S and of
/// the intercept follow to first order. τ is looked for in continuous runs, and taken where it lowers the variance of
/// the residual by more than 1 %: a filter in the sensor that is not accounted for makes slopes too small, by 1.3 % for
/// 8.6 ms at 3 Hz.
/// @fails  usage: an option out of its range; no runs. data: runs of different axes, or of both kinds; fewer rows than
///         parameters + 1. not usable: a load that never changes; loads on one line, from which crosstalk cannot be
///         told (fit each axis separately then); a voltage that does not follow its load.
[[nodiscard]] Result<SensorCalibration> calibrate_sensor(const std::vector<SensorRun>& runs,
                                                         const SensorCalibrationOptions& options);

/// The step of a converter that voltages came through: the largest q of which all their differences are multiples;
/// absent where there is none to be seen (fewer than 8 different values, or averages).   @param values  any order [V]
[[nodiscard]] std::optional<double> quantisation_step(const Vector& values);

}  // namespace mbk::calibration
