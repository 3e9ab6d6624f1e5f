#include "mbk/measure/identify/stacked_dynamics.h"

namespace mbk::identify {

StackedDynamics stack_rows(const std::vector<PreparedDynamics>& trials, std::optional<Purpose> purpose) {
  StackedDynamics stack;
  Index total = 0;
  for (const PreparedDynamics& trial : trials) {
    for (const Segment& segment : trial.segments) {
      if (!purpose || segment.purpose == *purpose) total += segment.size();
    }
  }
  const Index n = trials.front().torque.cols(), p = trials.front().regressors.front().cols();
  const bool with_instruments = !trials.front().instruments.empty();
  stack.W.assign(static_cast<std::size_t>(n), Matrix(total, p));
  const bool with_smoothed = !trials.front().smoothed.empty();
  if (with_instruments) stack.R = stack.W;
  if (with_smoothed) stack.S = stack.W;
  stack.torque.resize(total, n);
  stack.torque_rate.resize(total, n);
  Index row = 0;
  for (const PreparedDynamics& trial : trials) {
    for (const Segment& segment : trial.segments) {
      if (purpose && segment.purpose != *purpose) continue;
      const Index rows = segment.size();
      for (std::size_t joint = 0; joint < stack.W.size(); ++joint) {
        stack.W[joint].middleRows(row, rows) = trial.regressors[joint].middleRows(segment.begin, rows);
        if (with_instruments) {
          stack.R[joint].middleRows(row, rows) = trial.instruments[joint].middleRows(segment.begin, rows);
        }
        if (with_smoothed) stack.S[joint].middleRows(row, rows) = trial.smoothed[joint].middleRows(segment.begin, rows);
      }
      stack.torque.middleRows(row, rows) = trial.torque.middleRows(segment.begin, rows);
      stack.torque_rate.middleRows(row, rows) = trial.torque_rate.middleRows(segment.begin, rows);
      stack.ranges.push_back({row, row + rows});
      row += rows;
    }
  }
  return stack;
}

}  // namespace mbk::identify
