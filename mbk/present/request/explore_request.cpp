#include "mbk/present/request/explore_request.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/measure/measurement/muscles.h"
#include "mbk/present/request/number_of.h"
#include "mbk/present/request/signal_names.h"
#include "mbk/present/request/stage_tables.h"

namespace mbk::request {
namespace {

/// The muscles, and the schedule where it is made of their EMG.
void name_muscles(const ExploreRequest& request, measurement::ExploreOptions& options) {
  const auto add = [&](const std::string& channel) {
    if (std::ranges::find(options.muscles, channel) == options.muscles.end()) options.muscles.push_back(channel);
  };
  for (const std::string& name : request.muscles) add(explore::emg_channel_of(name));
  const bool muscle = explore::is_emg({.name = request.schedule});
  if (muscle) add(request.schedule);
  if (muscle || request.schedule == measurement::kCoContraction) options.schedule = request.schedule;
}

/// The schedule, and other signals than motion and force, where they are named.
Result<void> name_signals(ExploreRequest& request, measurement::ExploreOptions& options) {
  name_muscles(request, options);
  const std::string recorded = options.schedule.empty() ? request.schedule : "";
  const SignalName schedule{recorded, "schedule", options.schedule, nullptr};
  if (request.input.empty() && request.output.empty() && request.reference.empty()) {
    const bool is_channel = request.reading.channels.empty() && !recording::kinds_called(recorded).empty();
    if (!is_channel) return place_signals(request.reading, {&schedule, 1});
    options.schedule = recorded;  // and all other channels by their names
    return {};
  }
  if (request.input.empty() || request.output.empty()) {
    return bad_usage("a response needs both --input and --output",
                     "name both, or omit both for the response of force to motion");
  }
  measurement::ExploredSignals& signals = options.signals.emplace();
  const SignalName names[] = {{request.input, "input", signals.input, &signals.input_sign},
                              {request.output, "output", signals.output, &signals.output_sign},
                              {request.reference, "drive", signals.reference, nullptr},
                              schedule};
  signals.input_name = shown_name(request.input);
  signals.output_name = shown_name(request.output);
  return place_signals(request.reading, names);
}

OptionTable<explore::FrequencyResponseOptions> response_table() {
  using Options = explore::FrequencyResponseOptions;
  OptionTable<Options> table;
  table.group("Frequency response")
      .add(
          {"--method", std::string(option_values::kAuto),
           "robust: several periods and realisations of a periodic perturbation, separates noise from nonlinear "
           "distortion; fast: several periods of one realisation; local-polynomial: any perturbation, without leakage; "
           "welch: averaged spectra; auto: the first of these that the data allow, with the reason (default: auto)"},
          &Options::method)
      .add({"--period", "S", "period of the perturbation, in seconds (default: found in the reference or the motion)",
            positive()},
           &Options::period_s)
      .add({"--segment", "S",
            "length, in seconds, of the segments that welch averages; its inverse is the bandwidth of the local "
            "polynomials "
            "(default: 2)",
            positive()},
           &Options::segment_s)
      .add({"--max-frequency", "HZ", "highest frequency of the result, in Hz (default: 50)", positive()},
           &Options::max_frequency_hz);
  return table;
}

OptionTable<measurement::ExploreOptions> course_table() {
  using Options = measurement::ExploreOptions;
  OptionTable<Options> table;
  table.group("Ramps and holds")
      .add(
          {"--plateau-from", "MS",
           "start of the window in which the force is averaged, in ms after the onset (default: when the hand is at "
           "rest; "
           "in a reach 140)",
           not_negative()},
          [](auto& options) -> auto& { return options.plateau.from_s; }, kMilliseconds)
      .add(
          {"--plateau-to", "MS", "end of that window, in ms after the onset (default: 300; in a reach 200)",
           positive()},
          [](auto& options) -> auto& { return options.plateau.to_s; }, kMilliseconds)
      .add(
          {"--trigger", "EVENT",
           "event of each reach at which the hand is displaced, or would be, relative to its predicted path (default: "
           "trigger)",
           not_empty()},
          [](auto& options) -> auto& { return options.reaches.trigger; })
      .group("Change over time")
      .add({"--after-onset", "MS",
            "estimate M, B and K from the first MS milliseconds after each step or pulse of the reference, before the "
            "person can respond (100 to 150 ms)",
            positive()},
           &Options::after_onset_s, kMilliseconds);
  return table;
}

/// @fails  usage: a band that is not two numbers; a value of --mvc that is not MUSCLE=V.
Result<void> set_emg(const ExploreRequest& request, explore::EmgOptions& emg) {
  if (!request.emg_band.empty()) {
    if (request.emg_band.size() != 2) return bad_usage("--emg-band needs two frequencies, such as 20,450");
    emg.processing.low_hz = number_of(request.emg_band[0]).value_or(0.0);
    emg.processing.high_hz = number_of(request.emg_band[1]).value_or(0.0);
  }
  if (!request.emg_windows.empty()) {
    emg.edges_s.clear();
    for (const std::string& text : request.emg_windows) {
      emg.edges_s.push_back(number_of(text).value_or(0.0) / kMilliseconds);
    }
  }
  for (const std::string& text : request.mvc) {
    const auto at = text.find('=');
    const auto volts = at == std::string::npos ? std::nullopt : number_of(text.substr(at + 1));
    if (!volts || !(*volts > 0.0)) {
      return bad_usage("--mvc: " + quoted(text) + " is not MUSCLE=V with a positive voltage",
                       "for example --mvc biceps=0.0012");
    }
    emg.mvc[explore::emg_channel_of(text.substr(0, at))] = *volts;
  }
  if (request.emg_envelope_hz) emg.processing.envelope_hz = *request.emg_envelope_hz;
  if (emg.processing.envelope_rms_s > 0.0) emg.processing.envelope_hz = 0.0;
  return {};
}

OptionTable<ExploreRequest> emg_table() {
  OptionTable<ExploreRequest> table;
  const auto processing = [](auto& request) -> auto& {
    return request.options.emg.processing;
  };
  table.group("EMG (--only emg, --muscles)")
      .add({.name = "--muscles",
            .value = "NAME,...",
            .help = "muscles, such as biceps,triceps, whose EMG is a third part of the force beside the intrinsic and "
                    "the reflex one, and whose co-contraction can be the --schedule",
            .check = not_empty(),
            .takes_several = true},
           &ExploreRequest::muscles)
      .add({.name = "--emg-band",
            .value = "LOW,HIGH",
            .help = "band of the EMG, in Hz; zero-phase Butterworth filter of order 4 (default: 20,450)",
            .check = positive(),
            .takes_several = true},
           &ExploreRequest::emg_band)
      .add({"--emg-envelope", "HZ",
            "cut-off of the zero-phase low-pass for the envelope, in Hz (default: 50; of a schedule 2)", positive()},
           &ExploreRequest::emg_envelope_hz)
      .add(
          {.name = "--emg-rms",
           .value = "MS",
           .help = "window of a moving RMS for the envelope, in ms, instead of the low-pass",
           .check = positive(),
           .excludes = "--emg-envelope"},
          [processing](auto& request) -> auto& { return processing(request).envelope_rms_s; }, kMilliseconds)
      .add({.name = "--emg-windows",
            .value = "MS,MS,...",
            .help = "edges of the windows after the onset of a perturbation, in ms (default: 20,50,100,150: short "
                    "latency, long latency, voluntary)",
            .check = not_negative(),
            .takes_several = true},
           &ExploreRequest::emg_windows)
      .add(
          {"--emg-background", "MS", "duration before the onset that responses are compared with, in ms (default: 100)",
           positive()},
          [](auto& request) -> auto& { return request.options.emg.background_s; }, kMilliseconds)
      .add({.name = "--mvc",
            .value = "MUSCLE=V,...",
            .help = "mean rectified EMG of each muscle at maximal voluntary contraction, in V: the background is also "
                    "given as a share of it",
            .check = not_empty(),
            .takes_several = true},
           &ExploreRequest::mvc);
  return table;
}

OptionTable<explore::StretchOptions> stretch_table() {
  using Options = explore::StretchOptions;
  OptionTable<Options> table;
  table.group("Stretches at constant velocity")
      .add({"--stretch-from", "DEG",
            "smallest analysed angle, in degrees (default: where every stretch has constant velocity)",
            number_within(720.0)},
           &Options::from, kDegrees)
      .add({"--stretch-to", "DEG", "largest analysed angle, in degrees (default: likewise)", number_within(720.0)},
           &Options::to, kDegrees)
      .add({"--stretch-inertia", "KGM2", "inertia whose torque is subtracted, in kg m2 (default: 0)", not_negative()},
           &Options::inertia)
      .add({"--stretch-viscosity", "NMS",
            "largest slope of torque over speed that counts as passive, in N m s/rad, such as the upper limit of the "
            "study's controls (default: not used)",
            positive()},
           &Options::viscosity);
  return table;
}

/// --protocol, with the word "stretch" for --only stretch.
OptionTable<ExploreRequest>::Row protocol_row() {
  OptionTable<ExploreRequest> one;
  one.add(
      protocol_option(kWindowGroup), [](auto& request) -> auto& { return request.options.preprocess.protocol; });
  auto row = one.rows().front();
  const std::string stretch(word_of(ExplorationPart::stretch));
  std::vector<std::string> words = row.facts.check.words;
  words.push_back(stretch);
  row.facts.value += "|" + stretch;
  row.facts.help =
      "how the limb was perturbed; stretch is the same as --only stretch; auto decides from the reference "
      "and reports its choice (default: auto)";
  row.facts.check = one_of(words);
  row.set = [set = row.set, stretch](ExploreRequest& request, const std::vector<std::string>& texts) {
    if (texts.back() == stretch) {
      request.options.only = ExplorationPart::stretch;
    } else {
      set(request, texts);
    }
  };
  return row;
}

}  // namespace

const OptionTable<ExploreRequest>& explore_table() {
  static const auto kTable = [] {
    const auto options = [](auto& request) -> auto& {
      return request.options;
    };
    const char* const in_time = "Change over time";
    OptionTable<ExploreRequest> table;
    table.include(read_table(), &ExploreRequest::reading)
        .add(
            {"--input", "NAME",
             "input of a response other than that of force to motion: a channel, column, row or variable", not_empty()},
            &ExploreRequest::input)
        .add({"--output", "NAME", "its output, named likewise", not_empty()}, &ExploreRequest::output)
        .add({"--reference", "NAME", "the signal that drives both, named likewise", not_empty()},
             &ExploreRequest::reference)
        .include(sensor_table(), &ExploreRequest::sensor)
        .add_row(protocol_row())
        .include(
            window_table(), [](auto& request) -> auto& { return request.options.preprocess.window; })
        .add(
            resample_option(), [](auto& request) -> auto& { return request.options.resample; })
        .add(
            force_delay_option(), [](auto& request) -> auto& { return request.options.force_delay; }, kMilliseconds)
        .add_row(force_rotation_row<ExploreRequest>(kWindowGroup))
        .add(
            {"--only", "PART",
             "compute only this part: frequency-response, impulse-response, reflex, time-course, ramp-and-hold, "
             "servo-displacement, emg or stretch (default: all but emg and stretch)"},
            [](auto& request) -> auto& { return request.options.only; })
        .include(
            response_table(), [](auto& request) -> auto& { return request.options.frequency_response; })
        .include(course_table(), options)
        .include(
            stretch_table(), [](auto& request) -> auto& { return request.options.stretch; })
        .group(in_time)
        .add({"--schedule", "NAME",
              "follow M, B and K over this channel, column, row or variable, such as an angle, instead of over time; "
              "over co-contraction, of two --muscles; or over the envelope of EMG, such as emg_biceps",
              not_empty()},
             &ExploreRequest::schedule)
        .add(
            {.name = "--align",
             .value = "EVENT",
             .help =
                 "event that time is counted from in each repetition (default: reference, the onsets of the reference)",
             .check = not_empty(),
             .excludes = "--schedule"},
            [](auto& request) -> auto& { return request.options.align; })
        .include(
            emg_table(), [](auto& request) -> auto& { return request; });
    return table;
  }();
  return kTable;
}

Result<measurement::ExploreOptions> explore_options(ExploreRequest& request) {
  measurement::ExploreOptions options = request.options;
  MBK_TRY(check_order(options.preprocess.window));
  options.preprocess.axes = request.reading.options.axes;
  options.reaches.from_s = options.plateau.from_s;
  options.reaches.to_s = options.plateau.to_s;
  MBK_TRY(name_signals(request, options));
  constexpr double kSlow = 2.0;  // [Hz], of a schedule: what changes faster is the noise of EMG
  if (!options.muscles.empty() && !options.schedule.empty()) options.emg.processing.envelope_hz = kSlow;
  MBK_TRY(set_emg(request, options.emg));
  const bool emg = options.only == ExplorationPart::emg || options.only == ExplorationPart::stretch;
  if (emg || !options.muscles.empty()) request.reading.options.emg = recording::EmgReading::all;
  if (options.schedule == "schedule") options.schedule_name = shown_name(request.schedule);
  return options;
}

}  // namespace mbk::request
