#pragma once

#include <optional>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/measure/calibration/force_sensor.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/sensor_calibration.h"

namespace mbk::calibration {

/// How the voltages of a recording become forces.
struct SensorUse {
  SensorCalibration calibration;
  std::string name;                    ///< of the calibration's file, for notes
  std::optional<double> lever_arm;     ///< L from the gauges to the hand here [m] > 0; absent: as in the calibration
  std::optional<Vector> zero_voltage;  ///< V₀ here [V], one for each axis; absent: as in the calibration
  std::optional<double> zero_from_s;   ///< V₀ is the mean over this time at the start, without load [s] > 0
  SensorFrame frame = SensorFrame::automatic;
  bool undo_delay = false;  ///< the force is moved earlier by the calibration's delay
};

/// force_x and force_y of a recording from its voltage_x and voltage_y:
///   F_S = (L₀/L) S (V − V₀),   F_B = R_BS(θ₂) F_S where the sensor turns with the last link   (Dyck 2013, E.3, E.4)
/// **The lever arm scales the slope alone**: V₀ is the voltage of no force, which has no moment. A force that the
/// recording holds already is replaced. Where the delay τ is undone, F(t) is what was read at t + τ, by straight lines
/// between samples, and the samples at the end for which nothing was read any more are gone from every channel.
/// Notes say all of it.
/// @fails  data: a voltage of the calibration is not there, or is not a number (the sample is named); `link` without
///         joint_2 or with one axis.
///         usage: a lever arm where the calibration names none, or that is not above 0; another number of zeros than
///         axes; both ways to say the zero; more seconds for the zero than there are.
[[nodiscard]] Result<Recording> force_from_voltage(Recording recording, const SensorUse& use);

}  // namespace mbk::calibration
