#pragma once

#include <cstdint>

#include "mbk/base/core/result.h"
#include "mbk/simulate/laboratory/noise.h"
#include "mbk/simulate/laboratory/one_axis_loop.h"

namespace mbk::laboratory {

/// The sensors of a machine of one axis; in its units, radians and N·m or metres and N. Zero switches a part off.
struct OneAxisSensorOptions {
  double position_resolution = 2e-6;  ///< positions are whole multiples of it [rad or m] ≥ 0
  double reaction_noise = 0.02;       ///< white, standard deviation [N·m or N] ≥ 0
  double coloured_noise = 0.0;        ///< of the reaction, standard deviation [N·m or N] ≥ 0
  Hertz coloured_bandwidth{1.5};      ///< of the coloured noise, −3 dB, first order > 0
  double drift_walk = 0.0;            ///< random walk of the reaction [N·m/√s or N/√s] ≥ 0
  double drift_rate = 0.0;            ///< steady drift of the reaction [N·m/s or N/s]
  double acceleration_noise = 0.02;   ///< white, standard deviation [rad/s² or m/s²] ≥ 0
};

/// Sensors of one axis. Each source of noise has a stream of the seed for itself. Nothing allocates.
class OneAxisSensors {
 public:
  /// @fails  usage: an option is out of its range, with its name, value and limit; sample_time ≤ 0.
  [[nodiscard]] static Result<OneAxisSensors> create(const OneAxisSensorOptions& options, double sample_time,
                                                     std::uint64_t seed);

  /// The position as the servo sees it.
  [[nodiscard]] double position(double truth) const noexcept { return quantised(truth, position_resolution_); }

  /// One sample of the recording.
  struct Reading {
    double time;          ///< [s]
    double position;      ///< [rad or m]
    double reaction;      ///< of the limb on the machine [N·m or N]
    double acceleration;  ///< [rad/s² or m/s²]
  };

  /// The next sample; once for each tick.
  Reading read(const OneAxisTrueState& state) noexcept;

 private:
  OneAxisSensors(const OneAxisSensorOptions& options, double sample_time, std::uint64_t seed);

  double position_resolution_;
  WhiteNoise white_, acceleration_;
  ColouredNoise coloured_;
  Drift drift_;
};

}  // namespace mbk::laboratory
