#include "mbk/preprocess/band.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/dsp/spectrum.h"

namespace mbk::preprocess {

Result<Band> excited_band(const Matrix& motion, const std::vector<Cut>& cuts, Hertz sample_rate) {
  Index shortest = motion.rows();
  for (const Cut& cut : cuts) shortest = std::min(shortest, cut.end - cut.begin);
  // Ten seconds resolve the lines of a multisine; shorter pieces give what they can.
  const Hertz resolution(std::max(0.1, sample_rate.value / static_cast<double>(std::max<Index>(shortest, 1))));
  dsp::Spectrum position;
  for (const Cut& cut : cuts) {
    for (Index axis = 0; axis < motion.cols(); ++axis) {
      auto spectrum = dsp::welch(motion.col(axis).segment(cut.begin, cut.end - cut.begin), sample_rate, resolution);
      if (!spectrum) return tl::unexpected(spectrum.error());
      if (position.density.size() == 0) {
        position = std::move(*spectrum);
      } else {
        position.density += spectrum->density;
      }
    }
  }
  dsp::Spectrum velocity = position;
  velocity.density.array() *= (2.0 * std::numbers::pi * position.frequency.array()).square();
  const Hertz limit(0.1 * sample_rate.value);
  return Band{dsp::power_quantile(position, 0.05, limit), dsp::power_quantile(velocity, 0.95, limit)};
}

}  // namespace mbk::preprocess
