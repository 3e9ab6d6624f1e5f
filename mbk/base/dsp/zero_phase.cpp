#include "mbk/base/dsp/zero_phase.h"

#include <fmt/format.h>

#include "mbk/base/dsp/causal_filter.h"

namespace mbk::dsp {
namespace {

/// Runs the cascade over `signal` in place, from the steady state for a constant input equal to the first sample.
/// `step` is +1 for forward and −1 for backward.
void filter_from_steady_state(CausalFilter& filter, Vector& signal, Index first, Index step) {
  filter.settle(signal[first]);
  Index at = first;
  for (Index i = 0; i < signal.size(); ++i, at += step) signal[at] = filter.step(signal[at]);
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
  CausalFilter running(filter);
  for (Index column = 0; column < signals.cols(); ++column) {
    Vector work = extend(signals.col(column), padding);
    filter_from_steady_state(running, work, 0, +1);
    filter_from_steady_state(running, work, work.size() - 1, -1);
    filtered.col(column) = work.segment(padding.samples, signals.rows());
  }
  return filtered;
}

}  // namespace mbk::dsp
