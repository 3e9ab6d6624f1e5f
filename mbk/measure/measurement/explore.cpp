#include "mbk/measure/measurement/explore.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <utility>
#include <vector>

#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/measure/explore/limb_signals.h"
#include "mbk/measure/explore/parallel_cascade.h"
#include "mbk/measure/preprocess/exploration_trial_of.h"
#include "mbk/measure/preprocess/force_delay.h"
#include "mbk/measure/preprocess/jittered_clock.h"
#include "mbk/measure/preprocess/resample.h"

namespace mbk::measurement {
namespace {

/// The channel of that name or alias.
Result<Channel> named_channel(const Recording& recording, const std::string& name) {
  if (const Channel* const channel = recording.find(name)) return *channel;
  for (const auto* const kind : recording::kinds_called(name)) {
    if (const Channel* const channel = recording.find(kind->name)) return *channel;
  }
  std::vector<std::string> names;
  for (const Channel& channel : recording.channels) names.push_back(channel.name);
  return bad_data(fmt::format("there is no channel '{}'; there are {}", name, fmt::join(names, ", ")),
                  "name a channel, a column's number or name, or a variable");
}

/// The recording as that of one axis: the input in the place of the position, the output in that of −F.
Result<Recording> with_signals(const Recording& recording, const ExploredSignals& signals) {
  Recording one = recording;
  one.channels.clear();
  const auto add = [&](const std::string& name, const char* as, double sign) -> Result<void> {
    auto channel = named_channel(recording, name);
    if (!channel) return tl::unexpected(channel.error());
    channel->name = as;
    channel->unit.clear();
    channel->values *= sign;
    one.channels.push_back(std::move(*channel));
    return {};
  };
  if (auto ok = add(signals.input, "position", signals.input_sign); !ok) return tl::unexpected(ok.error());
  if (auto ok = add(signals.output, "reaction", -signals.output_sign); !ok) return tl::unexpected(ok.error());
  if (signals.reference.empty()) return one;
  if (auto ok = add(signals.reference, "reference", 1.0); !ok) return tl::unexpected(ok.error());
  return one;
}

Result<ExplorationTrial> explored_trial(const Recording& recording, const ExploreOptions& options) {
  if (options.signals) {
    const ExploredSignals& signals = *options.signals;
    const auto one = with_signals(recording, signals);
    if (!one) return tl::unexpected(one.error());
    ExploreOptions rest = options;
    rest.signals.reset();
    rest.preprocess.axes = 1;
    auto trial = explored_trial(*one, rest);
    if (!trial) {
      return tl::unexpected(trial.error().in(fmt::format("'position' is the input {}, 'reaction' the output {}",
                                                         signals.input_name, signals.output_name)));
    }
    trial->input_labels = {{signals.input_name, named_channel(recording, signals.input)->unit}};
    trial->output_labels = {{signals.output_name, named_channel(recording, signals.output)->unit}};
    return trial;
  }
  const Recording* source = &recording;
  Inspection inspection = recording::inspect(recording);
  Recording even;
  std::optional<Warning> jitter;
  const auto put = [&](Recording made) {
    even = std::move(made);
    source = &even;
    inspection = recording::inspect(even);
  };
  if (options.resample) {
    auto resampled = preprocess::resample(recording, *options.resample);
    if (!resampled) return tl::unexpected(resampled.error());
    put(std::move(*resampled));
  } else if (preprocess::jitters_only(inspection)) {
    auto on_clock = preprocess::on_even_clock(recording, inspection);
    if (!on_clock) return tl::unexpected(on_clock.error());
    jitter = std::move(on_clock->warning);
    put(std::move(on_clock->recording));
  }
  if (options.force_delay != 0.0) {
    auto in_time = preprocess::undo_force_delay(*source, options.force_delay);
    if (!in_time) return tl::unexpected(in_time.error());
    put(std::move(*in_time));
  }
  auto trial = preprocess::exploration_trial_of(*source, inspection, options.preprocess);
  if (trial && jitter) trial->warnings.push_back(std::move(*jitter));
  return trial;
}

/// What needs more than the recording holds is absent, and why stands in the notes.
void add_responses_in_time(std::span<const ExplorationTrial> trials, const ExploreOptions& options,
                           Exploration& found) {
  const auto signals = explore::limb_signals(trials);
  if (!signals) {
    found.notes.push_back("no impulse response: " + signals.error().line());
    return;
  }
  if (auto response = explore::impulse_response(*signals, options.impulse_response)) {
    found.impulse_response = std::move(*response);
  } else {
    found.notes.push_back("no impulse response: " + response.error().line());
  }
  if (auto cascade = explore::parallel_cascade(*signals)) {
    found.parallel_cascade = std::move(*cascade);
  } else {
    found.notes.push_back("no intrinsic and reflex path: " + cascade.error().line());
  }
}

}  // namespace

Result<Exploration> explore(std::span<const Recording> recordings, const ExploreOptions& options) {
  std::vector<ExplorationTrial> trials;
  Exploration found;
  for (const Recording& recording : recordings) {
    auto trial = explored_trial(recording, options);
    if (!trial) {
      if (recording.sources.empty()) return tl::unexpected(trial.error());
      return tl::unexpected(trial.error().in(recording.sources.front().path));
    }
    found.recordings.push_back({trial->source, trial->recording_duration, 1.0 / trial->sample_time, trial->from_s,
                                trial->to_s(), trial->window_rule});
    found.notes.insert(found.notes.end(), trial->notes.begin(), trial->notes.end());
    found.warnings.insert(found.warnings.end(), trial->warnings.begin(), trial->warnings.end());
    trials.push_back(std::move(*trial));
  }
  if (trials.empty()) return bad_usage("there is no recording to explore");
  found.axes = trials.front().axes;
  found.motion = trials.front().motion;
  auto response = explore::frequency_response(trials, options.frequency_response);
  if (!response) return tl::unexpected(response.error());
  for (Warning& warning : explore::warnings_of(*response)) found.warnings.push_back(std::move(warning));
  found.frequency_response = std::move(*response);
  add_responses_in_time(trials, options, found);
  return found;
}

}  // namespace mbk::measurement
