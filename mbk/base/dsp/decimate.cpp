#include "mbk/base/dsp/decimate.h"

#include <fmt/format.h>

#include "mbk/base/dsp/zero_phase.h"

namespace mbk::dsp {

Result<Matrix> decimate(const Matrix& signals, Hertz sample_rate, Index every, Index first) {
  if (every < 1) return bad_usage(fmt::format("a decimation factor of {} is too small", every), "choose 1 or more");
  if (first < 0 || first >= signals.rows()) {
    return bad_usage(fmt::format("sample {} is not one of {}", first, signals.rows()), "choose an earlier one");
  }
  const Index count = (signals.rows() - first + every - 1) / every;
  const auto rows = Eigen::seqN(first, count, every);
  if (every == 1) return Matrix(signals(rows, Eigen::all));
  constexpr int kOrder = 8;
  const double nyquist = 0.5 * sample_rate.value / static_cast<double>(every);
  const auto lowpass = MBK_TRY(butterworth_lowpass(kOrder, Hertz(kDecimationCutoff * nyquist), sample_rate));
  constexpr Index kPeriods = 6;  // of the new clock, in which the filter forgets its ends
  const auto smooth = MBK_TRY(filter_zero_phase(lowpass, signals, {.samples = kPeriods * every}));
  return Matrix(smooth(rows, Eigen::all));
}

}  // namespace mbk::dsp
