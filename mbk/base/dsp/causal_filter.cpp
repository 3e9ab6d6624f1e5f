#include "mbk/base/dsp/causal_filter.h"

namespace mbk::dsp {

CausalFilter::CausalFilter(SectionCascade sections) {
  sections_.reserve(sections.size());
  for (const SecondOrderSection& section : sections) sections_.push_back({section, 0.0, 0.0});
}

void CausalFilter::settle(double input) noexcept {
  for (auto& [s, s1, s2] : sections_) {
    const double output = s.gain_at_zero() * input;
    s2 = s.b2 * input - s.a2 * output;
    s1 = s.b1 * input - s.a1 * output + s2;
    input = output;
  }
}

double CausalFilter::step(double input) noexcept {
  for (auto& [s, s1, s2] : sections_) {
    const double output = s.b0 * input + s1;
    s1 = s.b1 * input - s.a1 * output + s2;
    s2 = s.b2 * input - s.a2 * output;
    input = output;
  }
  return input;
}

double delay_at_zero(const SectionCascade& filter, Hertz sample_rate) {
  double samples = 0.0;
  for (const SecondOrderSection& s : filter) {
    samples += (s.b1 + 2.0 * s.b2) / (s.b0 + s.b1 + s.b2) - (s.a1 + 2.0 * s.a2) / (1.0 + s.a1 + s.a2);
  }
  return samples / sample_rate.value;
}

}  // namespace mbk::dsp
