#include "mbk/measure/measurement/measure_movement.h"

#include <fmt/format.h>

#include <utility>

#include "mbk/files/recording/inspect.h"
#include "mbk/measure/analyse/plausible_scale.h"
#include "mbk/measure/preprocess/exclusions.h"
#include "mbk/measure/preprocess/jittered_clock.h"
#include "mbk/measure/preprocess/recording_checks.h"
#include "mbk/measure/preprocess/trial_clock.h"
#include "mbk/measure/preprocess/windows.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::measurement {
namespace movement_detail {

Motion motion_of(const Recording& recording, int axes) {
  if (axes > 1) return Motion::translation;
  const std::string& unit = recording.find(kPositionChannels.one_axis)->unit;
  return unit == "rad" ? Motion::rotation : unit == "m" ? Motion::translation : Motion::unknown;
}

/// The rows where all of them stand in the recording and are finite; else none.
Matrix rows_where_finite(const Recording& recording, const QuantityChannels& quantity, int axes, Index begin,
                         Index rows) {
  const Columns columns = channels_of(recording, quantity, axes);
  if (columns.cols() == 0) return {};
  Matrix values = columns.middle_rows(begin, rows);
  return values.allFinite() ? values : Matrix();
}

/// Whether the reference is where the hand should be.
bool is_place(const Recording& recording, int axes) {
  const Channel* reference = recording.find(kReferenceChannels.name(axes, 0));
  const Channel* position = recording.find(kPositionChannels.name(axes, 0));
  return reference != nullptr && reference->unit == position->unit;
}

}  // namespace movement_detail

Result<MovementQuality> movement_quality(const Recording& recording, const MovementQualityOptions& options) {
  using namespace movement_detail;
  MBK_TRY(preprocess::check_consent(recording));
  Inspection inspection = recording::inspect(recording);
  auto even = preprocess::reclocked(recording, inspection, options.resample);
  if (!even) return tl::unexpected(even.error());
  std::vector<Warning> warnings;
  if (even->warning) warnings.push_back(std::move(*even->warning));
  if (even->recording) inspection = recording::inspect(*even->recording);
  const Recording* const source = even->recording ? &*even->recording : &recording;
  if (source->samples() < 3 || !(inspection.rate_hz > 0.0)) {
    return bad_data(fmt::format("{} samples cannot show a movement", source->samples()), "record longer");
  }
  const int axes = options.axes != 0 ? options.axes : channels_of(*source, kPositionChannels, 2).cols() == 2 ? 2 : 1;
  preprocess::Signals signals;
  signals.axes = axes;
  signals.position = channels_of(*source, kPositionChannels, axes);
  if (signals.position.cols() == 0) {
    return bad_data(fmt::format("channel '{}' is missing", kPositionChannels.name(axes, 0)), "name it with --channels");
  }
  const preprocess::Clock clock(source->time, Hertz(inspection.rate_hz));
  MBK_TRY(preprocess::check_missing(clock, inspection.missing, options.window));
  const auto plan = MBK_TRY(preprocess::default_windows(Protocol::free, {}, clock, options.window));
  MBK_TRY(preprocess::check_clock(clock, inspection, plan, warnings));
  MBK_TRY(preprocess::check_finite(clock, signals, plan, recording.warnings));
  const preprocess::Cut& cut = plan.cuts.front();
  const Index rows = cut.end - cut.begin;
  const Matrix target =
      is_place(*source, axes) ? rows_where_finite(*source, kReferenceChannels, axes, cut.begin, rows) : Matrix();
  auto found = analyse::movement_quality(signals.position.middle_rows(cut.begin, rows),
                                         rows_where_finite(*source, kForceChannels, axes, cut.begin, rows), target,
                                         clock.rate(), options.movement);
  if (!found) return tl::unexpected(found.error());
  found->motion = motion_of(*source, axes);
  found->from_s = clock.seconds(cut.begin);
  found->to_s = clock.seconds(cut.end);
  for (Reach& reach : found->reaches) {
    reach.begin_s += found->from_s;
    reach.end_s += found->from_s;
  }
  if (!recording.sources.empty()) found->source = recording.sources.front();
  found->notes = recording.notes;
  if (auto size = analyse::check_size(*source, inspection)) warnings.push_back(std::move(*size));
  found->warnings = std::move(warnings);
  found->warnings.insert(found->warnings.end(), recording.warnings.begin(), recording.warnings.end());
  return found;
}

}  // namespace mbk::measurement
