#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/numeric/definite_least_squares.h"
#include "mbk/base/numeric/independent_columns.h"
#include "mbk/model/robot/dynamic_model.h"

namespace mbk::identify {

/// What a free fit knows of a robot.
struct FreeFit {
  robot::DynamicModel model;            ///< parameters θ: those that are fixed, and where known others to be near to
  std::vector<Index> fixed;             ///< coefficients that keep their value
  numeric::IndependentColumns columns;  ///< of those that are not fixed: the base parameters β = C θ
  Vector base;                          ///< β̂
  Matrix triangle;  ///< R: the torques of β explain worse than those of β̂ by |R (β − β̂)|², in the residual's variance
  Vector typical;  ///< p: the size at which a coefficient alone would make torques as large as those measured
};

struct ConsistentParameters {
  Vector parameters;  ///< θ, p
  std::vector<robot::PhysicalCondition> conditions;
  numeric::DefiniteSolution solution;  ///< its matrices and pressures are those of `conditions`
  std::vector<std::string> replaced;   ///< links whose stated body cannot exist: another stood in for it
};

/// minimise ½ |R (C θ − β̂)|²  over the θ that meet every condition of model.physical_conditions(), and of those θ that
/// do so alike, to `gap` of that sum, the one nearest to the stated robot by the divergence of
/// numeric::solve_definite_program (Wensing, Kim & Slotine 2018; Lee & Park 2018).
/// The stated robot is model.parameters where they can exist, otherwise what the mechanism states, otherwise, body by
/// body, its mass and centre with moments that a body can have; a body without mass is a ball of 0.1 m about its joint,
/// as heavy as the data make all such balls together. A drive whose term is not stated is near 1 % of its typical size.
/// @fails usage: the model knows no conditions; a fixed value contradicts one by itself (it is named). data: no robot
/// that can exist has the values that are fixed. not usable: as numeric::solve_definite_program.
[[nodiscard]] Result<ConsistentParameters> nearest_robot(const FreeFit& free);

}  // namespace mbk::identify
