#pragma once

#include <variant>

#include "mbk/base/core/axes.h"
#include "mbk/base/core/units.h"
#include "mbk/experiment/control/trial_control.h"
#include "mbk/model/perturbation/schedule.h"
#include "mbk/model/robot/one_axis_robot.h"

namespace mbk::laboratory {

/// The servo of a robot of one axis, which follows a schedule of positions:
///   u = K_p (r − x) + K_d (ṙ − ẋ)                                              [N·m or N]
struct ServoMode {
  double proportional = 800.0;   ///< K_p [N·m/rad or N/m] ≥ 0
  double derivative = 12.0;      ///< K_d ≥ 0
  Hertz velocity_cutoff{200.0};  ///< of the velocity estimate > 0
};

using OneAxisMode = std::variant<ServoMode, control::ForceMode>;

/// The counterpart of control::TrialControl for one axis: servo or open loop with a schedule, whose first axis is used.
/// After `create` nothing allocates.
class OneAxisControl {
 public:
  /// @param home  about which the schedule perturbs    @param sample_time  [s] > 0
  /// @fails  usage: mode and schedule refer to different quantities; a gain or the cutoff is out of its range.
  [[nodiscard]] static Result<OneAxisControl> create(const OneAxisMode& mode, const perturbation::Schedule& schedule,
                                                     const robot::OneAxisGeometry& geometry, const AxisVector<1>& home,
                                                     double sample_time);

  /// u [N·m or N] at the time t of the schedule [s].
  [[nodiscard]] AxisVector<1> torque(double t, const AxisVector<1>& measured) noexcept;

  /// The reference in the recording: the position, or the torque.
  [[nodiscard]] AxisVector<1> reference(double t) const noexcept;

 private:
  OneAxisControl(const OneAxisMode& mode, const perturbation::Schedule& schedule, double home, double sample_time);

  OneAxisMode mode_;
  perturbation::Schedule schedule_;
  double home_, sample_time_, memory_ = 0.0;  // of the velocity's low-pass
  double last_ = 0.0, velocity_ = 0.0;
  bool moved_ = false;
};

}  // namespace mbk::laboratory
