#include "mbk/measure/measurement/explore.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/measure/analyse/ellipses.h"
#include "mbk/measure/explore/after_onset.h"
#include "mbk/measure/explore/limb_signals.h"
#include "mbk/measure/explore/parallel_cascade.h"
#include "mbk/measure/explore/stretch_muscles.h"
#include "mbk/measure/explore/time_course.h"
#include "mbk/measure/identify/reversed_force.h"
#include "mbk/measure/measurement/course_variable.h"
#include "mbk/measure/measurement/muscles.h"
#include "mbk/measure/preprocess/exclusions.h"
#include "mbk/measure/preprocess/exploration_trial_of.h"
#include "mbk/measure/preprocess/force_delay.h"
#include "mbk/measure/preprocess/force_rotation.h"
#include "mbk/measure/preprocess/jittered_clock.h"
#include "mbk/model/trial/quantity_channels.h"

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
  return bad_data(fmt::format("channel '{}' is missing; the channels are {}", name, fmt::join(names, ", ")),
                  "name a channel, a column (number or name) or a variable");
}

bool is_one_of(const std::string& name, const std::vector<std::string>& names) {
  return std::ranges::find(names, name) != names.end();
}

/// Whether the schedule is a channel as it was recorded, and not made of EMG.
bool scheduled_by_channel(const ExploreOptions& options) {
  return !options.schedule.empty() && options.schedule != kCoContraction &&
         !is_one_of(options.schedule, options.muscles);
}

/// The recording as that of one axis: the input in the place of the position, the output in that of −F.
Result<Recording> with_signals(const Recording& recording, const ExploreOptions& options) {
  const ExploredSignals& signals = *options.signals;
  Recording one = recording;
  one.channels.clear();
  const auto add = [&](const std::string& name, const char* as, double sign) -> Result<void> {
    auto channel = MBK_TRY(named_channel(recording, name));
    channel.name = as;
    channel.unit.clear();
    channel.values *= sign;
    one.channels.push_back(std::move(channel));
    return {};
  };
  MBK_TRY(add(signals.input, "position", signals.input_sign));
  MBK_TRY(add(signals.output, "reaction", -signals.output_sign));
  if (!signals.reference.empty()) {
    MBK_TRY(add(signals.reference, "reference", 1.0));
  }
  if (scheduled_by_channel(options)) {
    auto channel = MBK_TRY(named_channel(recording, options.schedule));
    if (one.find(channel.name) == nullptr) one.channels.push_back(std::move(channel));
  }
  for (const Channel& channel : recording.channels) {
    if (is_one_of(channel.name, options.muscles) && one.find(channel.name) == nullptr) one.channels.push_back(channel);
  }
  return one;
}

Result<ExplorationTrial> explored_trial(const Recording& recording, const ExploreOptions& options) {
  if (options.signals) {
    const ExploredSignals& signals = *options.signals;
    const auto one = MBK_TRY(with_signals(recording, options));
    ExploreOptions rest = options;
    rest.signals.reset();
    rest.preprocess.axes = 1;
    auto trial = explored_trial(one, rest);
    if (!trial) {
      return tl::unexpected(trial.error().in(fmt::format("'position' is the input {}, 'reaction' the output {}",
                                                         signals.input_name, signals.output_name)));
    }
    trial->input_labels = {{signals.input_name, named_channel(recording, signals.input)->unit}};
    trial->output_labels = {{signals.output_name, named_channel(recording, signals.output)->unit}};
    return trial;
  }
  MBK_TRY(preprocess::check_consent(recording));
  const Inspection recorded = recording::inspect(recording);
  auto even = preprocess::reclocked(recording, recorded, options.resample);
  if (!even) return tl::unexpected(even.error());
  if (options.force_delay != 0.0) {
    auto in_time =
        MBK_TRY(preprocess::undo_force_delay(even->recording ? *even->recording : recording, options.force_delay));
    even->recording = std::move(in_time);
  }
  if (options.force_rotation != preprocess::RotationVector{}) {
    auto turned =
        MBK_TRY(preprocess::turn_force(even->recording ? *even->recording : recording, options.force_rotation));
    even->recording = std::move(turned);
  }
  const Recording& source = even->recording ? *even->recording : recording;
  auto trial = preprocess::exploration_trial_of(source, even->recording ? recording::inspect(source) : recorded,
                                                options.preprocess);
  if (trial && even->warning) trial->warnings.push_back(std::move(*even->warning));
  if (trial) MBK_TRY(add_muscles(source, options.muscles, options.emg.processing, *trial));
  if (trial && scheduled_by_channel(options)) {
    const auto channel = MBK_TRY(named_channel(source, options.schedule));
    trial->scheduling = channel.values.segment(std::llround(trial->from_s / trial->sample_time), trial->samples());
    if (!trial->scheduling.allFinite()) {
      return bad_data(fmt::format("'{}' is not finite everywhere in the analysed interval", channel.name),
                      "choose the interval with --from and --to");
    }
    trial->scheduling_label = {options.schedule_name.empty() ? channel.name : options.schedule_name, channel.unit};
  }
  return trial;
}

/// The recordings without EMG, whose copies would be large. EMG needs motion only: where no force was recorded, the
/// motion takes its place and is not used.
std::vector<Recording> motions_of(std::span<const Recording> recordings) {
  std::vector<Recording> motions;
  for (const Recording& recording : recordings) {
    Recording motion = {.time = recording.time};
    motion.time_origin = recording.time_origin;
    motion.events = recording.events;
    motion.metadata = recording.metadata;
    motion.sources = recording.sources;
    motion.notes = recording.notes;
    motion.warnings = recording.warnings;
    for (const Channel& channel : recording.channels) {
      if (!explore::is_emg(channel)) motion.channels.push_back(channel);
    }
    const int axes = recording.find(kPositionChannels.one_axis) != nullptr     ? 1
                     : recording.find(kPositionChannels.several[2]) != nullptr ? 3
                                                                               : 2;
    for (Index axis = 0; axis < axes; ++axis) {
      const Channel* const position = recording.find(kPositionChannels.name(axes, axis));
      if (position == nullptr || recording.find(kForceChannels.name(axes, axis)) != nullptr) continue;
      Channel& force = motion.channels.emplace_back(*position);
      force.name = kForceChannels.name(axes, axis);
      force.unit.clear();
    }
    motions.push_back(std::move(motion));
  }
  return motions;
}

/// Recordings on an even clock, and copies of those whose clock was not.
struct EvenRecordings {
  std::vector<preprocess::Reclocked> copies;
  std::vector<const Recording*> all;
};

/// @fails  as reclocked
Result<EvenRecordings> evenly_clocked(std::span<const Recording> recordings, const ExploreOptions& options) {
  EvenRecordings even;
  even.copies.reserve(recordings.size());  // `all` points into it
  for (const Recording& recording : recordings) {
    auto one = preprocess::reclocked(recording, recording::inspect(recording), options.resample);
    if (!one) return tl::unexpected(one.error());
    even.copies.push_back(std::move(*one));
    even.all.push_back(even.copies.back().recording ? &*even.copies.back().recording : &recording);
  }
  return even;
}

/// EMG after the onsets of perturbations, with the epochs of all recordings pooled.
/// @fails  usage: other signals are explored. data: the rates differ. As reclocked and explore::emg_responses.
Result<void> add_emg(std::span<const Recording> recordings, std::span<const ExplorationTrial> trials,
                     const ExploreOptions& options, Exploration& found) {
  if (options.signals) return bad_usage("--only emg needs motion, not --input and --output");
  const double T = trials.front().sample_time;
  constexpr double kSameRate = 1e-6;
  const auto rest = std::max<Index>(std::llround(options.emg.background_s / T), 1);
  const auto even = MBK_TRY(evenly_clocked(recordings, options));
  std::vector<explore::EmgRecording> sources;
  bool by_reference = true;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const ExplorationTrial& trial = trials[k];
    if (!(std::abs(trial.sample_time / T - 1.0) < kSameRate)) {
      return bad_data("the recordings have different sample rates", "use --resample");
    }
    by_reference = by_reference && trial.reference.size() > 0;
    auto onsets = explore::perturbation_onsets(trial, rest);
    for (explore::Onset& onset : onsets) onset.sample += std::llround(trial.from_s / T);
    sources.push_back({even.all[k], std::move(onsets)});
  }
  auto emg = explore::emg_responses(sources, T, options.emg);
  if (!emg) return tl::unexpected(emg.error().in("EMG"));
  emg->onset_rule = by_reference ? "reference" : "motion";
  found.usable = std::ranges::any_of(emg->channels, &EmgChannelEstimate::usable);
  found.emg = std::move(*emg);
  return {};
}

/// EMG of the stretches, on the clock of the trials.
/// @fails  as reclocked and explore::add_stretch_muscles
Result<void> add_emg_of_stretches(std::span<const Recording> recordings, std::span<const ExplorationTrial> trials,
                                  const ExploreOptions& options, StretchEstimate& found) {
  if (options.signals) return {};
  const auto even = MBK_TRY(evenly_clocked(recordings, options));
  return explore::add_stretch_muscles(even.all, trials, found);
}

bool requested(const ExploreOptions& options, ExplorationPart part) {
  return !options.only || *options.only == part;
}

/// Whether M, B and K of what was fitted are all negative, as where the force has the opposite sign.
bool is_reversed(const Exploration& found) {
  const auto negative = [](const Matrix& M, const Matrix& B, const Matrix& K) {
    return M.size() > 0 && std::max({M.diagonal().maxCoeff(), B.diagonal().maxCoeff(), K.diagonal().maxCoeff()}) < 0.0;
  };
  const auto of_model = [&](const ResponseModel& model) {
    return model.identifiable && negative(model.M, model.B, model.K);
  };
  return (found.impulse_response && of_model(found.impulse_response->model)) ||
         (found.parallel_cascade && of_model(found.parallel_cascade->intrinsic_model)) ||
         (found.time_course &&
          negative(found.time_course->M.mean, found.time_course->B.mean, found.time_course->K.mean));
}

/// What needs more than the recording holds is absent, and why stands in the notes.
/// @fails  as course_variable
Result<void> add_responses_in_time(std::span<const ExplorationTrial> trials, const ExploreOptions& options,
                                   Exploration& found) {
  const bool response_requested = requested(options, ExplorationPart::impulse_response);
  const bool cascade_requested = requested(options, ExplorationPart::reflex);
  const bool course_requested = requested(options, ExplorationPart::time_course);
  if (!response_requested && !cascade_requested && !course_requested) return {};
  const auto signals = explore::limb_signals(trials);
  if (!signals) {
    found.notes.push_back("no impulse response: " + signals.error().line());
    return {};
  }
  if (course_requested) {
    const auto variable = MBK_TRY(course_variable(trials, !options.schedule.empty(), options.align));
    if (auto course = explore::time_course(*signals, variable, moved_up_to(trials))) {
      found.time_course = std::move(*course);
    } else {
      found.notes.push_back("no change over time: " + course.error().line());
    }
  }
  if (response_requested) {
    if (auto response = explore::impulse_response(*signals, options.impulse_response)) {
      found.impulse_response = std::move(*response);
    } else {
      found.notes.push_back("no impulse response: " + response.error().line());
    }
  }
  if (!cascade_requested) return {};
  if (auto cascade = explore::parallel_cascade(*signals)) {
    found.parallel_cascade = std::move(*cascade);
  } else {
    found.notes.push_back("no intrinsic and reflex path: " + cascade.error().line());
  }
  return {};
}

/// The trial, or why there is none, with the name of its file.
Result<ExplorationTrial> named_trial(const Recording& recording, const ExploreOptions& options) {
  auto trial = explored_trial(recording, options);
  if (trial || recording.sources.empty()) return trial;
  return tl::unexpected(trial.error().in(recording.sources.front().label()));
}

Result<std::vector<ExplorationTrial>> named_trials(std::span<const Recording> recordings,
                                                   const ExploreOptions& options) {
  std::vector<ExplorationTrial> trials;
  for (const Recording& recording : recordings) {
    auto trial = MBK_TRY(named_trial(recording, options));
    trials.push_back(std::move(trial));
  }
  if (trials.empty()) return bad_usage("no recording was given");
  MBK_TRY(scale_muscles(trials, options.emg.mvc, options.schedule, options.emg.processing));
  return trials;
}

/// The same, from the first sample to the last, unless the options say otherwise.
Result<std::vector<ExplorationTrial>> whole_trials(std::span<const Recording> recordings, ExploreOptions options) {
  options.preprocess.protocol = Protocol::free;
  return named_trials(recordings, options);
}

/// Where every recording's reference is ramps and holds, or the window on the plateau was given.
Result<void> add_plateaus(std::span<const Recording> recordings, std::span<const ExplorationTrial> trials,
                          const ExploreOptions& options, Exploration& found) {
  const bool asked = options.plateau.asked() || options.only == ExplorationPart::ramp_and_hold;
  const auto displaces = [&](const ExplorationTrial& trial) {
    return explore::is_ramp_and_hold(trial, options.plateau);
  };
  if (options.signals) return {};
  if (!options.plateau.asked() && !std::ranges::all_of(trials, displaces)) {
    if (!asked) return {};
    return bad_data("no position reference with at least 4 ramps and holds was recorded",
                    "record a ramp-and-hold perturbation, or omit --only");
  }
  auto plateaus = plateau_stiffness(recordings, options, found.warnings);
  if (!plateaus) {
    if (asked) return tl::unexpected(plateaus.error());
    found.notes.push_back("no stiffness from ramps and holds: " + plateaus.error().line());
    return {};
  }
  if (!plateaus->usable) found.usable = false;
  found.plateau_stiffness = std::move(*plateaus);
  return {};
}

/// Recordings with a trigger are of reaches, of which there is that part alone unless another was asked for.
bool are_reaches(std::span<const Recording> recordings, const ExploreOptions& options) {
  if (options.signals || options.only) return options.only == ExplorationPart::servo_displacement;
  return std::ranges::all_of(recordings, [&](const Recording& recording) {
    return std::ranges::find(recording.events, options.reaches.trigger, &Event::name) != recording.events.end();
  });
}

Result<void> add_reaches(std::span<const ExplorationTrial> whole, const ExploreOptions& options, Exploration& found) {
  auto reaches = explore::reach_stiffness(whole, options.reaches, found.warnings);
  if (!reaches) return tl::unexpected(reaches.error().in("reaches"));
  add_ellipse(reaches->own_past.fit);
  add_ellipse(reaches->mean_reach.fit);
  found.usable = reaches->usable;
  found.reach_stiffness = std::move(*reaches);
  if (!options.only) {
    found.notes.push_back(fmt::format(
        "the recordings contain the event '{}', so they are analysed as reaches only; choose another part with --only",
        options.reaches.trigger));
  }
  return {};
}

}  // namespace

void add_ellipse(StiffnessRegression& fit) {
  if (fit.K.rows() != 2) return;
  const double t = numeric::student_quantile(0.975, static_cast<int>(fit.degrees_of_freedom));
  const Eigen::Matrix4d covariance = std::pow(t / numeric::kNormal95, 2) * fit.covariance;
  fit.ellipse = analyse::ellipse_finding(fit.K, covariance);
  fit.antisymmetry = analyse::antisymmetry_finding(fit.K, covariance);
}

Result<PlateauStiffness> plateau_stiffness(std::span<const Recording> recordings, const ExploreOptions& options,
                                           std::vector<Warning>& warnings) {
  const auto whole = MBK_TRY(whole_trials(recordings, options));
  auto found = explore::plateau_stiffness(whole, options.plateau);
  if (!found) return tl::unexpected(found.error().in("ramps and holds"));
  add_ellipse(found->fit);
  for (Warning& warning : explore::judge_plateaus(*found)) warnings.push_back(std::move(warning));
  return found;
}

Result<TimeCourseEstimate> time_course(std::span<const Recording> recordings, const ExploreOptions& options) {
  const auto trials = MBK_TRY(named_trials(recordings, options));
  const auto signals = MBK_TRY(explore::limb_signals(trials));
  const auto variable = MBK_TRY(course_variable(trials, !options.schedule.empty(), options.align));
  return explore::time_course(signals, variable, moved_up_to(trials));
}

Result<AfterOnsetEstimate> after_onset(std::span<const Recording> recordings, const ExploreOptions& options) {
  if (!options.after_onset_s) return bad_usage("the time after the onset is missing");
  const auto trials = MBK_TRY(named_trials(recordings, options));
  return explore::after_onset(trials, *options.after_onset_s);
}

Result<Exploration> explore(std::span<const Recording> recordings, const ExploreOptions& options) {
  const bool reaches = !recordings.empty() && are_reaches(recordings, options);
  const bool emg = options.only == ExplorationPart::emg, stretches = options.only == ExplorationPart::stretch;
  const auto named = MBK_TRY(emg                    ? whole_trials(motions_of(recordings), options)
                             : reaches || stretches ? whole_trials(recordings, options)
                                                    : named_trials(recordings, options));
  const std::vector<ExplorationTrial>& trials = named;
  Exploration found;
  for (const ExplorationTrial& trial : trials) {
    found.recordings.push_back({trial.source, trial.recording_duration, 1.0 / trial.sample_time, trial.from_s,
                                trial.to_s(), trial.window_rule});
    found.notes.insert(found.notes.end(), trial.notes.begin(), trial.notes.end());
    found.warnings.insert(found.warnings.end(), trial.warnings.begin(), trial.warnings.end());
  }
  found.axes = trials.front().axes;
  found.motion = trials.front().motion;
  found.other_signals = options.signals.has_value();
  if (reaches) {
    MBK_TRY(add_reaches(trials, options, found));
    return found;
  }
  if (emg) {
    MBK_TRY(add_emg(recordings, trials, options, found));
    return found;
  }
  if (stretches) {
    auto stretch = explore::stretch(trials, options.stretch, found.warnings);
    if (!stretch) return tl::unexpected(stretch.error().in("stretches"));
    MBK_TRY(add_emg_of_stretches(recordings, trials, options, *stretch));
    found.usable = stretch->usable;
    found.stretch = std::move(*stretch);
    return found;
  }
  if (options.after_onset_s) {
    auto after_onset = MBK_TRY(explore::after_onset(trials, *options.after_onset_s));
    found.after_onset = std::move(after_onset);
  }
  if (requested(options, ExplorationPart::frequency_response)) {
    auto response = MBK_TRY(explore::frequency_response(trials, options.frequency_response));
    for (Warning& warning : explore::warnings_of(response)) found.warnings.push_back(std::move(warning));
    found.frequency_response = std::move(response);
  }
  MBK_TRY(add_responses_in_time(trials, options, found));
  if (!options.signals && is_reversed(found)) {
    found.warnings.push_back(identify::reversed_force(found.axes));
    found.usable = false;
  }
  if (requested(options, ExplorationPart::ramp_and_hold)) {
    MBK_TRY(add_plateaus(recordings, trials, options, found));
  }
  return found;
}

}  // namespace mbk::measurement
