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

/// The torque stands in the recording as commanded.
struct CommandedTorque {};

/// The torque is the measured current of a motor times its constant, as its user has it: k (1 + e)(τ/k + w).
template <int Axes>
struct MotorCurrentOptions {
  AxisVector<Axes> torque_constant = AxisVector<Axes>::Constant(0.1);  ///< k, at the joint [N·m/A] > 0
  AxisVector<Axes> torque_constant_error = AxisVector<Axes>::Zero();   ///< e, 0.01 for 1 %; above −1
  double noise = 0.0;                                                  ///< w: white, standard deviation [A] ≥ 0
};

/// How ticks come, and which times stand in the recording.
struct ClockOptions {
  enum class Timestamps {
    actual,   ///< when the tick was
    nominal,  ///< when it should have been: the first, and then every sample time
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
  /// Of a count [rad] ≥ 0: 2 µm at the end of the first link, which with one axis has the length 1; 0 for perfect.
  double encoder_resolution = Axes == 1 ? 2e-6 : 2e-6 / 0.254;
  ForceSensorOptions<Axes> force = LoadCellOptions<Axes>{};
  std::variant<AccelerometerOptions<Axes>, PerfectSensor> acceleration = AccelerometerOptions<Axes>{};
  std::variant<CommandedTorque, MotorCurrentOptions<Axes>> torque = CommandedTorque{};
  ClockOptions clock;

  /// What reads the truth to the last bit (of a rigid drive: the encoders sit on the motors).
  [[nodiscard]] static SensorOptions perfect();
};

/// All sensors of a robot. Force sensor and accelerometer sit on the last link: they read in its axes, and the reading
/// is turned to the base frame with the encoder's θ₂ (Dyck 2013, eq. E.4). Each source of noise has a stream of the
/// seed for itself. Nothing allocates after `create`.
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

  /// How long the next tick takes [s].
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

  /// Samples so far of which the force sensor's converter was beyond its range.
  [[nodiscard]] std::int64_t clipped_samples() const;

  /// By which slow forces come late [s].
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
