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
  bool delay = false;        ///< estimate what is left of the motors' delay too
  bool consistent = false;   ///< a robot that can exist, the nearest to the free fit (robot_consistency.h)
  double hac_lag_s = 1.0;    ///< reach of the residual's autocovariance in the standard errors [s], ≥ 0
};

/// The fit, and how far the delay that was assumed is from what these data say.
struct RobotFit {
  RobotIdentification identification;
  double delay_correction = 0;  ///< to be added to model.delay [s]; 0 where it was not asked for
};

/// τ_j = W_j θ + e_j over all joints, each weighted by 1/σ_j of its own residual until that settles, over all trials in
/// one fit. Of the base parameters of the robot (base_parameters.h), columns that the data do not identify (distance
/// below 10⁻⁶ of their length from the span of those before) are left out too, and said to be part of those that stay.
/// Standard errors: Newey–West with the joints' residuals together, widened as in newey_west_widening. The delay enters
/// as δ τ̇ and is linearised: fit again with the torque shifted by it. With instruments R: θ = (Σ R_jᵀW_j/σ_j²)⁻¹ Σ
/// R_jᵀτ_j/σ_j² (Janot et al. 2014), which noise of the measured motion does not bias as long as it is not in R.
/// Where it is to be consistent, the free fit is followed by nearest_robot, with R of the regressors (of the
/// instruments where there are some): for least squares these are the constrained ones of the same rows, at the delay
/// of the free fit. Standard errors and covariance stay those of the free fit, of the combinations that the data
/// decide.
/// @param model  its bodies, drives and delay; of its parameters, those that are fixed count
/// @param held_out  whole recordings that only judge; where there are none, the validation segments of `trials` do
/// @fails  no trial; trials of different robots or rates; too few rows; a value is not finite; nothing is excited; as
/// nearest_robot where it is to be consistent.
[[nodiscard]] Result<RobotFit> fit_robot(const std::vector<PreparedDynamics>& trials,
                                         const std::vector<PreparedDynamics>& held_out,
                                         const robot::DynamicModel& model, const RobotFitOptions& options);

}  // namespace mbk::identify
