#include "mbk/base/dsp/zero_phase.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "mbk/base/dsp/causal_filter.h"

namespace mbk::dsp {
namespace {

constexpr Index kTogether = 4;  ///< signals: a section waits for its own last result, which those beside it need not
using Sample = Eigen::Array<double, kTogether, 1>;

/// Runs the cascade over the signals in place, from the steady state for a constant input equal to the first sample.
/// `step` is +1 for forward and −1 for backward.
void filter_from_steady_state(CausalFilterOf<Sample>& filter, std::vector<Sample>& signals, Index step) {
  Sample* const samples = step > 0 ? signals.data() : signals.data() + signals.size() - 1;
  filter.settle(*samples);
  for (Index i = 0; i < std::ssize(signals); ++i) samples[i * step] = filter.step(samples[i * step]);
}

/// The signals of so many columns from `first` on, side by side, continued beyond their ends; zeros beside them.
void extend(const Matrix& signals, Index first, const Padding& padding, std::vector<Sample>& extended) {
  const Index n = signals.rows(), pad = padding.samples, columns = std::min(kTogether, signals.cols() - first);
  extended.assign(static_cast<std::size_t>(n + 2 * pad), Sample::Zero());
  Sample* const x = extended.data() + pad;
  for (Index column = 0; column < columns; ++column) {
    for (Index i = 0; i < n; ++i) x[i][column] = signals(i, first + column);
  }
  for (Index i = 1; i <= pad; ++i) {
    Sample &before = x[-i], &after = x[n - 1 + i];
    switch (padding.extension) {
      case Extension::odd:
        before = 2.0 * x[0] - x[i];
        after = 2.0 * x[n - 1] - x[n - 1 - i];
        break;
      case Extension::even:
        before = x[i];
        after = x[n - 1 - i];
        break;
      case Extension::constant:
        before = x[0];
        after = x[n - 1];
        break;
    }
  }
}

}  // namespace

Result<Matrix> filter_zero_phase(const SectionCascade& filter, const Matrix& signals, const Padding& padding) {
  if (signals.rows() <= padding.samples) {
    return bad_data(fmt::format("{} samples are too few for zero-phase filtering with a padding of {}", signals.rows(),
                                padding.samples),
                    "use a longer interval");
  }
  Matrix filtered(signals.rows(), signals.cols());
  CausalFilterOf<Sample> running(filter);
  std::vector<Sample> work;
  for (Index first = 0; first < signals.cols(); first += kTogether) {
    extend(signals, first, padding, work);
    filter_from_steady_state(running, work, +1);
    filter_from_steady_state(running, work, -1);
    const Index columns = std::min(kTogether, signals.cols() - first);
    for (Index column = 0; column < columns; ++column) {
      for (Index i = 0; i < signals.rows(); ++i) {
        filtered(i, first + column) = work[static_cast<std::size_t>(padding.samples + i)][column];
      }
    }
  }
  return filtered;
}

}  // namespace mbk::dsp
