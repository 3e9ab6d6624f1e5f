#include "mbk/base/dsp/causal_filter.h"

namespace mbk::dsp {

double delay_at_zero(const SectionCascade& filter, Hertz sample_rate) {
  double samples = 0.0;
  for (const SecondOrderSection& s : filter) {
    samples += (s.b1 + 2.0 * s.b2) / (s.b0 + s.b1 + s.b2) - (s.a1 + 2.0 * s.a2) / (1.0 + s.a1 + s.a2);
  }
  return samples / sample_rate.value;
}

}  // namespace mbk::dsp
