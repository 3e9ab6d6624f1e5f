#include "mbk/simulate/laboratory/accelerometer.h"

#include <Eigen/Geometry>

#include "mbk/base/core/option_limits.h"

namespace mbk::laboratory {
namespace {

Result<void> check(const AccelerometerOptions& o) {
  if (auto ok = not_negative({{"noise of the accelerometer", o.noise, "m/s²"},
                              {"bandwidth of the accelerometer", o.bandwidth.value, "Hz"}});
      !ok) {
    return ok;
  }
  if (auto ok = finite({{"misalignment of the accelerometer", o.misalignment, "rad"},
                        {"bias of the accelerometer", o.bias[0], "m/s²"},
                        {"bias of the accelerometer", o.bias[1], "m/s²"}});
      !ok) {
    return ok;
  }
  return above_zero({{"1 + gain error of the accelerometer", 1.0 + o.gain_error[0], ""},
                     {"1 + gain error of the accelerometer", 1.0 + o.gain_error[1], ""}});
}

}  // namespace

Result<Accelerometer> Accelerometer::create(const AccelerometerOptions& options, double sample_time,
                                            std::uint64_t seed) {
  if (auto ok = check(options); !ok) return tl::unexpected(ok.error());
  if (auto ok = above_zero({{"sample time", sample_time, "s"}}); !ok) return tl::unexpected(ok.error());
  dsp::SectionCascade filter;
  if (options.bandwidth.value > 0.0) {
    auto lowpass = dsp::butterworth_lowpass(1, options.bandwidth, Hertz(1.0 / sample_time));
    if (!lowpass) return tl::unexpected(lowpass.error().in("bandwidth of the accelerometer"));
    filter = *std::move(lowpass);
  }
  return Accelerometer(options, filter, seed);
}

Accelerometer::Accelerometer(const AccelerometerOptions& o, const dsp::SectionCascade& filter, std::uint64_t seed)
    : gain_((Eigen::Vector2d::Ones() + o.gain_error).asDiagonal() *
            Eigen::Rotation2Dd(-o.misalignment).toRotationMatrix()),
      bias_(o.bias),
      noise_{WhiteNoise(o.noise, noise_stream(seed, NoiseSource::acceleration, 0)),
             WhiteNoise(o.noise, noise_stream(seed, NoiseSource::acceleration, 1))},
      filters_{dsp::CausalFilter(filter), dsp::CausalFilter(filter)} {}

Eigen::Vector2d Accelerometer::added(const Eigen::Vector2d& acceleration) noexcept {
  Eigen::Vector2d reading = gain_ * acceleration;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double& value = reading[static_cast<Eigen::Index>(axis)];
    if (!settled_) filters_[axis].settle(value);
    value = filters_[axis].step(value);
  }
  settled_ = true;
  reading -= acceleration;
  return reading + bias_ + Eigen::Vector2d(noise_[0].next(), noise_[1].next());
}

}  // namespace mbk::laboratory
