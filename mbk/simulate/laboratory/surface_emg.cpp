#include "mbk/simulate/laboratory/surface_emg.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "mbk/base/core/option_limits.h"

namespace mbk::laboratory {
namespace {

constexpr int kBandOrder = 4;

/// After this many periods of its lower edge the noise is stationary.
constexpr double kSettledAfter = 20.0;

Index settling_samples(const SurfaceEmgOptions& options, double rate) {
  return static_cast<Index>(std::ceil(kSettledAfter * rate / options.lowest.value));
}

}  // namespace

Result<SurfaceEmg> SurfaceEmg::create(const SurfaceEmgOptions& options, Hertz rate, std::uint64_t seed,
                                      std::uint32_t channel) {
  MBK_TRY(above_zero({{"sample rate", rate.value, "Hz"}, {"mains frequency", options.mains.value, "Hz"}}));
  MBK_TRY(not_negative({{"EMG at maximal activation", options.largest, "V"},
                        {"noise of the EMG", options.noise, "V"},
                        {"mains hum", options.hum, "V"}}));
  if (!(options.lowest.value > 0.0 && options.lowest < options.highest && options.highest.value < 0.5 * rate.value)) {
    return bad_usage(fmt::format("the EMG's band from {:g} to {:g} Hz does not fit below half the rate of {:g} Hz",
                                 options.lowest.value, options.highest.value, rate.value),
                     "increase rate_hz, to 2000 for a band of 20 to 450 Hz");
  }
  auto band = MBK_TRY(dsp::butterworth_highpass(kBandOrder, options.lowest, rate));
  const auto upper = MBK_TRY(dsp::butterworth_lowpass(kBandOrder, options.highest, rate));
  band.insert(band.end(), upper.begin(), upper.end());
  dsp::CausalFilter impulse(band);
  double power = 0.0;  // of the output for white noise of variance 1: sum of the squared impulse response
  for (Index i = 0; i < settling_samples(options, rate.value); ++i)
    power += std::pow(impulse.step(i == 0 ? 1.0 : 0.0), 2);
  for (double* b : {&band.front().b0, &band.front().b1, &band.front().b2}) *b /= std::sqrt(power);
  return SurfaceEmg(options, rate, band, seed, channel);
}

SurfaceEmg::SurfaceEmg(const SurfaceEmgOptions& options, Hertz rate, const dsp::SectionCascade& band,
                       std::uint64_t seed, std::uint32_t channel)
    : options_(options),
      sample_time_(1.0 / rate.value),
      band_(band),
      source_(1.0, noise_stream(seed, NoiseSource::emg, channel)),
      noise_(options.noise, noise_stream(seed, NoiseSource::emg_electrodes, channel)) {
  for (Index i = 0; i < settling_samples(options, rate.value); ++i) band_.step(source_.next());
}

double SurfaceEmg::step(double activation) noexcept {
  samples_ += 1.0;
  const double hum = options_.hum * std::sin(2.0 * std::numbers::pi * options_.mains.value * samples_ * sample_time_);
  return options_.largest * activation * band_.step(source_.next()) + noise_.next() + hum;
}

}  // namespace mbk::laboratory
