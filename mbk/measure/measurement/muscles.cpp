#include "mbk/measure/measurement/muscles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "mbk/measure/explore/emg.h"
#include "mbk/measure/explore/emg_responses.h"

namespace mbk::measurement {
namespace {

Result<Vector> raw_emg(const Recording& recording, const std::string& muscle) {
  if (const Channel* const channel = recording.find(muscle)) return channel->values;
  std::vector<std::string> names;
  for (const Channel& channel : recording.channels) {
    if (explore::is_emg(channel)) names.push_back(channel.name);
  }
  if (names.empty()) {
    return bad_data(fmt::format("'{}' is missing: no EMG was found", muscle),
                    "name EMG channels emg_MUSCLE, or say where they are with --channels emg_biceps=4:mV");
  }
  return bad_data(fmt::format("'{}' is missing; the EMG channels are {}", muscle, fmt::join(names, ", ")));
}

/// Two names of one signal, whose parts of the force nothing could separate.
Result<void> check_different(std::span<const ExplorationTrial> trials) {
  constexpr double kSame = 0.999;
  const Index muscles = trials.front().muscles.cols();
  for (Index a = 0; a < muscles; ++a) {
    for (Index b = 0; b < a; ++b) {
      double aa = 0.0, bb = 0.0, ab = 0.0;
      for (const ExplorationTrial& trial : trials) {
        const Vector one = trial.muscles.col(a), other = trial.muscles.col(b);
        aa += one.squaredNorm();
        bb += other.squaredNorm();
        ab += one.dot(other);
      }
      if (!(ab > kSame * std::sqrt(aa * bb))) continue;
      const auto& names = trials.front().muscle_names;
      return bad_data(fmt::format("{} and {} are the same signal", names[static_cast<std::size_t>(b)],
                                  names[static_cast<std::size_t>(a)]),
                      "check the map of channels, or name one of them");
    }
  }
  return {};
}

/// What makes amplitudes doubtful: another gain in one of the recordings, a maximal contraction in another unit.
/// @param scale  [V]
Result<void> check_amplitudes(std::span<ExplorationTrial> trials, Index column, double scale, bool mvc) {
  constexpr double kOtherGain = 4.0, kAboveMaximal = 1.5, kBelowMaximal = 1e-3;
  const std::string& name = trials.front().muscle_names[static_cast<std::size_t>(column)];
  double low = trials.front().muscles.col(column).mean(), high = low;
  for (const ExplorationTrial& trial : trials) {
    low = std::min(low, trial.muscles.col(column).mean());
    high = std::max(high, trial.muscles.col(column).mean());
  }
  if (mvc && high > kAboveMaximal * scale) {
    return bad_usage(fmt::format("the mean of {} is {:.3g} times its EMG of maximal contraction", name, high / scale),
                     "check the voltage of --mvc, in V, and the unit of the channel");
  }
  if (mvc && high < kBelowMaximal * scale) {
    trials.front().notes.push_back(
        fmt::format("the mean of {} is {:.2g} of its EMG of maximal contraction; check the voltage of --mvc, in V",
                    name, high / scale));
  }
  if (high > kOtherGain * low) {
    trials.front().notes.push_back(
        fmt::format("the mean of {} is {:.3g} times larger in one recording than in another; check that the gain of "
                    "the amplifier was the same",
                    name, high / low));
  }
  return {};
}

/// A schedule that drifts cannot be distinguished from time.
void note_drift(ExplorationTrial& trial) {
  constexpr double kDrifts = 0.7;
  const Eigen::ArrayXd value = trial.scheduling.array() - trial.scheduling.mean();
  const Eigen::ArrayXd time = Eigen::ArrayXd::LinSpaced(value.size(), -1.0, 1.0);
  const double correlation = (value * time).sum() / std::sqrt(value.square().sum() * time.square().sum());
  if (!(std::abs(correlation) > kDrifts)) return;
  trial.notes.push_back(
      fmt::format("{} changes with time (correlation {:.2f}), so that a limb that changes for another reason, and "
                  "fatigue, look the same",
                  trial.scheduling_label.name, correlation));
}

}  // namespace

Result<void> add_muscles(const Recording& recording, const std::vector<std::string>& muscles,
                         const EmgProcessing& processing, ExplorationTrial& trial) {
  if (muscles.empty()) return {};
  const auto how = MBK_TRY(explore::emg_processing_at(Hertz(1.0 / trial.sample_time), processing));
  trial.muscles.resize(trial.samples(), static_cast<Index>(muscles.size()));
  for (std::size_t k = 0; k < muscles.size(); ++k) {
    const auto raw = MBK_TRY(raw_emg(recording, muscles[k]));
    for (const EmgFinding& finding : explore::check_emg(raw, how)) {
      if (!finding.usable) return bad_data(fmt::format("{}: {}", muscles[k], finding.message), finding.remedy);
      trial.notes.push_back(fmt::format("{}: {}; {}", muscles[k], finding.message, finding.remedy));
    }
    const auto band = MBK_TRY(explore::emg_band(raw, how));
    trial.muscles.col(static_cast<Index>(k)) =
        band.segment(std::llround(trial.from_s / trial.sample_time), trial.samples()).cwiseAbs();
    trial.muscle_names.push_back(muscles[k]);
  }
  return {};
}

Result<void> scale_muscles(std::span<ExplorationTrial> trials, const std::map<std::string, double>& mvc,
                           const std::string& schedule, const EmgProcessing& processing) {
  if (trials.empty()) return {};
  const std::vector<std::string> names = trials.front().muscle_names;
  const bool both = schedule == kCoContraction;
  if (both && names.size() != 2) {
    return bad_usage("co-contraction needs two opposing muscles", "for example --muscles biceps,triceps");
  }
  if (names.empty()) return {};
  MBK_TRY(check_different(trials));
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto column = static_cast<Index>(k);
    double sum = 0.0, samples = 0.0;
    for (const ExplorationTrial& trial : trials) {
      sum += trial.muscles.col(column).sum();
      samples += static_cast<double>(trial.samples());
    }
    const auto known = mvc.find(names[k]);
    const double scale = known != mvc.end() ? known->second : sum / samples;
    MBK_TRY(check_amplitudes(trials, column, scale, known != mvc.end()));
    for (ExplorationTrial& trial : trials) {
      trial.muscles.col(column) /= scale;
      trial.muscle_units.emplace_back(known != mvc.end() ? "MVC" : "mean");
    }
  }
  const auto muscle = std::ranges::find(names, schedule);
  if (!both && muscle == names.end()) return {};
  const std::vector<std::string>& units = trials.front().muscle_units;
  if (both && units[0] != units[1]) {
    return bad_usage("--mvc is given for one of the two muscles only", "give it for both, or for none");
  }
  for (ExplorationTrial& trial : trials) {
    const auto how = MBK_TRY(explore::emg_processing_at(Hertz(1.0 / trial.sample_time), processing));
    Vector least;
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (!both && names[k] != schedule) continue;
      const auto envelope = MBK_TRY(explore::emg_envelope(trial.muscles.col(static_cast<Index>(k)), how));
      least = least.size() > 0 ? Vector(least.cwiseMin(envelope)) : envelope;
    }
    trial.scheduling = least.cwiseMax(0.0);  // a low-pass may swing below
    trial.scheduling_label = {both ? fmt::format("co-contraction of {} and {}", names[0], names[1]) : schedule,
                              trial.muscle_units[both ? 0 : static_cast<std::size_t>(muscle - names.begin())]};
    note_drift(trial);
  }
  return {};
}

}  // namespace mbk::measurement
