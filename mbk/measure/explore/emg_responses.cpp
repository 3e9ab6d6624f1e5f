#include "mbk/measure/explore/emg_responses.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/units.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/explore/emg.h"

namespace mbk::explore {
namespace {

constexpr double kStepWithin = 0.15;  ///< [s] after an onset, where its largest displacement is looked for
constexpr double kLag = 0.01;         ///< [s] over which a displacement says that it moves
constexpr double kMoves = 0.2;        ///< of the largest such displacement
constexpr double kNoiseDeviations = 6.0;
constexpr double kMinThreshold = 0.002;  ///< of the displacement
constexpr Index kMinEmgTrials = 5;
constexpr double kSoonest = 0.01;  ///< [s] no reflex of a limb is faster
constexpr int kReplicates = 1000;
constexpr double kTail = 0.025;            ///< of the bootstrap at each end of an interval
constexpr double kMinDeviation = 1e-3;     ///< of a replicate, of that of the trials: all its trials may be one
constexpr double kFamilyLevel = 0.03;      ///< of all windows of a direction together: 1 % in each of three
constexpr double kAfterWindow = 0.01;      ///< [s] data after the window that the change points are fitted to
constexpr double kShortestLevel = 0.005;   ///< [s]
constexpr double kSameDirection = 0.9659;  ///< cos 15°
constexpr double kCurveStep = 0.001;       ///< [s]

Index emg_samples(double seconds, double sample_time) {
  return static_cast<Index>(std::llround(seconds / sample_time));
}

/// The largest displacement from a place in the moment after an onset.
Vector largest_step(const Matrix& signal, const Vector& from, Index onset, double sample_time) {
  Vector step = Vector::Zero(signal.cols());
  const Index end = std::min(onset + emg_samples(kStepWithin, sample_time), signal.rows());
  for (Index i = onset; i < end; ++i) {
    const Vector away = signal.row(i).transpose() - from;
    if (away.squaredNorm() > step.squaredNorm()) step = away;
  }
  return step;
}

/// The last sample at or before `peak` that is not above the threshold.
double crossing(const Vector& along, Index peak, double threshold) {
  Index i = peak;
  while (i > 0 && along[i] > threshold) --i;
  const double rise = along[i + 1] - along[i];
  return static_cast<double>(i) + (rise > 0.0 ? std::clamp((threshold - along[i]) / rise, 0.0, 1.0) : 1.0);
}

Interval percentiles(Vector replicates, double tail) {
  std::sort(replicates.begin(), replicates.end());
  return {numeric::quantile(replicates, tail), numeric::quantile(replicates, 1.0 - tail)};
}

/// Weights of the trials in each replicate, B×G; each row adds up to 1.
Matrix bootstrap_weights(Index trials, std::uint64_t seed) {
  numeric::Random random(seed);
  Matrix weights = Matrix::Zero(kReplicates, trials);
  for (Index b = 0; b < kReplicates; ++b) {
    for (Index g = 0; g < trials; ++g) {
      weights(b, static_cast<Index>(random.below(static_cast<std::uint64_t>(trials)))) +=
          1.0 / static_cast<double>(trials);
    }
  }
  return weights;
}

EmgWindowResponse window_response(const Vector& window, const Vector& background, const Matrix& weights,
                                  std::size_t windows) {
  const Index trials = window.size();
  const double w = window.mean(), b = background.mean();
  EmgWindowResponse found;
  found.ratio = w / b;
  // Bootstrap-t of ln r, whose variance over trials is that of w_g/w − b_g/b.
  const Vector ws = weights * window, bs = weights * background;
  const auto deviation = [](double ww, double wb, double bb, double mean_w, double mean_b) {
    return std::sqrt(std::max(0.0, ww / (mean_w * mean_w) - 2.0 * wb / (mean_w * mean_b) + bb / (mean_b * mean_b)));
  };
  const auto count = static_cast<double>(trials);
  const double own =
      deviation(window.squaredNorm() / count, window.dot(background) / count, background.squaredNorm() / count, w, b);
  const Vector ww = weights * window.cwiseAbs2(), wb = weights * window.cwiseProduct(background),
               bb = weights * background.cwiseAbs2();
  Vector t(weights.rows());
  for (Index k = 0; k < t.size(); ++k) {
    t[k] = std::log(ws[k] / bs[k] / found.ratio) /
           std::max(deviation(ww[k], wb[k], bb[k], ws[k], bs[k]), kMinDeviation * own);
  }
  const Interval ends = percentiles(std::move(t), kTail);
  found.interval95 = {found.ratio * std::exp(-ends.second * own), found.ratio * std::exp(-ends.first * own)};
  const Vector difference = window - background;
  const double error = std::sqrt(numeric::variance(difference) / count);
  const double quantile =
      numeric::student_quantile(1.0 - 0.5 * kFamilyLevel / static_cast<double>(windows), static_cast<int>(trials) - 1);
  if (std::abs(w - b) > quantile * error) {
    found.response = found.ratio > 1.0 ? EmgChange::increase : EmgChange::decrease;
  }
  return found;
}

struct ChangePoints {
  Index on = 0, off = 0;
};

/// −n ln(mean) of n values whose sum is given.
double level_likelihood(double sum, Index n) {
  return n == 0 ? 0.0 : -static_cast<double>(n) * std::log(std::max(sum, 1e-300) / static_cast<double>(n));
}

/// The rise before `off`, or none where no level after it would be higher.
std::optional<Index> rise_before(const Vector& sums, Index first, Index last, Index off) {
  std::optional<Index> best;
  double largest = -kInfinity;
  for (Index k = first; k <= last; ++k) {
    const double before = sums[k], after = sums[off] - sums[k];
    if (after * static_cast<double>(k) <= before * static_cast<double>(off - k)) continue;
    const double likelihood = level_likelihood(before, k) + level_likelihood(after, off - k);
    if (likelihood <= largest) continue;
    largest = likelihood;
    best = k;
  }
  return best;
}

std::optional<ChangePoints> change_points(const Vector& sums, Index first, Index last, Index shortest) {
  const Index rows = sums.size() - 1;
  std::optional<ChangePoints> best;
  double largest = -kInfinity;
  for (Index off = first + shortest; off <= rows; ++off) {
    if (off < rows && rows - off < shortest) continue;
    const auto on = rise_before(sums, first, std::min(last, off - shortest), off);
    if (!on) continue;
    const double level = (sums[off] - sums[*on]) / static_cast<double>(off - *on);
    if (sums[rows] - sums[off] > level * static_cast<double>(rows - off)) continue;  // the rise would be at `off`
    const double likelihood = level_likelihood(sums[*on], *on) + level_likelihood(sums[off] - sums[*on], off - *on) +
                              level_likelihood(sums[rows] - sums[off], rows - off);
    if (likelihood <= largest) continue;
    largest = likelihood;
    best = ChangePoints{*on, off};
  }
  return best;
}

/// @param end_s  of the window in which the response was seen
std::optional<EmgLatency> latency_of(const Matrix& rectified, const Matrix& weights, Index onset, double end_s,
                                     double sample_time, std::uint64_t seed) {
  const Index last = onset + emg_samples(end_s, sample_time);
  const Index rows = std::min(last + emg_samples(kAfterWindow, sample_time), rectified.rows());
  const Index shortest = std::max<Index>(emg_samples(kShortestLevel, sample_time), 2);
  const Matrix epochs = rectified.topRows(rows);
  const auto at =
      change_points(running_sums(epochs.rowwise().mean()), onset, std::min(last, rows - shortest), shortest);
  if (!at) return {};
  const auto seconds = [&](double row) { return (row - 0.5 - static_cast<double>(onset)) * sample_time; };
  const Matrix means = epochs * weights.transpose();  // N×B
  numeric::Random random(seed, 1);
  Vector replicates(weights.rows());
  Index count = 0;
  for (Index b = 0; b < weights.rows(); ++b) {
    const auto on = rise_before(running_sums(means.col(b)), onset, std::min(last, at->off - shortest), at->off);
    if (on) replicates[count++] = seconds(static_cast<double>(*on) + random.uniform(-0.5, 0.5));
  }
  if (2 * count < weights.rows()) return {};
  replicates.conservativeResize(count);
  EmgLatency latency{seconds(static_cast<double>(at->on)), percentiles(replicates, kTail)};
  return latency;
}

Result<void> check_windows(const EmgOptions& options) {
  const std::vector<double>& edges = options.edges_s;
  const bool rising = std::ranges::adjacent_find(edges, std::greater_equal<>()) == edges.end();
  if (edges.size() < 2 || !rising || !(edges.front() >= 0.0) || !(options.background_s > 0.0)) {
    return bad_usage("the windows of EMG responses need two or more rising times after the onset",
                     "choose 20,50,100,150 (ms)");
  }
  return {};
}

std::vector<EmgWindow> named_windows(const std::vector<double>& edges) {
  static constexpr const char* kNames[] = {"short latency", "long latency", "voluntary"};
  std::vector<EmgWindow> windows;
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    windows.push_back({edges.size() == 4
                           ? kNames[k]
                           : fmt::format("{:g} to {:g} ms", kMilliseconds * edges[k], kMilliseconds * edges[k + 1]),
                       edges[k], edges[k + 1]});
  }
  return windows;
}

/// Rows of an epoch.
struct EpochRows {
  Index before = 0, after = 0;
  [[nodiscard]] Index all() const { return before + after; }
};

EpochRows epoch_rows(const EmgOptions& options, double sample_time) {
  return {emg_samples(options.background_s, sample_time),
          emg_samples(options.edges_s.back() + kAfterWindow, sample_time)};
}

/// An epoch: which recording, where, and of which direction.
struct Epoch {
  std::size_t recording = 0;
  Index onset = 0;
  std::size_t direction = 0;
};

/// The epochs of all recordings; directions and counts of the estimate are filled in.
std::vector<Epoch> epochs_of(std::span<const EmgRecording> recordings, const EpochRows& rows, EmgEstimate& found) {
  std::vector<Epoch> epochs;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    Index before = -rows.all();
    for (const Onset& onset : recordings[r].onsets) {
      const Index since = onset.sample - std::exchange(before, onset.sample);
      const double size = onset.step.norm();
      if (onset.sample < rows.before || onset.sample + rows.after > recordings[r].recording->samples() ||
          since < rows.all() || !(size > 0.0)) {
        ++found.omitted;
        continue;
      }
      const Vector unit = onset.step / size;
      auto direction = std::ranges::find_if(
          found.directions, [&](const EmgDirection& one) { return one.direction.dot(unit) > kSameDirection; });
      if (direction == found.directions.end()) {
        found.directions.push_back({unit, 0, size, size});
        direction = std::prev(found.directions.end());
      }
      ++direction->trials;
      direction->smallest = std::min(direction->smallest, size);
      direction->largest = std::max(direction->largest, size);
      epochs.push_back({r, onset.sample, static_cast<std::size_t>(direction - found.directions.begin())});
    }
  }
  found.onsets = static_cast<Index>(epochs.size());
  return epochs;
}

/// One channel: checks, band, rectified, epochs, responses.
class ChannelResponses {
 public:
  ChannelResponses(std::span<const EmgRecording> recordings, std::span<const Epoch> epochs, const EmgEstimate& all,
                   const EmgOptions& options)
      : recordings_(recordings),
        epochs_(epochs),
        all_(all),
        options_(options),
        sample_time_(1.0 / all.processing.rate_hz),
        rows_(epoch_rows(options, sample_time_)) {}

  /// @param rms  root mean square in the band [V]; NaN if the channel is not usable
  Result<EmgChannelEstimate> of(const std::string& name, std::uint64_t seed, double& rms) const {
    EmgChannelEstimate channel;
    channel.name = name;
    if (const auto mvc = options_.mvc.find(name); mvc != options_.mvc.end()) channel.mvc = mvc->second;
    const auto count = static_cast<Index>(epochs_.size());
    Matrix band(rows_.all(), count), envelope(all_.curve_time.size(), count);
    const auto every = std::max<Index>(emg_samples(kCurveStep, sample_time_), 1);
    double square = 0.0, samples = 0.0;
    rms = kNaN;
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      const Vector& raw = recordings_[r].recording->find(name)->values;
      for (EmgFinding& finding : check_emg(raw, all_.processing)) {
        channel.usable = channel.usable && finding.usable;
        finding.recording = static_cast<int>(r);
        channel.findings.push_back(std::move(finding));
      }
      if (!channel.usable) return channel;
      Vector signal = MBK_TRY(emg_band(raw, all_.processing));
      square += signal.squaredNorm();
      samples += static_cast<double>(signal.size());
      for (std::size_t e = 0; e < epochs_.size(); ++e) {
        if (epochs_[e].recording != r) continue;
        band.col(static_cast<Index>(e)) = signal.segment(epochs_[e].onset - rows_.before, rows_.all());
      }
      signal = signal.cwiseAbs().eval();
      const auto smooth = MBK_TRY(emg_envelope(signal, all_.processing));
      for (std::size_t e = 0; e < epochs_.size(); ++e) {
        if (epochs_[e].recording != r) continue;
        const auto column = static_cast<Index>(e);
        const Index first = epochs_[e].onset - rows_.before;
        for (Index k = 0; k < envelope.rows(); ++k) envelope(k, column) = smooth[first + k * every];
      }
    }
    rms = std::sqrt(square / samples);
    channel.background = band.topRows(rows_.before).cwiseAbs().mean();
    for (std::size_t d = 0; d < all_.directions.size(); ++d) {
      if (all_.directions[d].trials < kMinEmgTrials) continue;
      std::vector<Index> columns;
      for (std::size_t e = 0; e < epochs_.size(); ++e) {
        if (epochs_[e].direction == d) columns.push_back(static_cast<Index>(e));
      }
      const Matrix signals = band(Eigen::all, columns), own = signals.cwiseAbs();
      if (auto finding = artefact_in(signals)) {
        channel.findings.push_back(std::move(*finding));
        channel.usable = false;
        channel.directions.clear();
        return channel;
      }
      auto response = MBK_TRY(emg_response(own, sample_time_, options_, seed + d));
      EmgDirectionResponse direction;
      direction.direction = all_.directions[d].direction;
      direction.trials = all_.directions[d].trials;
      direction.background = own.topRows(rows_.before).mean();
      direction.curve = envelope(Eigen::all, columns).rowwise().mean();
      direction.windows = std::move(response.windows);
      direction.latency = response.latency;
      if (direction.latency && direction.latency->value < kSoonest) {
        channel.findings.push_back(
            {EmgProblem::too_early,
             fmt::format("EMG changes {:.1f} ms after the onset, sooner than any reflex ({:.0f} ms): an artefact of "
                         "motor or motion, or the clocks of EMG and motion differ",
                         kMilliseconds * direction.latency->value, kMilliseconds * kSoonest),
             "check cables and clocks", false});
        channel.usable = false;
        channel.directions.clear();
        return channel;
      }
      if (direction.latency && direction.latency->interval95.first < kSoonest) direction.latency.reset();
      channel.directions.push_back(std::move(direction));
    }
    return channel;
  }

 private:
  /// EMG has a random phase, so that the mean over trials of the signed signal vanishes; an artefact's does not.
  /// @param signals  in the band, rows × trials
  [[nodiscard]] std::optional<EmgFinding> artefact_in(const Matrix& signals) const {
    constexpr double kAround = 0.01;  // [s] before and after the onset
    constexpr double kChance = 1e-5;
    const Index half = emg_samples(kAround, sample_time_), first = std::max<Index>(rows_.before - half, 0);
    const auto trials = static_cast<double>(signals.cols());
    const double background = signals.topRows(first).cwiseAbs().mean();
    const double limit = numeric::student_quantile(1.0 - kChance, static_cast<int>(signals.cols()) - 1);
    for (Index row = first; row < std::min(rows_.before + half, signals.rows()); ++row) {
      const double mean = signals.row(row).mean();
      const double error = std::sqrt((signals.row(row).array() - mean).square().sum() / (trials * (trials - 1.0)));
      if (!(std::abs(mean) > limit * error && std::abs(mean) > background)) continue;
      return EmgFinding{EmgProblem::artefact,
                        fmt::format("{:.1f} ms after the onset the mean of the signed signal over {} perturbations is "
                                    "{:.1f} times the background, as that of EMG cannot be: an artefact",
                                    kMilliseconds * static_cast<double>(row - rows_.before) * sample_time_,
                                    signals.cols(), std::abs(mean) / background),
                        "separate the cables of EMG from motor and stimulator", false};
    }
    return std::nullopt;
  }

  std::span<const EmgRecording> recordings_;
  std::span<const Epoch> epochs_;
  const EmgEstimate& all_;
  const EmgOptions& options_;
  double sample_time_;
  EpochRows rows_;
};

}  // namespace

std::vector<Onset> motion_onsets(const Matrix& position, double sample_time, Index rest) {
  std::vector<Onset> onsets;
  const Index rows = position.rows(), lag = std::max<Index>(emg_samples(kLag, sample_time), 1);
  if (rows <= rest + lag) return onsets;
  const Vector moved = (position.bottomRows(rows - lag) - position.topRows(rows - lag)).rowwise().norm();
  const double least = kMoves * moved.maxCoeff();
  if (!(least > 0.0)) return onsets;
  Index rested = 0;
  for (Index i = 0; i < moved.size(); ++i) {
    if (moved[i] <= least) {
      ++rested;
      continue;
    }
    if (std::exchange(rested, 0) < rest || i < rest) continue;
    const auto before =
        position.middleRows(i - rest, rest - std::min(rest / 4, lag));  // `moved` looks ahead by the lag
    const Vector mean = before.colwise().mean();
    const double noise =
        std::sqrt((before.rowwise() - mean.transpose()).squaredNorm() / static_cast<double>(before.rows()));
    const Vector step = largest_step(position, mean, i, sample_time);
    const double size = step.norm();
    const Vector along =
        (position.middleRows(i - rest, std::min(rest + 2 * lag, rows - i + rest)).rowwise() - mean.transpose()) *
        (step / size);
    const double threshold = std::max(kNoiseDeviations * noise, kMinThreshold * size);
    const Index peak = std::min(rest + lag, along.size() - 2);
    if (along[peak] <= 4.0 * threshold) continue;  // not distinguishable from the noise of the rest
    const double first = crossing(along, peak, threshold), fourth = crossing(along, peak, 4.0 * threshold);
    onsets.push_back({i - rest + static_cast<Index>(std::llround(std::max(0.0, 2.0 * first - fourth))), step});
  }
  return onsets;
}

std::vector<Onset> perturbation_onsets(const ExplorationTrial& trial, Index rest) {
  if (trial.reference.size() == 0) return motion_onsets(trial.input, trial.sample_time, rest);
  auto onsets = reference_onsets(trial.reference, rest);
  for (Onset& onset : onsets) {
    onset.step = largest_step(trial.reference, trial.reference.row(onset.sample - 1).transpose(), onset.sample,
                              trial.sample_time);
  }
  return onsets;
}

Result<EmgResponse> emg_response(const Matrix& rectified, double sample_time, const EmgOptions& options,
                                 std::uint64_t seed) {
  MBK_TRY(check_windows(options));
  const Index trials = rectified.cols(), onset = emg_samples(options.background_s, sample_time);
  if (trials < kMinEmgTrials) {
    return bad_data(fmt::format("{} perturbations in one direction; at least {} are needed", trials, kMinEmgTrials));
  }
  const Vector background = rectified.topRows(onset).colwise().mean().transpose();
  if (!(background.mean() > 0.0)) return bad_data("there is no EMG before the onsets");
  const Matrix weights = bootstrap_weights(trials, seed);
  EmgResponse found;
  const std::size_t windows = options.edges_s.size() - 1;
  std::optional<double> first_end;
  for (std::size_t k = 0; k < windows; ++k) {
    const Index from = onset + emg_samples(options.edges_s[k], sample_time),
                to = onset + emg_samples(options.edges_s[k + 1], sample_time);
    if (to <= from || to > rectified.rows()) return bad_usage("a window of EMG responses is shorter than a sample");
    const Vector window = rectified.middleRows(from, to - from).colwise().mean().transpose();
    found.windows.push_back(window_response(window, background, weights, windows));
    if (!first_end && found.windows.back().response == EmgChange::increase) first_end = options.edges_s[k + 1];
  }
  if (first_end) found.latency = latency_of(rectified, weights, onset, *first_end, sample_time, seed);
  return found;
}

bool is_emg(const Channel& channel) {
  return channel.name == "emg" || channel.name.starts_with("emg_");
}

std::string emg_channel_of(const std::string& muscle) {
  return is_emg({.name = muscle}) ? muscle : "emg_" + muscle;
}

Result<EmgEstimate> emg_responses(std::span<const EmgRecording> recordings, double sample_time,
                                  const EmgOptions& options) {
  MBK_TRY(check_windows(options));
  EmgEstimate found;
  auto how = MBK_TRY(emg_processing_at(Hertz(1.0 / sample_time), options.processing));
  found.processing = how;
  if (how.high_hz < options.processing.high_hz) {
    found.notes.push_back(
        fmt::format("the sample rate of {:g} Hz is too low for a band up to {:g} Hz: it ends at {:g} Hz", how.rate_hz,
                    options.processing.high_hz, how.high_hz));
  }
  found.background_s = options.background_s;
  found.windows = named_windows(options.edges_s);
  std::vector<std::string> names;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    for (const Channel& channel : recordings[r].recording->channels) {
      if (!is_emg(channel) || std::ranges::find(names, channel.name) != names.end()) continue;
      if (std::ranges::all_of(recordings, [&](const EmgRecording& one) { return one.recording->find(channel.name); })) {
        names.push_back(channel.name);
      } else {
        found.notes.push_back(fmt::format("'{}' is not in every recording, so it is omitted", channel.name));
      }
    }
  }
  for (const auto& [muscle, volts] : options.mvc) {
    if (std::ranges::find(names, muscle) != names.end()) continue;
    return bad_usage(fmt::format("--mvc names {}, which is no EMG channel of these recordings", muscle),
                     fmt::format("the channels are {}", fmt::join(names, ", ")));
  }
  if (names.empty()) {
    return bad_data("there is no EMG channel", "record EMG, or name its columns emg_MUSCLE with --channels");
  }
  const EpochRows rows = epoch_rows(options, sample_time);
  const auto epochs = epochs_of(recordings, rows, found);
  if (std::ranges::none_of(found.directions, [](const EmgDirection& one) { return one.trials >= kMinEmgTrials; })) {
    return bad_data(
        fmt::format(
            "{} onsets of perturbations after {:.0f} ms of rest; at least {} in one direction are "
            "needed{}",
            found.onsets, kMilliseconds * options.background_s, kMinEmgTrials,
            found.omitted > 0 ? fmt::format(" ({} are too close to each other or to an end)", found.omitted) : ""),
        "perturb with steps, ramps or pulses, with pauses between them, or pool FILEs of one condition");
  }
  found.axes = static_cast<int>(found.directions.front().direction.size());
  const auto every = std::max<Index>(emg_samples(kCurveStep, sample_time), 1);
  found.curve_time.resize((rows.all() + every - 1) / every);
  for (Index k = 0; k < found.curve_time.size(); ++k) {
    found.curve_time[k] = static_cast<double>(k * every - rows.before) * sample_time;
  }
  const ChannelResponses responses(recordings, epochs, found, options);
  std::vector<EmgChannelEstimate> channels(names.size());
  std::vector<double> rms(names.size());
  MBK_TRY(numeric::parallel_for(static_cast<int>(names.size()), 2, [&](int k) -> Result<void> {
    const auto at = static_cast<std::size_t>(k);
    auto channel = responses.of(names[at], 1000 * at + 1, rms[at]);
    if (!channel) return tl::unexpected(channel.error().in(names[at]));
    channels[at] = std::move(*channel);
    channels[at].unit = recordings.front().recording->find(names[at])->unit;
    return {};
  }));
  const std::vector<bool> weak = weak_channels(rms);
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!weak[k]) continue;
    channels[k].findings.push_back({EmgProblem::weak,
                                    fmt::format("its amplitude in the band is {:.2g} V (RMS), below a tenth of the "
                                                "median channel",
                                                rms[k]),
                                    "check whether the electrode has contact"});
  }
  found.channels = std::move(channels);
  return found;
}

}  // namespace mbk::explore
