#include "mbk/simulate/laboratory/sensors.h"

#include "mbk/base/core/option_limits.h"
#include "mbk/simulate/laboratory/link_axes.h"

namespace mbk::laboratory {
namespace {

Result<void> check(const SensorOptions& o, double sample_time) {
  if (auto ok = above_zero({{"sample time", sample_time, "s"}}); !ok) return ok;
  if (auto ok = not_negative({{"encoder resolution", o.encoder_resolution, "rad"}, {"jitter", o.clock.jitter, "s"}});
      !ok) {
    return ok;
  }
  if (!(o.clock.jitter < sample_time / 3.0)) {
    return bad_usage(
        fmt::format("jitter {:g} s is not below a third of the sample time {:g} s", o.clock.jitter, sample_time));
  }
  const auto* current = std::get_if<MotorCurrentOptions>(&o.torque);
  if (current == nullptr) return {};
  for (int joint = 0; joint < 2; ++joint) {
    if (auto ok = above_zero({{"torque constant", current->torque_constant[joint], "N·m/A"},
                              {"1 + error of the torque constant", 1.0 + current->torque_constant_error[joint], ""}});
        !ok) {
      return ok;
    }
  }
  return not_negative({{"noise of the motor current", current->noise, "A"}});
}

double current_noise(const SensorOptions& options) {
  const auto* current = std::get_if<MotorCurrentOptions>(&options.torque);
  return current == nullptr ? 0.0 : current->noise;
}

}  // namespace

SensorOptions SensorOptions::perfect() {
  return {
      .encoder_resolution = 0.0, .force = PerfectSensor{}, .acceleration = PerfectSensor{}, .torque = {}, .clock = {}};
}

Result<SensorSuite> SensorSuite::create(const SensorOptions& options, const robot::Geometry& geometry,
                                        double sample_time, std::uint64_t seed) {
  if (auto ok = check(options, sample_time); !ok) return tl::unexpected(ok.error());
  ForceSensor force = PerfectSensor{};
  if (const auto* load_cell = std::get_if<LoadCellOptions>(&options.force)) {
    auto sensor = LoadCell::create(*load_cell, sample_time, seed);
    if (!sensor) return tl::unexpected(sensor.error());
    force = *std::move(sensor);
  } else if (const auto* strain_gauge = std::get_if<StrainGaugeOptions>(&options.force)) {
    auto sensor = StrainGauge::create(*strain_gauge, sample_time, seed);
    if (!sensor) return tl::unexpected(sensor.error());
    force = *std::move(sensor);
  }
  AccelerationSensor acceleration = PerfectSensor{};
  if (const auto* accelerometer = std::get_if<AccelerometerOptions>(&options.acceleration)) {
    auto sensor = Accelerometer::create(*accelerometer, sample_time, seed);
    if (!sensor) return tl::unexpected(sensor.error());
    acceleration = *std::move(sensor);
  }
  return SensorSuite(options, geometry, sample_time, seed, std::move(force), std::move(acceleration));
}

SensorSuite::SensorSuite(const SensorOptions& options, const robot::Geometry& geometry, double sample_time,
                         std::uint64_t seed, ForceSensor force, AccelerationSensor acceleration)
    : encoder_resolution_(options.encoder_resolution),
      geometry_(geometry),
      force_(std::move(force)),
      acceleration_(std::move(acceleration)),
      current_noise_{WhiteNoise(current_noise(options), noise_stream(seed, NoiseSource::motor_current, 0)),
                     WhiteNoise(current_noise(options), noise_stream(seed, NoiseSource::motor_current, 1))},
      clock_(options.clock.jitter, sample_time, noise_stream(seed, NoiseSource::clock)),
      timestamps_(options.clock.timestamps),
      sample_time_(sample_time) {
  if (const auto* current = std::get_if<MotorCurrentOptions>(&options.torque)) {
    torque_gain_error_ = current->torque_constant_error;
    torque_noise_gain_ = current->torque_constant.cwiseProduct(Vector2d::Ones() + current->torque_constant_error);
  }
}

Vector2d SensorSuite::encoders(const Vector2d& motor_angle) const noexcept {
  return {quantised(motor_angle[0], encoder_resolution_), quantised(motor_angle[1], encoder_resolution_)};
}

SensorSuite::Reading SensorSuite::read(const TrueState& state) noexcept {
  const Vector2d joint = encoders(state.motor_angle);
  return {.time = read_time(state.time),
          .joint = joint,
          .hand = robot::hand_position(geometry_, joint),
          .force = read_force(state, joint[1]),
          .acceleration = read_acceleration(state, joint[1]),
          .torque = read_torque(state.motor_torque)};
}

Vector2d SensorSuite::read_force(const TrueState& state, double measured_theta2) noexcept {
  const Vector2d& truth = state.force_hand_on_robot;
  if (auto* cell = std::get_if<LoadCell>(&force_)) {
    return read_on_link(truth, state.theta[1], measured_theta2, [&](const Vector2d& f) { return cell->added(f); });
  }
  if (auto* gauge = std::get_if<StrainGauge>(&force_)) {
    return read_on_link(truth, state.theta[1], measured_theta2, [&](const Vector2d& f) { return gauge->added(f); });
  }
  return truth;
}

Vector2d SensorSuite::read_acceleration(const TrueState& state, double measured_theta2) noexcept {
  auto* sensor = std::get_if<Accelerometer>(&acceleration_);
  if (sensor == nullptr) return state.acceleration;
  return read_on_link(state.acceleration, state.theta[1], measured_theta2,
                      [&](const Vector2d& a) { return sensor->added(a); });
}

Vector2d SensorSuite::read_torque(const Vector2d& commanded) noexcept {
  const Vector2d noise(current_noise_[0].next(), current_noise_[1].next());
  return commanded + torque_gain_error_.cwiseProduct(commanded) + torque_noise_gain_.cwiseProduct(noise);
}

double SensorSuite::read_time(double actual) noexcept {
  if (timestamps_ == ClockOptions::Timestamps::actual) return actual;
  if (samples_ == 0.0) first_time_ = actual;
  return first_time_ + samples_++ * sample_time_;
}

std::int64_t SensorSuite::clipped_samples() const {
  const auto* gauge = std::get_if<StrainGauge>(&force_);
  return gauge == nullptr ? 0 : gauge->clipped_samples();
}

double SensorSuite::force_delay() const {
  const auto* gauge = std::get_if<StrainGauge>(&force_);
  return gauge == nullptr ? 0.0 : gauge->delay();
}

}  // namespace mbk::laboratory
