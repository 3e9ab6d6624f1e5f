#include "mbk/measure/preprocess/band.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::preprocess {
namespace {

/// Mean of the spectra of all columns and cuts, but for a factor.
Result<dsp::Spectrum> spectrum_of(const Columns& signals, const std::vector<Cut>& cuts, Hertz sample_rate,
                                  double finest = 0.1) {
  Index shortest = signals.rows();
  for (const Cut& cut : cuts) shortest = std::min(shortest, cut.end - cut.begin);
  // Ten seconds resolve the lines of a multisine; shorter pieces give what they can.
  const Hertz resolution(std::max(finest, sample_rate.value / static_cast<double>(std::max<Index>(shortest, 1))));
  dsp::Spectrum sum;
  for (const Cut& cut : cuts) {
    for (Index axis = 0; axis < signals.cols(); ++axis) {
      const auto signal = signals.col(axis).segment(cut.begin, cut.end - cut.begin);
      auto spectrum = MBK_TRY(dsp::welch(signal, sample_rate, resolution));
      if (sum.density.size() == 0) {
        sum = std::move(spectrum);
      } else {
        sum.density += spectrum.density;
      }
    }
  }
  return sum;
}

Hertz limit_of(Hertz sample_rate) {
  return Hertz(0.1 * sample_rate.value);
}

}  // namespace

Result<Band> excited_band(const Columns& motion, const std::vector<Cut>& cuts, Hertz sample_rate) {
  const auto position = MBK_TRY(spectrum_of(motion, cuts, sample_rate));
  dsp::Spectrum velocity = position;
  velocity.density.array() *= (2.0 * std::numbers::pi * velocity.frequency.array()).square();
  const Hertz limit = limit_of(sample_rate);
  return Band{dsp::power_quantile(position, 0.05, limit), dsp::power_quantile(velocity, 0.95, limit)};
}

Result<Hertz> band_top(const Columns& signals, const std::vector<Cut>& cuts, Hertz sample_rate) {
  const auto spectrum = MBK_TRY(spectrum_of(signals, cuts, sample_rate));
  return dsp::power_quantile(spectrum, 0.95, limit_of(sample_rate));
}

Result<Hertz> motion_top(const Vector& position, const std::vector<Cut>& cuts, Hertz sample_rate, Hertz limit) {
  const auto spectrum = MBK_TRY(spectrum_of(position, cuts, sample_rate, 1.0));
  const auto excited = MBK_TRY(excited_band(position, cuts, sample_rate));
  const Vector& f = spectrum.frequency;
  const Vector density = spectrum.density.array() * f.array().pow(4);
  const auto above = [&f](Hertz edge) { return std::ranges::upper_bound(f, edge.value) - f.begin(); };
  const Index begin = above(excited.high), end = above(limit);
  constexpr Index kMin = 5;
  if (end - begin < kMin) return limit;
  const double floor = numeric::upper_median({density.begin() + begin, density.begin() + end});
  for (Index i = begin; i < end; ++i) {
    if (density[i] < 2.0 * floor) return Hertz(f[i]);
  }
  return limit;
}

}  // namespace mbk::preprocess
