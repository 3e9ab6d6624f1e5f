#include "mbk/measure/preprocess/prepare.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "mbk/files/contents/disk_pages.h"
#include "mbk/measure/preprocess/band.h"
#include "mbk/measure/preprocess/exclusions.h"
#include "mbk/measure/preprocess/filters.h"
#include "mbk/measure/preprocess/recorded_handle_mass.h"
#include "mbk/measure/preprocess/recording_checks.h"
#include "mbk/measure/preprocess/signals.h"
#include "mbk/measure/preprocess/trial_clock.h"
#include "mbk/measure/preprocess/windows.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {
namespace {

/// The columns of matrices side by side, from a row on.
std::vector<double*> columns_from(Index row, std::initializer_list<Matrix*> matrices) {
  std::vector<double*> columns;
  for (Matrix* matrix : matrices) {
    for (Index k = 0; k < matrix->cols(); ++k) columns.push_back(matrix->col(k).data() + row);
  }
  return columns;
}

/// PreparedTrial::force_variance_at_rest, from as long before each displacement as that lasts, at most half of the way
/// back to the one before, by which the limb has come to rest.
Vector variance_at_rest(const Signals& signals, const WindowPlan& plan, const FilterPlan& filters, Hertz rate,
                        const dsp::Padding& padding) {
  const Index n = signals.axes;
  std::vector<Matrix> pieces;
  Index rows = 0, last_end = 0;
  for (const Cut& cut : plan.cuts) {
    for (const Segment& displaced : cut.keep) {
      const Index length = std::min(displaced.size(), (displaced.begin - last_end) / 2);
      last_end = displaced.end;
      if (length <= 0) continue;
      const Cut rest{displaced.begin - length, displaced.begin, {}};
      const auto touches = [&](const Segment& one) { return one.begin < rest.end && one.end > rest.begin; };
      if (std::ranges::any_of(plan.excluded, touches)) continue;
      if (!signals.force_hand_on_robot.middle_rows(rest.begin, length).allFinite()) continue;
      const auto left = filtered_rows(rest, filters, plan.trim, padding);
      if (!left) continue;  // too short for the filters
      Matrix filtered(*left, 4 * n + signals.force_sensitivity.cols());
      if (!filter_cut(signals, rest, filters, plan.trim, rate, padding, false, columns_from(0, {&filtered}))) continue;
      pieces.emplace_back(filtered.middleCols(3 * n, n));
      rows += *left;
    }
  }
  if (rows == 0) return {};
  Matrix all(rows, n);
  Index row = 0;
  for (const Matrix& piece : pieces) {
    all.middleRows(row, piece.rows()) = piece;
    row += piece.rows();
  }
  return (all.rowwise() - all.colwise().mean()).colwise().squaredNorm().transpose() / static_cast<double>(rows);
}

/// Exclusions of the operator: excluded windows are cut out of the plan in default mode; the published procedure uses
/// its whole window, with a warning.
Result<void> heed_exclusions(const Recording& recording, const Clock& clock, const Preparation& how, WindowPlan& plan,
                             std::vector<Warning>& warnings) {
  if (const std::string why = why_excluded(recording); !why.empty()) {
    warnings.push_back(
        {WarningCode::excluded_trial, fmt::format("the operator excluded this trial: {}", why), "omit the recording"});
  }
  const auto windows = excluded_windows(recording);
  if (!windows) {
    warnings.push_back({WarningCode::excluded_window, windows.error().message + ", so nothing was omitted",
                        windows.error().remedy + "; or omit them with --from and --to"});
    return {};
  }
  const double origin = recording.time[0];
  const bool displacements = how.protocol == Protocol::underdamped;
  if (how.mode != Mode::reference) return leave_out(*windows, clock, origin, displacements, plan);
  WindowPlan without = plan;
  const bool left = leave_out(*windows, clock, origin, displacements, without).has_value();
  if (left && without.excluded.empty()) return {};
  warnings.push_back({WarningCode::excluded_window,
                      fmt::format("the operator excluded part of the analysed interval, but reference mode uses the "
                                  "whole published window: {}",
                                  excluded_windows_text(*windows)),
                      "use default mode, which omits it, or choose --from and --to outside it"});
  return {};
}

}  // namespace

Result<PreparedTrial> prepare(const Recording& recording, const Inspection& inspection, const Options& options,
                              const VirtualForce* computed) {
  MBK_TRY(check_choices(options));
  const bool published = options.mode == Mode::reference;
  const Index samples = recording.samples();
  MBK_TRY(check_length(samples, inspection));
  const Hertz rate(inspection.rate_hz);
  const Clock clock(recording.time, rate);
  MBK_TRY(check_missing(clock, inspection.missing, options.window));

  PreparedTrial trial;
  trial.sources = recording.sources;
  trial.notes = recording.notes;
  trial.warnings = recording.warnings;
  trial.recorded_handle_mass = recorded_handle_mass(recording);
  trial.conditions = {recording.noted("participant"), recording.noted("condition"), recording.noted("posture")};
  trial.recording_duration = inspection.duration + inspection.interval_median;
  Preparation& how = trial.preparation;
  how.mode = options.mode;
  how.procedure = options.procedure.value_or(Procedure::chapter3);
  how.cut_before_filter = !published;
  how.acceleration_from_sensor =
      options.acceleration.value_or(published && options.procedure == Procedure::chapter5
                                        ? AccelerationSource::sensor
                                        : AccelerationSource::derivative) == AccelerationSource::sensor;

  how.force_source = options.force_source;
  auto signals = MBK_TRY(select_signals(recording, options.axes, how.acceleration_from_sensor));
  if (computed != nullptr && computed->sensitivity.size() > 0) {
    signals.force_sensitivity = computed->sensitivity;
    trial.robot_covariance = options.robot->covariance;
  }
  trial.axes = signals.axes;
  trial.motion = signals.motion;

  const ProtocolFinding found = detect_protocol(signals.reference);
  how.protocol = options.protocol.value_or(found.protocol);
  how.protocol_rule = options.protocol ? "given" : found.rule;
  if (how.protocol != Protocol::free && signals.reference.size() == 0) {
    return bad_data(fmt::format("protocol '{}' needs the reference, channel '{}', which is missing",
                                word_of(how.protocol), kReferenceChannels.name(trial.axes, 0)),
                    "name it with --channels, or use --protocol free");
  }

  if (how.protocol != Protocol::free) {
    MBK_TRY(check_reference(clock, signals, options.window));
  }

  FilterPlan filters = reference_filters(options);
  auto plan = MBK_TRY(published ? reference_windows(how.protocol, signals.reference, clock, options.window,
                                                    filters.smoothing.half_window())
                                : default_windows(how.protocol, signals.reference, clock, options.window));
  const std::vector<Cut> whole = plan.cuts;
  MBK_TRY(heed_exclusions(recording, clock, how, plan, trial.warnings));
  MBK_TRY(check_clock(clock, inspection, plan, trial.warnings));
  MBK_TRY(check_finite(clock, signals, plan, recording.warnings));
  MBK_TRY(check_alive(signals, plan));
  warn_of_small_motion(signals, plan, trial.warnings);
  warn_of_lost_contact(clock, signals, plan, trial.warnings);

  const bool by_reference = how.protocol == Protocol::sinusoidal;
  const auto band = MBK_TRY(by_reference ? excited_band(signals.reference, whole, rate)  // known where the limb is not
                                         : excited_band(signals.position, plan.cuts, rate));
  if (!published) {
    Index shortest = samples;
    for (const Cut& cut : plan.cuts) shortest = std::min(shortest, cut.end - cut.begin);
    filters = improved_filters(options, band, rate, shortest);
  }

  const bool with_reference = options.instruments && signals.reference.size() > 0;
  Index total = 0;
  std::vector<Index> rows_of_cuts;
  for (const Cut& cut : plan.cuts) {
    const auto rows = MBK_TRY(filtered_rows(cut, filters, plan.trim, options.padding));
    rows_of_cuts.push_back(rows);
    total += rows;
  }

  const Index n = trial.axes, lost = filters.smoothing.half_window() + plan.trim;
  const Index every = filters.every;
  trial.recording_rate = rate.value;
  trial.sample_time = static_cast<double>(every) / rate.value;
  trial.time.resize(total);
  for (Matrix* signal : {&trial.position, &trial.velocity, &trial.acceleration, &trial.force_hand_on_robot}) {
    signal->resize(total, n);
  }
  if (signals.reference.size() > 0) trial.reference.resize(total, n);
  if (with_reference) trial.reference_motion.resize(total, 3 * n);
  trial.force_sensitivity.resize(signals.force_sensitivity.size() > 0 ? total : 0, signals.force_sensitivity.cols());
  trial.reference_quantity = signals.reference_quantity;
  Index row = 0;
  for (std::size_t k = 0; k < plan.cuts.size(); ++k) {
    const Cut& cut = plan.cuts[k];
    const Index rows = rows_of_cuts[k], first = cut.begin + lost;
    const auto to = columns_from(row, {&trial.position, &trial.velocity, &trial.acceleration,
                                       &trial.force_hand_on_robot, &trial.reference_motion, &trial.force_sensitivity});
    MBK_TRY(filter_cut(signals, cut, filters, plan.trim, rate, options.padding, with_reference, to));
    const auto kept = Eigen::seqN(first, rows, every);
    trial.time.segment(row, rows) = recording.time(kept);
    for (Index axis = 0; axis < trial.reference.cols(); ++axis) {
      trial.reference.col(axis).segment(row, rows) = signals.reference.col(axis)(kept);
    }
    append_segments(cut, first, every, row, rows, trial.segments);
    row += rows;
  }
  trial.time.array() -= recording.time[0];
  if (samples > recording::kLong) recording::DiskPages().take(trial);
  if (trial.segments.empty()) return bad_data("no sample is left after filtering", "record longer");
  if (how.protocol == Protocol::underdamped) {
    trial.force_variance_at_rest = variance_at_rest(signals, plan, filters, rate, options.padding);
  }

  how.window_rule = plan.rule;
  how.from_s = trial.time[trial.segments.front().begin];
  how.to_s = trial.time[trial.segments.back().end - 1];
  how.split_s = plan.split_s;
  how.perturbations = static_cast<int>(how.protocol == Protocol::underdamped ? trial.segments.size() : 1);
  how.smoothing_order = filters.smoothing.order;
  how.smoothing_window = filters.smoothing.window;
  how.cutoff = filters.cutoff;
  how.cutoff_rule = filters.rule;
  how.every = every;
  how.band_low = band.low;
  how.band_high = band.high;
  return trial;
}

}  // namespace mbk::preprocess
