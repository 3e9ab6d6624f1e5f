#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/numeric/definite_least_squares.h"
#include "mbk/base/numeric/independent_columns.h"
#include "mbk/model/robot/dynamic_model.h"

namespace mbk::identify {

/// Result of a free fit of a robot.
struct FreeFit {
  robot::DynamicModel model;            ///< parameters θ: fixed ones and, if known, nominal values of others
  std::vector<Index> fixed;             ///< coefficients that keep their value
  numeric::IndependentColumns columns;  ///< of those that are not fixed: the base parameters β = C θ
  Vector base;                          ///< β̂
  Matrix triangle;  ///< R: β increases the sum of squares over β̂ by |R (β − β̂)|², relative to the residual variance
  Vector typical;  ///< p: the size at which a coefficient alone would cause torques as large as the measured ones
};

struct ConsistentParameters {
  Vector parameters;  ///< θ, p
  std::vector<robot::PhysicalCondition> conditions;
  numeric::DefiniteSolution solution;  ///< its matrices and pressures are those of `conditions`
  std::vector<std::string> replaced;   ///< links whose stated body is physically impossible and was replaced
};

/// minimise ½ |R (C θ − β̂)|²  over the θ that meet every condition of model.physical_conditions(), and of those θ that
/// do so equally well, within `gap` of that sum, the one nearest to the stated robot by the divergence of
/// numeric::solve_definite_program (Wensing, Kim & Slotine 2018; Lee & Park 2018).
/// The stated robot is model.parameters if they are physically possible, otherwise the statement of the mechanism,
/// otherwise, body by body, its mass and centre with possible moments; a body without mass is a ball of 0.1 m around
/// its joint, with the mass that fits the data for all such balls. A drive term that is not stated is near 1 % of its
/// typical size.
/// @fails usage: the model has no conditions; a fixed value violates one alone (it is named). data: the fixed values
/// are physically inconsistent. not usable: as numeric::solve_definite_program.
[[nodiscard]] Result<ConsistentParameters> nearest_robot(const FreeFit& free);

}  // namespace mbk::identify
