#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <variant>

#include "mbk/base/core/result.h"
#include "mbk/simulate/laboratory/accelerometer.h"
#include "mbk/simulate/laboratory/closed_loop.h"
#include "mbk/simulate/laboratory/load_cell.h"
#include "mbk/simulate/laboratory/sample_clock.h"
#include "mbk/simulate/laboratory/strain_gauge.h"

namespace mbk::laboratory {

/// A sensor that reads the truth.
struct PerfectSensor {};

/// The recording contains the commanded torque.
struct CommandedTorque {};

/// The torque is the measured motor current times the assumed constant: k (1 + e)(τ/k + w).
template <int Axes>
struct MotorCurrentOptions {
  AxisVector<Axes> torque_constant = AxisVector<Axes>::Constant(0.1);  ///< k, at the joint [N·m/A] > 0
  AxisVector<Axes> torque_constant_error = AxisVector<Axes>::Zero();   ///< e, 0.01 for 1 %; above −1
  double noise = 0.0;                                                  ///< w: white, standard deviation [A] ≥ 0
};

/// Timing of the ticks, and of the times in the recording.
struct ClockOptions {
  enum class Timestamps {
    actual,   ///< actual time of the tick
    nominal,  ///< nominal time: the first tick, then every sample time
  };
  double jitter = 0.0;  ///< standard deviation of an interval [s] ≥ 0, below a third of the sample time
  Timestamps timestamps = Timestamps::actual;
};

/// Which sensors measure the force: the strain gauges are those of the planar robot's beam.
template <int Axes>
using ForceSensorOptions = std::conditional_t<Axes == 1, std::variant<LoadCellOptions<Axes>, PerfectSensor>,
                                              std::variant<LoadCellOptions<Axes>, StrainGaugeOptions, PerfectSensor>>;

/// The sensors of a robot of so many axes; by default those of Dyck (2013, §3.4.1) with the load cell. With one axis
/// they are in its units: rad and N·m, or m and N.
template <int Axes>
struct SensorOptions {
  /// Encoder resolution [rad] ≥ 0: 2 µm at the end of the first link (length 1 with one axis); 0 for none.
  double encoder_resolution = Axes == 1 ? 2e-6 : 2e-6 / 0.254;
  ForceSensorOptions<Axes> force = LoadCellOptions<Axes>{};
  std::variant<AccelerometerOptions<Axes>, PerfectSensor> acceleration = AccelerometerOptions<Axes>{};
  std::variant<CommandedTorque, MotorCurrentOptions<Axes>> torque = CommandedTorque{};
  ClockOptions clock;

  /// Exact sensors (for a rigid drive, as the encoders are on the motors).
  [[nodiscard]] static SensorOptions perfect();
};

/// All sensors of a robot. Force sensor and accelerometer are on the last link: they read in its axes, and readings are
/// rotated to the base frame with θ₂ of the encoder (Dyck 2013, eq. E.4). Each noise source has its own random stream.
/// Nothing allocates after `create`.
template <int Axes>
class SensorSuite {
 public:
  using Values = AxisVector<Axes>;
  using Options = SensorOptions<Axes>;

  /// @param sample_time  of the loop [s] > 0
  /// @fails  usage: an option is out of its range (see each option), with its name, value and limit.
  [[nodiscard]] static Result<SensorSuite> create(const Options& options, const GeometryOf<Axes>& geometry,
                                                  double sample_time, std::uint64_t seed);

  /// Joint angles as the controller sees them: the motors' angles [rad] in whole counts.
  [[nodiscard]] Values encoders(const Values& motor_angle) const noexcept;

  /// Duration of the next tick [s].
  double next_interval() noexcept { return clock_.next_interval(); }

  /// One sample of the recording.
  struct Reading {
    double time;          ///< [s]
    Values joint;         ///< of the encoders [rad]
    Values hand;          ///< forward kinematics of `joint`, base frame [m]
    Values force;         ///< of the hand on the robot, base frame [N]
    Values acceleration;  ///< of the hand, base frame [m/s²]
    Values torque;        ///< of the motors [N·m]
  };

  /// The next sample; once for each tick.
  Reading read(const TrueState<Axes>& state) noexcept;

  /// Number of samples so far with the converter of the force sensor beyond its range.
  [[nodiscard]] std::int64_t clipped_samples() const;

  /// Delay of slow forces [s].
  [[nodiscard]] double force_delay() const;

 private:
  using ForceSensor = std::conditional_t<Axes == 1, std::variant<LoadCell<Axes>, PerfectSensor>,
                                         std::variant<LoadCell<Axes>, StrainGauge, PerfectSensor>>;
  using AccelerationSensor = std::variant<Accelerometer<Axes>, PerfectSensor>;

  SensorSuite(const Options& options, const GeometryOf<Axes>& geometry, double sample_time, std::uint64_t seed,
              ForceSensor force, AccelerationSensor acceleration);

  Values read_torque(const Values& commanded) noexcept;
  double read_time(double actual) noexcept;

  double encoder_resolution_;
  GeometryOf<Axes> geometry_;
  ForceSensor force_;
  AccelerationSensor acceleration_;
  Values torque_gain_error_ = Values::Zero(), torque_noise_gain_ = Values::Zero();
  std::array<WhiteNoise, Axes> current_noise_;
  SampleClock clock_;
  ClockOptions::Timestamps timestamps_;
  double sample_time_, first_time_ = 0.0, samples_ = 0.0;
};

extern template struct SensorOptions<1>;
extern template struct SensorOptions<2>;
extern template class SensorSuite<1>;
extern template class SensorSuite<2>;

}  // namespace mbk::laboratory
