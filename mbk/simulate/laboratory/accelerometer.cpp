#include "mbk/simulate/laboratory/accelerometer.h"

#include <Eigen/Geometry>
#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::laboratory {
namespace {

template <int Axes>
Result<void> check(const AccelerometerOptions<Axes>& o) {
  if (auto ok = not_negative({{"noise of the accelerometer", o.noise, "m/s²"},
                              {"bandwidth of the accelerometer", o.bandwidth.value, "Hz"}});
      !ok) {
    return ok;
  }
  std::vector<Choice> numbers = {{"misalignment of the accelerometer", o.misalignment, "rad"}}, gains;
  for (int axis = 0; axis < Axes; ++axis) {
    numbers.push_back({"bias of the accelerometer", o.bias[axis], "m/s²"});
    gains.push_back({"1 + gain error of the accelerometer", 1.0 + o.gain_error[axis], ""});
  }
  MBK_TRY(finite(numbers));
  return above_zero(gains);
}

/// turn(−δ): what a sensor's axes that are turned by δ see of those of the link.
template <int Axes>
AxisMatrix<Axes> turned(double misalignment) {
  if constexpr (Axes == 1) {
    return AxisMatrix<1>(std::cos(misalignment));
  } else {
    return Eigen::Rotation2Dd(-misalignment).toRotationMatrix();
  }
}

}  // namespace

template <int Axes>
Result<Accelerometer<Axes>> Accelerometer<Axes>::create(const Options& options, double sample_time,
                                                        std::uint64_t seed) {
  MBK_TRY(check(options));
  MBK_TRY(above_zero({{"sample time", sample_time, "s"}}));
  dsp::SectionCascade filter;
  if (options.bandwidth.value > 0.0) {
    auto lowpass = dsp::butterworth_lowpass(1, options.bandwidth, Hertz(1.0 / sample_time));
    if (!lowpass) return tl::unexpected(lowpass.error().in("bandwidth of the accelerometer"));
    filter = *std::move(lowpass);
  }
  return Accelerometer(options, filter, seed);
}

template <int Axes>
Accelerometer<Axes>::Accelerometer(const Options& o, const dsp::SectionCascade& filter, std::uint64_t seed)
    : gain_((AxisVector<Axes>::Ones() + o.gain_error).asDiagonal() * turned<Axes>(o.misalignment)),
      bias_(o.bias),
      noise_(per_axis<Axes>([&](std::uint32_t axis) {
        return WhiteNoise(o.noise, noise_stream(seed, NoiseSource::acceleration, axis));
      })),
      filters_(per_axis<Axes>([&](std::uint32_t /*axis*/) { return dsp::CausalFilter(filter); })) {}

template <int Axes>
AxisVector<Axes> Accelerometer<Axes>::added(const AxisVector<Axes>& acceleration) noexcept {
  AxisVector<Axes> reading = gain_ * acceleration, noise;
  for (std::size_t axis = 0; axis < Axes; ++axis) {
    double& value = reading[static_cast<Eigen::Index>(axis)];
    if (!settled_) filters_[axis].settle(value);
    value = filters_[axis].step(value);
    noise[static_cast<Eigen::Index>(axis)] = noise_[axis].next();
  }
  settled_ = true;
  reading -= acceleration;
  return reading + bias_ + noise;
}

template class Accelerometer<1>;
template class Accelerometer<2>;

}  // namespace mbk::laboratory
