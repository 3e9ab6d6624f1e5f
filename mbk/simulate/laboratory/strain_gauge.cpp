#include "mbk/simulate/laboratory/strain_gauge.h"

#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::laboratory {
namespace {

Result<void> check(const StrainGaugeOptions& o) {
  for (int i = 0; i < 2; ++i) {
    MBK_TRY(above_zero({{"magnitude of the strain gauge's slope", std::abs(o.slope[i]), "N/V"}}));
    if (auto ok = finite({{"offset of the strain gauge", o.offset[i], "N"},
                          {"assumed offset of the strain gauge", o.assumed_offset[i], "N"}});
        !ok) {
      return ok;
    }
    MBK_TRY(magnitude_below(1.0, {{"crosstalk of the strain gauge", o.crosstalk[i], "N/N"}}));
  }
  if (auto ok = above_zero({{"lever arm of the strain gauge's calibration", o.calibration_arm, "m"},
                            {"lever arm of the strain gauge", o.arm, "m"},
                            {"assumed lever arm of the strain gauge", o.assumed_arm, "m"},
                            {"range of the strain gauge's converter", o.converter_range, "V"}});
      !ok) {
    return ok;
  }
  if (auto ok = not_negative({{"bridge noise of the strain gauge", o.bridge_noise, "V/√Hz"},
                              {"cutoff of the strain gauge's filter", o.cutoff.value, "Hz"}});
      !ok) {
    return ok;
  }
  if (o.converter_bits != 0 && (o.converter_bits < 2 || o.converter_bits > 24)) {
    return bad_usage(fmt::format("{} bits of the strain gauge's converter are not within 2 to 24", o.converter_bits),
                     "use 2 to 24, or 0 for no converter");
  }
  return {};
}

}  // namespace

Result<StrainGauge> StrainGauge::create(const StrainGaugeOptions& options, double sample_time, std::uint64_t seed) {
  MBK_TRY(check(options));
  MBK_TRY(above_zero({{"sample time", sample_time, "s"}}));
  dsp::SectionCascade filter;
  if (options.cutoff.value > 0.0) {
    auto lowpass = dsp::butterworth_lowpass(options.filter_order, options.cutoff, Hertz(1.0 / sample_time));
    if (!lowpass) return tl::unexpected(lowpass.error().in("filter of the strain gauge"));
    filter = *std::move(lowpass);
  }
  return StrainGauge(options, filter, sample_time, seed);
}

StrainGauge::StrainGauge(const StrainGaugeOptions& o, const dsp::SectionCascade& filter, double sample_time,
                         std::uint64_t seed)
    : zero_voltage_(-o.offset.cwiseQuotient(o.slope)),
      voltage_per_force_((o.arm / o.calibration_arm) * o.slope.cwiseInverse()),
      crosstalk_(o.crosstalk),
      assumed_zero_voltage_(-o.assumed_offset.cwiseQuotient(o.slope)),
      force_per_voltage_((o.calibration_arm / o.assumed_arm) * o.slope),
      delay_(dsp::delay_at_zero(filter, Hertz(1.0 / sample_time))),
      converter_(o.converter_bits, o.converter_range),
      noise_{noise(o, sample_time, seed, 0), noise(o, sample_time, seed, 1)},
      filters_{dsp::CausalFilter(filter), dsp::CausalFilter(filter)} {}

WhiteNoise StrainGauge::noise(const StrainGaugeOptions& o, double sample_time, std::uint64_t seed, std::uint32_t axis) {
  return WhiteNoise(o.bridge_noise * std::sqrt(0.5 / sample_time), noise_stream(seed, NoiseSource::strain_gauge, axis));
}

Eigen::Vector2d StrainGauge::read(const Eigen::Vector2d& force) noexcept {
  const Eigen::Vector2d felt = force + crosstalk_.cwiseProduct(force.reverse());
  Eigen::Vector2d voltage = zero_voltage_ + voltage_per_force_.cwiseProduct(felt);
  bool clipped = false;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double& v = voltage[static_cast<Eigen::Index>(axis)];
    if (!settled_) filters_[axis].settle(v);
    v = filters_[axis].step(v + noise_[axis].next());
    const AnalogueConverter::Conversion conversion = converter_.convert(v);
    v = conversion.voltage;
    clipped |= conversion.clipped;
  }
  settled_ = true;
  if (clipped) ++clipped_;
  return force_per_voltage_.cwiseProduct(voltage - assumed_zero_voltage_);
}

}  // namespace mbk::laboratory
