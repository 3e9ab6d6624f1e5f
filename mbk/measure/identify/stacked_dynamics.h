#pragma once

#include <optional>
#include <vector>

#include "mbk/measure/identify/regression.h"
#include "mbk/model/trial/prepared_dynamics.h"

namespace mbk::identify {

/// Rows of all trials under each other, joint by joint.
struct StackedDynamics {
  std::vector<Matrix> W, R, S;  ///< N×p for each joint; R of the instruments, S of the smoothed motion, or empty
  Matrix torque, torque_rate;
  std::vector<RowRange> ranges;

  [[nodiscard]] Index rows() const { return torque.rows(); }
};

/// The rows of one purpose, or of both where none is named.
[[nodiscard]] StackedDynamics stack_rows(const std::vector<PreparedDynamics>& trials, std::optional<Purpose> purpose);

}  // namespace mbk::identify
