#include "apps/mbk/options/explore_options.h"

#include "apps/mbk/terminal/signal_names.h"
#include "apps/mbk/options/word_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/units.h"
#include "mbk/files/recording/channel_table.h"

namespace mbk::app {
namespace {

Result<measurement::ExploreOptions> options_of(const ExploringArguments& a) {
  const auto window = MBK_TRY(window_limits(a.window));
  measurement::ExploreOptions options;
  options.preprocess.window = window;
  options.preprocess.protocol = a.protocol;
  options.preprocess.axes = a.reading.axes;
  if (a.resample_hz) options.resample = Hertz(*a.resample_hz);
  options.force_delay = a.force_delay_ms / kMilliseconds;
  options.force_rotation = a.force_rotation_deg / kDegrees;
  options.only = a.only;
  options.frequency_response = a.response;
  if (a.plateau_from_ms) options.plateau.from_s = *a.plateau_from_ms / kMilliseconds;
  if (a.plateau_to_ms) options.plateau.to_s = *a.plateau_to_ms / kMilliseconds;
  options.reaches.from_s = options.plateau.from_s;
  options.reaches.to_s = options.plateau.to_s;
  if (!a.trigger.empty()) options.reaches.trigger = a.trigger;
  if (!a.align.empty()) options.align = a.align;
  if (a.after_onset_ms) options.after_onset_s = *a.after_onset_ms / kMilliseconds;
  return options;
}

/// The schedule, and other signals than motion and force, where they are named.
Result<void> name_signals(ExploringArguments& a, measurement::ExploreOptions& options) {
  const SignalName schedule{a.schedule, "schedule", options.schedule, nullptr};
  if (a.input.empty() && a.output_signal.empty() && a.reference.empty()) {
    const bool is_channel = a.reading.channels.empty() && !recording::kinds_called(a.schedule).empty();
    if (!is_channel) return place_signals(a.reading, {&schedule, 1});
    options.schedule = a.schedule;  // and all other channels by their names
    return {};
  }
  if (a.input.empty() || a.output_signal.empty()) {
    return bad_usage("a response needs --input and --output", "name both, or neither for that of force to motion");
  }
  measurement::ExploredSignals& signals = options.signals.emplace();
  const SignalName names[] = {{a.input, "input", signals.input, &signals.input_sign},
                              {a.output_signal, "output", signals.output, &signals.output_sign},
                              {a.reference, "drive", signals.reference, nullptr},
                              schedule};
  signals.input_name = shown_name(a.input);
  signals.output_name = shown_name(a.output_signal);
  return place_signals(a.reading, names);
}

}  // namespace

Result<measurement::ExploreOptions> exploring_options(ExploringArguments& arguments) {
  auto options = options_of(arguments);
  if (!options) return options;
  MBK_TRY(name_signals(arguments, *options));
  if (options->schedule == "schedule") options->schedule_name = shown_name(arguments.schedule);
  return options;
}

void add_exploring_options(Command command, ExploringArguments& arguments) {
  add_reading_options(command, arguments.reading);
  command
      .add_option("--input", arguments.input,
                  "another response than that of force to motion: from this channel, column, row or variable")
      .type_name("NAME")
      .check(not_empty());
  command.add_option("--output", arguments.output_signal, "to this, likewise").type_name("NAME").check(not_empty());
  command.add_option("--reference", arguments.reference, "what drives both, likewise")
      .type_name("NAME")
      .check(not_empty());
  add_sensor_options(command, arguments.sensor);
  add_choice_or_auto(command, "--protocol", arguments.protocol,
                     "how the limb was perturbed; auto looks at the reference and says what it saw")
      .group("Analysed interval");
  add_window_options(command, arguments.window);
  command
      .add_option("--resample", arguments.resample_hz,
                  "put an uneven clock right first, by straight lines; never done unasked")
      .type_name("HZ")
      .check(positive());
  command
      .add_option("--force-delay-ms", arguments.force_delay_ms,
                  "by which the force was read late, as 'mbk sensor delay' finds it: undone first (0)")
      .type_name("MS")
      .check(number_within(1000.0));
  command
      .add_option("--force-rotation-deg", arguments.force_rotation_deg,
                  "turn the force by this angle from x to y first: for a force sensor mounted at an angle (0)")
      .type_name("DEG")
      .check(number_within(180.0))
      .group("Analysed interval");
  add_choice(command, "--only", arguments.only, "nothing but this part (all of them)");
  const char* const group = "Frequency response";
  add_choice_or_auto(
      command, "--method", arguments.response.method,
      "robust: periods and realisations of a periodic perturbation, noise and nonlinear distortion "
      "apart; fast: periods of one; local-polynomial: any perturbation, without leakage; welch: averaged "
      "spectra; auto: the first of these that the data allow, and says why (auto)")
      .group(group);
  command
      .add_option("--period", arguments.response.period_s,
                  "of the perturbation, s; otherwise found in the reference or the motion")
      .type_name("S")
      .check(positive())
      .group(group);
  command
      .add_option("--segment", arguments.response.segment_s,
                  "length of the segments that welch averages; local polynomials reach over its inverse, s (2)")
      .type_name("S")
      .check(positive())
      .group(group);
  command.add_option("--max-frequency", arguments.response.max_frequency_hz, "highest frequency that is shown, Hz (50)")
      .type_name("HZ")
      .check(positive())
      .group(group);
  command
      .add_option("--plateau-from", arguments.plateau_from_ms,
                  "begin of the window in which the force is averaged, ms after the onset (when the hand rests; 140 "
                  "in a reach)")
      .type_name("MS")
      .check(not_negative())
      .group("Ramps and holds");
  command.add_option("--plateau-to", arguments.plateau_to_ms, "its end, ms after the onset (300; 200 in a reach)")
      .type_name("MS")
      .check(positive())
      .group("Ramps and holds");
  command
      .add_option("--trigger", arguments.trigger,
                  "event of each reach at which the hand is displaced, or would be, relative to its predicted way "
                  "(trigger)")
      .type_name("EVENT")
      .check(not_empty())
      .group("Ramps and holds");
  const char* const in_time = "Change over time";
  command
      .add_option("--after-onset", arguments.after_onset_ms,
                  "M, B and K from so long after each step or pulse of the reference, before the person can "
                  "answer, ms; 100 to 150")
      .type_name("MS")
      .check(positive())
      .group(in_time);
  const Option schedule =
      command
          .add_option(
              "--schedule", arguments.schedule,
              "follow M, B and K over this channel, column, row or variable, such as an angle or a co-contraction, "
              "not over time")
          .type_name("NAME")
          .check(not_empty())
          .group(in_time);
  command
      .add_option("--align", arguments.align,
                  "count time from this event, repetition by repetition, or from the onsets of the reference "
                  "(reference)")
      .type_name("EVENT")
      .check(not_empty())
      .excludes(schedule)
      .group(in_time);
}

}  // namespace mbk::app
