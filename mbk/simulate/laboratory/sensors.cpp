#include "mbk/simulate/laboratory/sensors.h"

#include "mbk/base/core/option_limits.h"
#include "mbk/simulate/laboratory/link_axes.h"

namespace mbk::laboratory {
namespace {

template <int Axes>
Result<void> check(const SensorOptions<Axes>& o, double sample_time) {
  MBK_TRY(above_zero({{"sample time", sample_time, "s"}}));
  if (auto ok = not_negative({{"encoder resolution", o.encoder_resolution, "rad"}, {"jitter", o.clock.jitter, "s"}});
      !ok) {
    return ok;
  }
  if (!(o.clock.jitter < sample_time / 3.0)) {
    return bad_usage(
        fmt::format("jitter {:g} s is not below a third of the sample time {:g} s", o.clock.jitter, sample_time));
  }
  const auto* current = std::get_if<MotorCurrentOptions<Axes>>(&o.torque);
  if (current == nullptr) return {};
  for (int joint = 0; joint < Axes; ++joint) {
    if (auto ok = above_zero({{"torque constant", current->torque_constant[joint], "N·m/A"},
                              {"1 + error of the torque constant", 1.0 + current->torque_constant_error[joint], ""}});
        !ok) {
      return ok;
    }
  }
  return not_negative({{"noise of the motor current", current->noise, "A"}});
}

template <int Axes>
double current_noise(const SensorOptions<Axes>& options) {
  const auto* current = std::get_if<MotorCurrentOptions<Axes>>(&options.torque);
  return current == nullptr ? 0.0 : current->noise;
}

/// The sensor that the options are of.
Result<PerfectSensor> made(const PerfectSensor& perfect, double /*sample_time*/, std::uint64_t /*seed*/) {
  return perfect;
}

Result<StrainGauge> made(const StrainGaugeOptions& options, double sample_time, std::uint64_t seed) {
  return StrainGauge::create(options, sample_time, seed);
}

template <int Axes>
Result<LoadCell<Axes>> made(const LoadCellOptions<Axes>& options, double sample_time, std::uint64_t seed) {
  return LoadCell<Axes>::create(options, sample_time, seed);
}

template <int Axes>
Result<Accelerometer<Axes>> made(const AccelerometerOptions<Axes>& options, double sample_time, std::uint64_t seed) {
  return Accelerometer<Axes>::create(options, sample_time, seed);
}

template <class Sensor, class Options>
Result<Sensor> made_of(const Options& chosen, double sample_time, std::uint64_t seed) {
  return std::visit(
      [&](const auto& options) -> Result<Sensor> {
        auto sensor = made(options, sample_time, seed);
        if (!sensor) return tl::unexpected(sensor.error());
        return Sensor(*std::move(sensor));
      },
      chosen);
}

/// The reading of a vector of the base frame by a sensor on the last link, which is the last axis.
template <int Axes, class Sensor>
AxisVector<Axes> read_by(Sensor& chosen, const AxisVector<Axes>& truth, const TrueState<Axes>& state,
                         const AxisVector<Axes>& measured_theta) noexcept {
  return std::visit(
      [&](auto& sensor) -> AxisVector<Axes> {
        if constexpr (std::is_same_v<decltype(sensor), PerfectSensor&>) {
          return truth;
        } else {
          return read_on_link(truth, state.theta[Axes - 1], measured_theta[Axes - 1],
                              [&](const AxisVector<Axes>& v) { return sensor.added(v); });
        }
      },
      chosen);
}

}  // namespace

template <int Axes>
SensorOptions<Axes> SensorOptions<Axes>::perfect() {
  return {
      .encoder_resolution = 0.0, .force = PerfectSensor{}, .acceleration = PerfectSensor{}, .torque = {}, .clock = {}};
}

template <int Axes>
Result<SensorSuite<Axes>> SensorSuite<Axes>::create(const Options& options, const GeometryOf<Axes>& geometry,
                                                    double sample_time, std::uint64_t seed) {
  MBK_TRY(check(options, sample_time));
  auto force = made_of<ForceSensor>(options.force, sample_time, seed);
  if (!force) return tl::unexpected(force.error());
  auto acceleration = made_of<AccelerationSensor>(options.acceleration, sample_time, seed);
  if (!acceleration) return tl::unexpected(acceleration.error());
  return SensorSuite(options, geometry, sample_time, seed, *std::move(force), *std::move(acceleration));
}

template <int Axes>
SensorSuite<Axes>::SensorSuite(const Options& options, const GeometryOf<Axes>& geometry, double sample_time,
                               std::uint64_t seed, ForceSensor force, AccelerationSensor acceleration)
    : encoder_resolution_(options.encoder_resolution),
      geometry_(geometry),
      force_(std::move(force)),
      acceleration_(std::move(acceleration)),
      current_noise_(per_axis<Axes>([&](std::uint32_t axis) {
        return WhiteNoise(current_noise(options), noise_stream(seed, NoiseSource::motor_current, axis));
      })),
      clock_(options.clock.jitter, sample_time, noise_stream(seed, NoiseSource::clock)),
      timestamps_(options.clock.timestamps),
      sample_time_(sample_time) {
  if (const auto* current = std::get_if<MotorCurrentOptions<Axes>>(&options.torque)) {
    torque_gain_error_ = current->torque_constant_error;
    torque_noise_gain_ = current->torque_constant.cwiseProduct(Values::Ones() + current->torque_constant_error);
  }
}

template <int Axes>
AxisVector<Axes> SensorSuite<Axes>::encoders(const Values& motor_angle) const noexcept {
  return motor_angle.unaryExpr([this](double angle) { return quantised(angle, encoder_resolution_); });
}

template <int Axes>
auto SensorSuite<Axes>::read(const TrueState<Axes>& state) noexcept -> Reading {
  const Values joint = encoders(state.motor_angle);
  return {.time = read_time(state.time),
          .joint = joint,
          .hand = hand_position(geometry_, joint),
          .force = read_by<Axes>(force_, state.force_hand_on_robot, state, joint),
          .acceleration = read_by<Axes>(acceleration_, state.acceleration, state, joint),
          .torque = read_torque(state.motor_torque)};
}

template <int Axes>
AxisVector<Axes> SensorSuite<Axes>::read_torque(const Values& commanded) noexcept {
  Values noise;
  for (int joint = 0; joint < Axes; ++joint) noise[joint] = current_noise_[static_cast<std::size_t>(joint)].next();
  return commanded + torque_gain_error_.cwiseProduct(commanded) + torque_noise_gain_.cwiseProduct(noise);
}

template <int Axes>
double SensorSuite<Axes>::read_time(double actual) noexcept {
  if (timestamps_ == ClockOptions::Timestamps::actual) return actual;
  if (samples_ == 0.0) first_time_ = actual;
  return first_time_ + samples_++ * sample_time_;
}

template <int Axes>
std::int64_t SensorSuite<Axes>::clipped_samples() const {
  return std::visit(
      [](const auto& sensor) -> std::int64_t {
        if constexpr (requires { sensor.clipped_samples(); }) return sensor.clipped_samples();
        return 0;
      },
      force_);
}

template <int Axes>
double SensorSuite<Axes>::force_delay() const {
  return std::visit(
      [](const auto& sensor) {
        if constexpr (requires { sensor.delay(); }) return sensor.delay();
        return 0.0;
      },
      force_);
}

template struct SensorOptions<1>;
template struct SensorOptions<2>;
template class SensorSuite<1>;
template class SensorSuite<2>;

}  // namespace mbk::laboratory
