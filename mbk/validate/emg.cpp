#include "mbk/measure/explore/emg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/causal_filter.h"
#include "mbk/base/numeric/random.h"
#include "mbk/measure/explore/emg_responses.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace emg_detail {

constexpr double kRate = 2000.0;                      ///< [Hz]
constexpr double kRatio = 2.0;                        ///< amplitude of the response over that of the background
constexpr double kBackground = 10e-6;                 ///< standard deviation [V]
constexpr double kGainSpread = 0.2;                   ///< of the logarithm of the amplitude, from trial to trial
constexpr double kBefore = 0.3, kAfter = 0.4;         ///< [s] around the onset; the filters need more than an epoch
constexpr double kEarliest = 0.025, kLatest = 0.045;  ///< of the response [s]
constexpr double kWithin = 3.0;                       ///< accepted error of a latency [ms]
constexpr std::array<int, 3> kTrials = {10, 20, 40};  ///< perturbations in a recording

struct Recorded {
  Matrix rectified;           ///< epochs
  std::vector<double> truth;  ///< ratio in each window
};

/// @param ratio  1: no response
Result<Recorded> recorded(int trials, double ratio, double latency, const explore::EmgOptions& options,
                          numeric::Random& random) {
  const Hertz rate(kRate);
  const auto how = MBK_TRY(explore::emg_processing_at(rate, options.processing));
  auto band = MBK_TRY(dsp::butterworth_highpass(4, Hertz(20.0), rate));
  const auto low = MBK_TRY(dsp::butterworth_lowpass(4, Hertz(450.0), rate));
  band.insert(band.end(), low.begin(), low.end());
  const auto samples = [](double seconds) { return static_cast<Index>(std::llround(kRate * seconds)); };
  const Index onset = samples(kBefore), all = onset + samples(kAfter);
  const Index first = onset - samples(options.background_s);
  Vector amplitude(all);
  for (Index i = 0; i < all; ++i) {
    amplitude[i] = kBackground * (static_cast<double>(i - onset) >= latency * kRate ? ratio : 1.0);
  }
  Recorded one;
  one.rectified.resize(samples(options.background_s + options.edges_s.back() + 0.05), trials);
  for (Index g = 0; g < trials; ++g) {
    dsp::CausalFilter filter(band);
    for (Index i = 0; i < samples(0.2); ++i) filter.step(random.normal());
    const double gain = std::exp(kGainSpread * random.normal());
    Vector raw(all);
    for (Index i = 0; i < all; ++i) raw[i] = gain * amplitude[i] * filter.step(random.normal());
    const auto filtered = MBK_TRY(explore::emg_band(raw, how));
    one.rectified.col(g) = filtered.cwiseAbs().segment(first, one.rectified.rows());
  }
  for (std::size_t k = 0; k + 1 < options.edges_s.size(); ++k) {
    const Index from = onset + samples(options.edges_s[k]), to = onset + samples(options.edges_s[k + 1]);
    one.truth.push_back(amplitude.segment(from, to - from).mean() / kBackground);
  }
  return one;
}

bool inside(const Interval& interval, double truth) {
  return interval.first <= truth && truth <= interval.second;
}

/// What one recording with a response and one without showed.
struct EmgRun {
  bool found = false, false_response = false, false_latency = false;
  std::optional<double> error_ms;  ///< of the latency
  bool latency_held = false;
  std::array<bool, 3> ratio_held = {};
};

Result<std::vector<EmgRun>> run_of(std::uint64_t seed) {
  const explore::EmgOptions options;
  numeric::Random random(seed, 62);
  std::vector<EmgRun> runs;
  for (const int trials : kTrials) {
    EmgRun run;
    const double latency = random.uniform(kEarliest, kLatest);
    const auto responding = MBK_TRY(recorded(trials, kRatio, latency, options, random));
    const auto found = MBK_TRY(explore::emg_response(responding.rectified, 1.0 / kRate, options, seed));
    const auto responds = [](const EmgWindowResponse& one) { return one.response != EmgChange::none; };
    run.found = std::ranges::any_of(found.windows, responds);
    if (found.latency) {
      run.error_ms = kMilliseconds * (found.latency->value - latency);
      run.latency_held = inside(found.latency->interval95, latency);
    }
    for (std::size_t k = 0; k < run.ratio_held.size(); ++k) {
      run.ratio_held[k] = inside(found.windows[k].interval95, responding.truth[k]);
    }
    const auto silent = MBK_TRY(recorded(trials, 1.0, latency, options, random));
    const auto nothing = MBK_TRY(explore::emg_response(silent.rectified, 1.0 / kRate, options, seed));
    run.false_response = std::ranges::any_of(nothing.windows, responds);
    run.false_latency = nothing.latency.has_value();
    runs.push_back(run);
  }
  return runs;
}

}  // namespace emg_detail

Result<ValidationTable> emg_study(const StudyOptions& options) {
  using namespace emg_detail;
  const auto runs = MBK_TRY(seeded_runs(options, run_of));
  ValidationTable table{"emg",
                        "are amplitude and latency of EMG responses correct, and is no response found where there is "
                        "none?",
                        "% of the recordings", options.runs, options.seed};
  for (std::size_t k = 0; k < kTrials.size(); ++k) {
    std::vector<EmgRun> own, timed;
    for (const auto& run : runs) {
      own.push_back(run[k]);
      if (run[k].error_ms) timed.push_back(run[k]);
    }
    const std::string name = fmt::format("{} trials: ", kTrials[k]);
    const auto share = [&](const char* what, const std::vector<EmgRun>& of, const Range& expected, const auto& is) {
      table.rows.push_back(share_row(name + what, of, is, expected));
    };
    share("response found", own, kNearlyAlways, [](const EmgRun& run) { return run.found; });
    Vector errors(static_cast<Index>(timed.size()));
    for (std::size_t i = 0; i < timed.size(); ++i) errors[static_cast<Index>(i)] = *timed[i].error_ms;
    table.rows.push_back(bias_row(name + "bias of the latency", errors, kWithin, "ms"));
    share("latency within 3 ms", timed, kNearlyAlways,
          [](const EmgRun& run) { return std::abs(*run.error_ms) <= kWithin; });
    share("latency inside its interval", timed, kNominal, [](const EmgRun& run) { return run.latency_held; });
    static constexpr std::array<const char*, 3> kNames = {"short-latency ratio inside its interval",
                                                          "long-latency ratio inside its interval",
                                                          "voluntary ratio inside its interval"};
    for (std::size_t w = 0; w < kNames.size(); ++w) {
      share(kNames[w], own, kNominal, [w](const EmgRun& run) { return run.ratio_held[w]; });
    }
    share("response found where there is none", own, kHardlyEver, [](const EmgRun& run) { return run.false_response; });
    share("latency found where there is no response", own, kHardlyEver,
          [](const EmgRun& run) { return run.false_latency; });
  }
  table.notes = {
      "Noise between 20 and 450 Hz at 2 kHz, whose amplitude doubles 25 to 45 ms after the onset and varies by 20 % "
      "from trial to trial. Windows: 20 to 50, 50 to 100 and 100 to 150 ms."};
  return table;
}

}  // namespace mbk::validation
