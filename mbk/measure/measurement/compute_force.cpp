#include "mbk/measure/measurement/compute_force.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mbk/files/recording/inspect.h"
#include "mbk/measure/analyse/compare_forces.h"
#include "mbk/measure/preprocess/filters.h"
#include "mbk/measure/preprocess/resample.h"
#include "mbk/measure/preprocess/virtual_force.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::measurement {
namespace {

/// The samples [first, last) of everything.
void cut_to(Recording& recording, Index first, Index last) {
  recording.time = Vector(recording.time.segment(first, last - first));
  for (Channel& channel : recording.channels) channel.values = Vector(channel.values.segment(first, last - first));
}

/// Root mean square of each column.
Vector rms(const Matrix& values) {
  return values.colwise().norm().transpose() / std::sqrt(static_cast<double>(values.rows()));
}

/// "force_x" → "force_error_x"; "reaction" → "reaction_error".
std::string name_of_error(const std::string& force) {
  const std::size_t axis = force.find('_');
  return axis == std::string::npos ? force + "_error" : force.substr(0, axis) + "_error" + force.substr(axis);
}

Result<ComputedForce> compute(const Recording& recording, const Options& options) {
  const Inspection inspection = recording::inspect(recording);
  const Hertz rate(inspection.rate_hz);
  auto made = preprocess::virtual_force(recording, inspection, *options.preprocess.robot, options.preprocess);
  if (!made) return tl::unexpected(made.error());
  const int axes = options.preprocess.robot->mechanism->hand_axes();
  const bool sensed = made->sensor_force.size() > 0, sure = made->standard_error.size() == 0;
  const Index length = made->last - made->first;
  // [computed, of the sensor] through the filters of a measurement.
  Matrix forces(length, (sensed ? 2 : 1) * axes);
  std::vector<std::string> names;
  std::string unit;
  for (Index axis = 0; axis < axes; ++axis) {
    names.emplace_back(kForceChannels.name(axes, axis));
    const Channel& channel = *made->recording.find(names.back());
    unit = channel.unit;
    forces.col(axis) = channel.values.segment(made->first, length);
    if (sensed) forces.col(axes + axis) = made->sensor_force.col(axis).segment(made->first, length);
  }
  const auto filtered = MBK_TRY(preprocess::filter_values(forces, made->filters, rate, options.preprocess.padding));
  // A recording is smoothed only: whoever measures it has the low-pass still before him, for force and motion alike.
  preprocess::FilterPlan smoothing = made->filters;
  smoothing.cutoff.reset();
  const auto smoothed =
      MBK_TRY(preprocess::filter_values(forces.leftCols(axes), smoothing, rate, options.preprocess.padding));
  const Index first = made->first + made->filters.smoothing.half_window(), rows = filtered.rows();

  ComputedForce computed;
  computed.summary.source = options.preprocess.force_source;
  computed.summary.lag = made->lag;
  computed.summary.axes.clear();
  for (int axis = 0; axis < axes; ++axis) {
    computed.summary.axes.push_back(options.preprocess.robot->mechanism->hand_axis_name(axis));
  }
  if (options.preprocess.robot->mechanism->hand_turns()) computed.summary.unit = "N·m";
  computed.summary.rms = rms(filtered.leftCols(axes));
  computed.summary.peak = filtered.leftCols(axes).cwiseAbs().colwise().maxCoeff().transpose();
  if (!sure) computed.summary.standard_error = rms(made->standard_error.middleRows(first, rows));
  if (sensed) {
    auto comparison = MBK_TRY(analyse::compare_forces(
        {{filtered.leftCols(axes), filtered.rightCols(axes), made->joint_velocity.middleRows(first, rows)}},
        1.0 / rate.value));
    computed.summary.comparison = std::move(comparison);
  }
  computed.recording = std::move(made->recording);
  computed.summary.sources = computed.recording.sources;
  computed.summary.notes = computed.recording.notes;
  for (const Warning& warning : recording.warnings) computed.summary.notes.push_back(warning.message);
  cut_to(computed.recording, first, first + rows);
  std::vector<Channel>& channels = computed.recording.channels;
  for (Index axis = 0; axis < axes; ++axis) {
    const std::string& name = names[static_cast<std::size_t>(axis)];
    std::ranges::find(channels, name, &Channel::name)->values = smoothed.col(axis);
    if (sensed) channels.push_back({"sensor_" + name, unit, "base", made->sensor_force.col(axis).segment(first, rows)});
    if (!sure)
      channels.push_back({name_of_error(name), unit, "base", made->standard_error.col(axis).segment(first, rows)});
  }
  return computed;
}

}  // namespace

Result<ComputedForce> compute_force(const Recording& recording, const Options& options) {
  if (!options.resample) return compute(recording, options);
  const auto even = MBK_TRY(preprocess::resample(recording, *options.resample));
  return compute(even, options);
}

}  // namespace mbk::measurement
