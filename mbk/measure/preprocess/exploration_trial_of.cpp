#include "mbk/measure/preprocess/exploration_trial_of.h"

#include <fmt/format.h>

#include <utility>

#include "mbk/measure/preprocess/recorded_handle_mass.h"
#include "mbk/measure/preprocess/recording_checks.h"
#include "mbk/measure/preprocess/signals.h"
#include "mbk/measure/preprocess/trial_clock.h"
#include "mbk/measure/preprocess/windows.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {
namespace {

std::vector<SignalLabel> labels_of(const Recording& recording, const QuantityChannels& quantity, int axes,
                                   const std::string& sign) {
  std::vector<SignalLabel> labels;
  for (Index axis = 0; axis < axes; ++axis) {
    const std::string name = quantity.name(axes, axis);
    labels.push_back({sign + name, recording.find(name)->unit});
  }
  return labels;
}

/// Whether it moves along every axis, so that it can stand for the motion without its noise.
bool moves(const Matrix& reference) {
  for (Index axis = 0; axis < reference.cols(); ++axis) {
    if (reference.col(axis).maxCoeff() == reference.col(axis).minCoeff()) return false;
  }
  return reference.size() > 0;
}

}  // namespace

Result<ExplorationTrial> exploration_trial_of(const Recording& recording, const Inspection& inspection,
                                              const Options& options) {
  const Index samples = recording.samples();
  MBK_TRY(check_length(samples, inspection));
  const Hertz rate(inspection.rate_hz);
  const Clock clock(recording.time, rate);
  MBK_TRY(check_missing(clock, inspection.missing, options.window));
  const auto signals = MBK_TRY(select_signals(recording, options.axes, false));

  ExplorationTrial trial;
  trial.axes = signals.axes;
  trial.motion = signals.motion;
  const ProtocolFinding found = detect_protocol(signals.reference);
  trial.protocol = options.protocol.value_or(found.protocol);
  trial.protocol_rule = options.protocol ? "given" : found.rule;
  if (trial.protocol == Protocol::sinusoidal && signals.reference.size() == 0) {
    return bad_data(fmt::format("protocol 'sinusoidal' needs the reference, channel '{}', which is missing",
                                kReferenceChannels.name(trial.axes, 0)),
                    "name it with --channels, or use --protocol free");
  }
  if (trial.protocol != Protocol::free) {
    MBK_TRY(check_reference(clock, signals, options.window));
  }
  const Protocol windows = trial.protocol == Protocol::sinusoidal ? Protocol::sinusoidal : Protocol::free;
  const auto plan = MBK_TRY(default_windows(windows, signals.reference, clock, options.window));
  MBK_TRY(check_clock(clock, inspection, plan, trial.warnings));
  MBK_TRY(check_finite(clock, signals, plan, recording.warnings));
  MBK_TRY(check_alive(signals, plan));
  warn_of_small_motion(signals, plan, trial.warnings);

  const Cut& cut = plan.cuts.front();
  const Index rows = cut.end - cut.begin;
  if (rows < kMinSamples) {
    return bad_data(fmt::format("the analysed interval has only {} samples", rows), "choose a longer interval");
  }
  trial.sample_time = 1.0 / rate.value;
  trial.from_s = clock.seconds(cut.begin);
  trial.input = signals.position.middle_rows(cut.begin, rows);
  trial.output = -signals.force_hand_on_robot.middle_rows(cut.begin, rows);
  if (signals.reference.size() > 0) {
    Matrix reference = signals.reference.middle_rows(cut.begin, rows);
    if (reference.allFinite() && moves(reference)) {
      trial.reference = std::move(reference);
      trial.reference_quantity = signals.reference_quantity;
    }
  }
  trial.input_labels = labels_of(recording, kPositionChannels, trial.axes, "");
  trial.output_labels = labels_of(recording, kForceChannels, trial.axes, "−");
  trial.split = rows;
  for (const Segment& segment : cut.keep) {
    if (segment.purpose == Purpose::validation) {
      trial.split = segment.begin - cut.begin;
      break;
    }
  }
  trial.window_rule = plan.rule;
  if (!recording.sources.empty()) trial.source = recording.sources.front();
  trial.recording_duration = inspection.duration + inspection.interval_median;
  for (Event event : recording.events) {
    event.time -= recording.time[0];
    trial.events.push_back(std::move(event));
  }
  trial.recorded_handle_mass = recorded_handle_mass(recording);
  trial.notes = recording.notes;
  trial.warnings.insert(trial.warnings.end(), recording.warnings.begin(), recording.warnings.end());
  return trial;
}

}  // namespace mbk::preprocess
