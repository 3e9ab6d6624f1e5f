#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/robot/dynamic_model.h"
#include "mbk/model/trial/prepared_dynamics.h"
#include "mbk/model/trial/robot_identification.h"

namespace mbk::identify {

struct RobotFitOptions {
  RobotMethod method = RobotMethod::weighted_least_squares;
  std::vector<Index> fixed;  ///< coefficients that keep the value they have in model.parameters
  bool delay = false;        ///< also estimate the remaining motor delay
  bool consistent = false;   ///< physically consistent robot nearest to the free fit (robot_consistency.h)
  double hac_lag_s = 1.0;    ///< noise correlation time in the standard errors [s], ≥ 0
};

/// The fit, and the correction of the assumed delay.
struct RobotFit {
  RobotIdentification identification;
  double delay_correction = 0;  ///< to be added to model.delay [s]; 0 if not requested
};

/// τ_j = W_j θ + e_j over all joints, each weighted by 1/σ_j of its own residual, iterated to convergence, over all
/// trials in one fit. Of the base parameters of the robot (base_parameters.h), columns that the data do not identify
/// (distance below 10⁻⁶ of their length from the span of those before) are omitted, too, and reported as part of the
/// kept ones. Standard errors: Newey–West with the joints' residuals together, widened as in newey_west_widening. The
/// delay enters as δ τ̇ and is linearised: fit again with the torque shifted by it. With instruments R: θ = (Σ
/// R_jᵀW_j/σ_j²)⁻¹ Σ R_jᵀτ_j/σ_j² (Janot et al. 2014), which noise of the measured motion does not bias as long as it
/// is not in R. With `consistent`, the free fit is followed by nearest_robot, with R of the regressors (of the
/// instruments, if any): for least squares this is constrained least squares on the same rows, at the delay of the free
/// fit. Standard errors and covariance are those of the free fit, for the identifiable combinations.
/// @param model  its bodies, drives and delay; only its fixed parameters are used
/// @param held_out  whole recordings used only for validation; if none, the validation segments of `trials`
/// @fails  no trial; trials of different robots or rates; too few rows; a value is not finite; nothing is excited; as
/// nearest_robot with `consistent`.
[[nodiscard]] Result<RobotFit> fit_robot(const std::vector<PreparedDynamics>& trials,
                                         const std::vector<PreparedDynamics>& held_out,
                                         const robot::DynamicModel& model, const RobotFitOptions& options);

}  // namespace mbk::identify
