#include "mbk/measurement/compute_force.h"

#include <cmath>
#include <string>

#include "mbk/analyse/force_comparison.h"
#include "mbk/preprocess/resample.h"
#include "mbk/preprocess/signals.h"
#include "mbk/preprocess/virtual_force.h"
#include "mbk/recording/inspection.h"

namespace mbk::measurement {
namespace {

/// The samples [first, last) of everything.
void cut_to(Recording& recording, Index first, Index last) {
  recording.time = Vector(recording.time.segment(first, last - first));
  for (Channel& channel : recording.channels) channel.values = Vector(channel.values.segment(first, last - first));
}

Result<ComputedForce> compute(const Recording& recording, const Options& options) {
  const Inspection inspection = recording::inspect(recording);
  auto force = preprocess::virtual_force(recording, inspection, *options.preprocess.robot, options.preprocess);
  if (!force) return tl::unexpected(force.error());
  const int axes = options.preprocess.robot->mechanism->hand_axes();
  const Index rows = force->last - force->first;
  ComputedForce made;
  made.summary.source = options.preprocess.force_source;
  made.summary.lag = force->lag;
  analyse::ForcePair pair{Matrix(rows, axes), Matrix(), force->joint_velocity.middleRows(force->first, rows)};
  for (Index axis = 0; axis < axes; ++axis) {
    const std::string name = preprocess::channel_name(preprocess::Quantity::force, axes, axis);
    const Channel& computed = *force->recording.find(name);
    pair.estimated.col(axis) = computed.values.segment(force->first, rows);
    const std::string unit = computed.unit;
    const auto add = [&](const std::string& extra, const Vector& values) {
      force->recording.channels.push_back({extra, unit, "base", values});
    };
    if (force->sensor_force.size() > 0) add("sensor_" + name, force->sensor_force.col(axis));
    if (force->standard_error.size() > 0) {
      const std::string error = axes == 1 ? name + "_error" : "force_error" + name.substr(name.find('_'));
      add(error, force->standard_error.col(axis));
    }
  }
  made.summary.rms = pair.estimated.colwise().norm().transpose() / std::sqrt(static_cast<double>(rows));
  made.summary.peak = pair.estimated.cwiseAbs().colwise().maxCoeff().transpose();
  if (force->standard_error.size() > 0) {
    made.summary.standard_error = force->standard_error.middleRows(force->first, rows).colwise().norm().transpose() /
                                  std::sqrt(static_cast<double>(rows));
  }
  if (force->sensor_force.size() > 0) {
    auto smoothed = force->smoothed(force->sensor_force, Hertz(inspection.rate_hz));
    if (!smoothed) return tl::unexpected(smoothed.error());
    pair.measured = std::move(*smoothed);
    auto comparison = analyse::compare_forces({pair}, 1.0 / inspection.rate_hz);
    if (!comparison) return tl::unexpected(comparison.error());
    made.summary.comparison = std::move(*comparison);
  }
  made.recording = std::move(force->recording);
  made.summary.sources = made.recording.sources;
  made.summary.notes = made.recording.notes;
  cut_to(made.recording, force->first, force->last);
  return made;
}

}  // namespace

Result<ComputedForce> compute_force(const Recording& recording, const Options& options) {
  if (!options.resample) return compute(recording, options);
  const auto even = preprocess::resample(recording, *options.resample);
  if (!even) return tl::unexpected(even.error());
  return compute(*even, options);
}

}  // namespace mbk::measurement
