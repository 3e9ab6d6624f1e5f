#include "mbk/measure/explore/emg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/dsp/zero_phase.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::explore {
namespace {

constexpr double kMinEmgRate = 300.0;   ///< [Hz]
constexpr double kBelowNyquist = 0.9;   ///< where the band ends, of the Nyquist frequency
constexpr std::size_t kFewLevels = 32;  ///< 5 bits
constexpr Index kClippedRun = 3;        ///< [samples]
constexpr Index kClippedRuns = 2;
constexpr double kHumShare = 0.05;        ///< of the power in the band
constexpr double kSlowEdge = 1.0;         ///< [Hz] below it is offset and drift
constexpr double kArtefactEdge = 20.0;    ///< [Hz]
constexpr double kEnvelopeShare = 100.0;  ///< slow power over that in the band: no EMG is left
constexpr double kWeakShare = 0.1;        ///< of the median root mean square
constexpr int kEnvelopeOrder = 4;

/// The cut-off of each pass, so that two passes of `order`/2 have half the power at `edge`.
/// @param power +1 for a low-pass, −1 for a high-pass
Hertz cutoff_of_pass(double edge, int order, double power, double rate) {
  const double moved = std::pow(std::numbers::sqrt2 - 1.0, -power / order);
  return Hertz(rate / std::numbers::pi * std::atan(std::tan(std::numbers::pi * edge / rate) * moved));
}

Result<Vector> filtered(const Vector& signal, const dsp::SectionCascade& cascade, double slowest, double rate) {
  constexpr double kPeriods = 2.0;
  const auto padding = std::min<Index>(std::llround(kPeriods * rate / slowest), signal.size() - 1);
  const auto result =
      MBK_TRY(dsp::filter_zero_phase(cascade, signal, {dsp::Extension::odd, std::max<Index>(padding, 1)}));
  return Vector(result.col(0));
}

struct Hum {
  double frequency = 0, share = 0;
};

double power_between(const dsp::Spectrum& spectrum, double low, double high) {
  double power = 0.0;
  for (Index k = 0; k < spectrum.frequency.size(); ++k) {
    if (spectrum.frequency[k] >= low && spectrum.frequency[k] <= high) power += spectrum.density[k];
  }
  return power;
}

/// Power at the mains frequency and its harmonics above that of the neighbours, as a share of the power in the band.
Hum hum_at(const dsp::Spectrum& spectrum, double mains, const EmgProcessing& how, double band_power) {
  constexpr double kLine = 1.5, kNear = 3.0, kFar = 8.0;  // [Hz]
  double excess = 0.0;
  for (double line = mains; line < how.high_hz; line += mains) {
    double power = 0.0;
    Index lines = 0;
    std::vector<double> beside;
    for (Index k = 0; k < spectrum.frequency.size(); ++k) {
      const double away = std::abs(spectrum.frequency[k] - line);
      if (away <= kLine) {
        power += spectrum.density[k];
        ++lines;
      } else if (away >= kNear && away <= kFar) {
        beside.push_back(spectrum.density[k]);
      }
    }
    if (lines > 0 && !beside.empty()) {
      excess += std::max(0.0, power - static_cast<double>(lines) * numeric::median(std::move(beside)));
    }
  }
  return {mains, band_power > 0.0 ? excess / band_power : 0.0};
}

Index clipped_runs(const Vector& raw) {
  const double low = raw.minCoeff(), high = raw.maxCoeff();
  Index runs = 0, length = 0;
  for (Index i = 0; i < raw.size(); ++i) {
    const bool same = i > 0 && raw[i] == raw[i - 1];
    const bool extreme = raw[i] == low || raw[i] == high;
    length = extreme ? (same ? length + 1 : 1) : 0;
    if (length == kClippedRun) ++runs;
  }
  return runs;
}

/// Raw EMG is as often below its mean as above it, also with an offset.
bool is_rectified(const Vector& raw) {
  constexpr double kSkewed = 0.5;
  if (raw.minCoeff() < 0.0) return false;
  const Eigen::ArrayXd centred = raw.array() - raw.mean();
  const double variance = centred.square().mean();
  return centred.cube().mean() > kSkewed * std::pow(variance, 1.5);
}

std::size_t levels_up_to(const Vector& raw, std::size_t most) {
  std::set<double> levels;
  for (const double value : raw) {
    levels.insert(value);
    if (levels.size() >= most) break;
  }
  return levels.size();
}

}  // namespace

Result<EmgProcessing> emg_processing_at(Hertz rate, const EmgProcessing& wanted) {
  if (!(wanted.low_hz > 0.0 && wanted.high_hz > wanted.low_hz)) {
    return bad_usage(fmt::format("the EMG band {:g} to {:g} Hz is empty", wanted.low_hz, wanted.high_hz),
                     "choose 20,450");
  }
  if ((wanted.envelope_hz > 0.0) == (wanted.envelope_rms_s > 0.0)) {
    return bad_usage("the EMG envelope needs a low-pass or an RMS window, and not both");
  }
  if (!(rate.value >= kMinEmgRate)) {
    return bad_data(fmt::format("EMG at {:g} Hz: at least {:g} Hz are needed", rate.value, kMinEmgRate),
                    "record EMG at 1000 Hz or more, or open the file at the rate of its EMG");
  }
  EmgProcessing how = wanted;
  how.rate_hz = rate.value;
  const double nyquist = 0.5 * rate.value;
  if (how.high_hz >= nyquist) how.high_hz = kBelowNyquist * nyquist;
  if (how.low_hz >= how.high_hz) {
    return bad_data(
        fmt::format("the EMG band begins at {:g} Hz, above what a rate of {:g} Hz contains", how.low_hz, rate.value));
  }
  if (how.envelope_hz >= nyquist) {
    return bad_usage(
        fmt::format("the EMG envelope's low-pass of {:g} Hz is not below Nyquist {:g} Hz", how.envelope_hz, nyquist));
  }
  return how;
}

Result<Vector> emg_band(const Vector& raw, const EmgProcessing& how) {
  if (how.order < 2 || how.order % 2 != 0) {
    return bad_usage(fmt::format("order {} of a zero-phase filter is not even", how.order));
  }
  const Hertz rate(how.rate_hz);
  const int pass = how.order / 2;
  auto cascade =
      MBK_TRY(dsp::butterworth_highpass(pass, cutoff_of_pass(how.low_hz, how.order, -1.0, how.rate_hz), rate));
  const auto low =
      MBK_TRY(dsp::butterworth_lowpass(pass, cutoff_of_pass(how.high_hz, how.order, 1.0, how.rate_hz), rate));
  cascade.insert(cascade.end(), low.begin(), low.end());
  return filtered(raw, cascade, how.low_hz, how.rate_hz);
}

Vector running_sums(const Vector& values) {
  Vector sums(values.size() + 1);
  sums[0] = 0.0;
  for (Index i = 0; i < values.size(); ++i) sums[i + 1] = sums[i] + values[i];
  return sums;
}

Result<Vector> emg_envelope(const Vector& rectified, const EmgProcessing& how) {
  if (how.envelope_rms_s > 0.0) {
    const Index n = rectified.size(), half = std::max<Index>(std::llround(0.5 * how.envelope_rms_s * how.rate_hz), 1);
    const Vector sums = running_sums(rectified.cwiseAbs2());
    Vector envelope(n);
    for (Index i = 0; i < n; ++i) {
      const Index from = std::max<Index>(i - half, 0), to = std::min<Index>(i + half + 1, n);
      envelope[i] = std::sqrt(std::max(0.0, (sums[to] - sums[from]) / static_cast<double>(to - from)));
    }
    return envelope;
  }
  const auto lowpass = MBK_TRY(dsp::butterworth_lowpass(
      kEnvelopeOrder / 2, cutoff_of_pass(how.envelope_hz, kEnvelopeOrder, 1.0, how.rate_hz), Hertz(how.rate_hz)));
  return filtered(rectified, lowpass, how.envelope_hz, how.rate_hz);
}

std::vector<EmgFinding> check_emg(const Vector& raw, const EmgProcessing& how) {
  std::vector<EmgFinding> found;
  if (!raw.allFinite()) {
    const auto missing = raw.size() - raw.array().isFinite().count();
    found.push_back({EmgProblem::not_finite, fmt::format("{} of {} samples are missing", missing, raw.size()),
                     "choose an interval without gaps with --from and --to, or repair the recording", false});
    return found;
  }
  const std::size_t levels = levels_up_to(raw, kFewLevels);
  if (levels < 2) {
    found.push_back({EmgProblem::constant, "the signal never changes", "check electrode, cable and channel", false});
    return found;
  }
  if (levels < kFewLevels) {
    found.push_back({EmgProblem::few_levels,
                     fmt::format("the signal has only {} different values; at least {} are needed", levels, kFewLevels),
                     "raise the amplifier's gain, or check electrode and cable", false});
    return found;
  }
  if (is_rectified(raw)) {
    found.push_back({EmgProblem::rectified, "the signal is never negative: it is rectified, or an envelope",
                     "use the raw signal: mbk filters and rectifies it itself", false});
    return found;
  }
  if (const Index runs = clipped_runs(raw); runs >= kClippedRuns) {
    found.push_back({EmgProblem::clipping,
                     fmt::format("the signal stays at its extreme values {} times, for {} samples or more: amplitudes "
                                 "are too small",
                                 runs, kClippedRun),
                     "lower the amplifier's gain"});
  }
  const auto spectrum = dsp::welch(raw, Hertz(how.rate_hz), Hertz(0.5));
  if (!spectrum) return found;
  const double band = power_between(*spectrum, how.low_hz, how.high_hz);
  const Hum fifty = hum_at(*spectrum, 50.0, how, band), sixty = hum_at(*spectrum, 60.0, how, band);
  if (const Hum& hum = fifty.share >= sixty.share ? fifty : sixty; hum.share > kHumShare) {
    found.push_back({EmgProblem::mains_hum,
                     fmt::format("{:.0f} % of the power in the band is at {:.0f} Hz and its harmonics; limit {:.0f} %",
                                 100.0 * hum.share, hum.frequency, 100.0 * kHumShare),
                     "check the reference electrode and the shielding"});
    found.back().frequency = hum.frequency;
  }
  const double slow = power_between(*spectrum, kSlowEdge, kArtefactEdge);
  if (slow > band) {
    const bool envelope = slow > kEnvelopeShare * band;
    found.push_back({EmgProblem::movement_artefact,
                     fmt::format("the power between {:g} and {:g} Hz is {:.1f} times that in the band; limit 1",
                                 kSlowEdge, kArtefactEdge, slow / band),
                     envelope ? "record raw EMG; this looks like an envelope" : "fasten electrodes and cables",
                     !envelope});
  }
  return found;
}

std::vector<bool> weak_channels(const std::vector<double>& rms) {
  std::vector<bool> weak(rms.size(), false);
  std::vector<double> finite;
  std::ranges::copy_if(rms, std::back_inserter(finite), [](double one) { return std::isfinite(one); });
  if (finite.size() < 3) return weak;
  const double limit = kWeakShare * numeric::median(finite);
  for (std::size_t k = 0; k < rms.size(); ++k) weak[k] = rms[k] < limit;
  return weak;
}

}  // namespace mbk::explore
