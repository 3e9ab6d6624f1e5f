#include "mbk/dsp/zero_phase.h"

#include <fmt/format.h>

#include <vector>

namespace mbk::dsp {
namespace {

/// Runs the cascade over `signal` in place, in transposed direct form II, from the steady state for a constant input
/// equal to the first sample. `step` is +1 for forward and −1 for backward.
void filter_from_steady_state(const SectionCascade& filter, Vector& signal, Index first, Index step) {
  struct State {
    double s1, s2;
  };
  std::vector<State> states;
  states.reserve(filter.size());
  double input = signal[first];
  for (const SecondOrderSection& s : filter) {
    const double output = s.gain_at_zero() * input;
    const double s2 = s.b2 * input - s.a2 * output;
    states.push_back({s.b1 * input - s.a1 * output + s2, s2});
    input = output;
  }
  Index at = first;
  for (Index i = 0; i < signal.size(); ++i, at += step) {
    double value = signal[at];
    for (std::size_t k = 0; k < filter.size(); ++k) {
      const SecondOrderSection& s = filter[k];
      State& state = states[k];
      const double output = s.b0 * value + state.s1;
      state.s1 = s.b1 * value - s.a1 * output + state.s2;
      state.s2 = s.b2 * value - s.a2 * output;
      value = output;
    }
    signal[at] = value;
  }
}

Vector extend(const Eigen::Ref<const Vector>& signal, const Padding& padding) {
  const Index n = signal.size(), pad = padding.samples;
  const double first = signal[0], last = signal[n - 1];
  Vector extended(n + 2 * pad);
  extended.segment(pad, n) = signal;
  for (Index i = 1; i <= pad; ++i) {
    double& before = extended[pad - i];
    double& after = extended[pad + n - 1 + i];
    switch (padding.extension) {
      case Extension::odd:
        before = 2.0 * first - signal[i];
        after = 2.0 * last - signal[n - 1 - i];
        break;
      case Extension::even:
        before = signal[i];
        after = signal[n - 1 - i];
        break;
      case Extension::constant:
        before = first;
        after = last;
        break;
    }
  }
  return extended;
}

}  // namespace

Result<Matrix> filter_zero_phase(const SectionCascade& filter, const Matrix& signals, const Padding& padding) {
  if (signals.rows() <= padding.samples) {
    return bad_data(fmt::format("{} samples are too few for zero-phase filtering with a padding of {}", signals.rows(),
                                padding.samples),
                    "take a longer window");
  }
  Matrix filtered(signals.rows(), signals.cols());
  for (Index column = 0; column < signals.cols(); ++column) {
    Vector work = extend(signals.col(column), padding);
    filter_from_steady_state(filter, work, 0, +1);
    filter_from_steady_state(filter, work, work.size() - 1, -1);
    filtered.col(column) = work.segment(padding.samples, signals.rows());
  }
  return filtered;
}

}  // namespace mbk::dsp
