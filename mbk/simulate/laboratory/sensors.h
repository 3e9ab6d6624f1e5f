#pragma once

#include <array>
#include <cstdint>
#include <variant>

#include "mbk/base/core/result.h"
#include "mbk/model/robot/kinematics.h"
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
struct MotorCurrentOptions {
  Vector2d torque_constant = {0.1, 0.1};        ///< k, at the joint [N·m/A] > 0
  Vector2d torque_constant_error = {0.0, 0.0};  ///< e, 0.01 for 1 %; above −1
  double noise = 0.0;                           ///< w: white, standard deviation [A] ≥ 0
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

/// The sensors of the planar robot; by default those of Dyck (2013, §3.4.1) with the load cell.
struct SensorOptions {
  double encoder_resolution = 2e-6 / 0.254;  ///< of a count [rad] ≥ 0: 2 µm at the end of the first link; 0 for perfect
  std::variant<LoadCellOptions, StrainGaugeOptions, PerfectSensor> force = LoadCellOptions{};
  std::variant<AccelerometerOptions, PerfectSensor> acceleration = AccelerometerOptions{};
  std::variant<CommandedTorque, MotorCurrentOptions> torque = CommandedTorque{};
  ClockOptions clock;

  /// What reads the truth to the last bit (of a rigid drive: the encoders sit on the motors).
  [[nodiscard]] static SensorOptions perfect();
};

/// All sensors of the planar robot. Force sensor and accelerometer sit on the last link: they read in its axes, and the
/// reading is turned to the base frame with the encoder's θ₂ (Dyck 2013, eq. E.4). Each source of noise has a stream of
/// the seed for itself. Nothing allocates after `create`.
class SensorSuite {
 public:
  /// @param sample_time  of the loop [s] > 0
  /// @fails  usage: an option is out of its range (see each option), with its name, value and limit.
  [[nodiscard]] static Result<SensorSuite> create(const SensorOptions& options, const robot::Geometry& geometry,
                                                  double sample_time, std::uint64_t seed);

  /// Joint angles as the controller sees them: the motors' angles [rad] in whole counts.
  [[nodiscard]] Vector2d encoders(const Vector2d& motor_angle) const noexcept;

  /// How long the next tick takes [s].
  double next_interval() noexcept { return clock_.next_interval(); }

  /// One sample of the recording.
  struct Reading {
    double time;            ///< [s]
    Vector2d joint;         ///< of the encoders [rad]
    Vector2d hand;          ///< forward kinematics of `joint`, base frame [m]
    Vector2d force;         ///< of the hand on the robot, base frame [N]
    Vector2d acceleration;  ///< of the hand, base frame [m/s²]
    Vector2d torque;        ///< of the motors [N·m]
  };

  /// The next sample; once for each tick.
  Reading read(const TrueState& state) noexcept;

  /// Samples so far of which the force sensor's converter was beyond its range.
  [[nodiscard]] std::int64_t clipped_samples() const;

  /// By which slow forces come late [s].
  [[nodiscard]] double force_delay() const;

 private:
  using ForceSensor = std::variant<LoadCell, StrainGauge, PerfectSensor>;
  using AccelerationSensor = std::variant<Accelerometer, PerfectSensor>;

  SensorSuite(const SensorOptions& options, const robot::Geometry& geometry, double sample_time, std::uint64_t seed,
              ForceSensor force, AccelerationSensor acceleration);

  Vector2d read_force(const TrueState& state, double measured_theta2) noexcept;
  Vector2d read_acceleration(const TrueState& state, double measured_theta2) noexcept;
  Vector2d read_torque(const Vector2d& commanded) noexcept;
  double read_time(double actual) noexcept;

  double encoder_resolution_;
  robot::Geometry geometry_;
  ForceSensor force_;
  AccelerationSensor acceleration_;
  Vector2d torque_gain_error_ = {0.0, 0.0}, torque_noise_gain_ = {0.0, 0.0};
  std::array<WhiteNoise, 2> current_noise_;
  SampleClock clock_;
  ClockOptions::Timestamps timestamps_;
  double sample_time_, first_time_ = 0.0, samples_ = 0.0;
};

}  // namespace mbk::laboratory
