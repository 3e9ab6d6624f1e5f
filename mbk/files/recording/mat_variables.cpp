#include "mbk/files/recording/mat_variables.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/channel_table.h"

namespace mbk::recording {
namespace {

/// 1-based row of a channel in `logs`; 0: it has none.
int logs_row(const Channel& channel) {
  const auto kind = std::ranges::find(channel_kinds(), channel.name, &ChannelKind::name);
  return kind == channel_kinds().end() ? 0 : kind->logs_row;
}

bool fits_logs(const Recording& recording) {
  return std::ranges::all_of(recording.channels, [](const Channel& channel) {
    return logs_row(channel) > 0 && !channel.values.array().isNaN().all();
  });
}

Matrix logs_of(const Recording& recording) {
  Matrix logs = Matrix::Constant(kLogsRows, recording.samples(), std::numeric_limits<double>::quiet_NaN());
  logs.row(0) = recording.time.transpose();
  for (const Channel& channel : recording.channels) logs.row(logs_row(channel) - 1) = channel.values.transpose();
  return logs;
}

}  // namespace

MatVariable::Structure structure_of(const std::vector<Event>& events) {
  const auto count = static_cast<Index>(events.size());
  Matrix times(count, 1), values(count, 1);
  MatVariable::Cells names;
  for (Index k = 0; k < count; ++k) {
    const Event& event = events[static_cast<std::size_t>(k)];
    times(k, 0) = event.time;
    values(k, 0) = event.value;
    names.push_back(event.name);
  }
  return {{"time", std::move(times)}, {"name", std::move(names)}, {"value", std::move(values)}};
}

Result<std::vector<MatVariable>> mat_variables(const Recording& recording) {
  const auto metadata = MBK_TRY(metadata_to_write(recording));
  std::vector<MatVariable> variables;
  if (fits_logs(recording)) {
    variables.push_back({"logs", logs_of(recording)});
  } else {
    variables.push_back({"time", Matrix(recording.time)});
    for (const Channel* const channel : in_order(recording.channels)) {
      if (!is_matlab_name(channel->name)) {
        return bad_data(fmt::format("channel name '{}' is not a valid MATLAB variable name", channel->name));
      }
      variables.push_back({channel->name, Matrix(channel->values)});
    }
  }
  if (!metadata.empty()) {
    MatVariable::Structure fields;
    for (const auto& [key, value] : metadata) fields.push_back({key, value});
    variables.push_back({"metadata", std::move(fields)});
  }
  if (!recording.events.empty()) variables.push_back({"events", structure_of(recording.events)});
  return variables;
}

}  // namespace mbk::recording
