#pragma once

#include <span>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/explore/judge_stiffness.h"
#include "mbk/measure/explore/reach_prediction.h"
#include "mbk/model/trial/plateau_stiffness.h"
#include "mbk/model/trial/reach_stiffness.h"

namespace mbk::explore {

/// A reach whose hand a servo displaced from where it would have been, from the trigger on.
struct DisplacedReach {
  RecordedReach reach;
  Vector commanded;  ///< displacement on the plateau, n [m]
};

struct ServoDisplacementOptions {
  double from = 0.14, to = 0.2;  ///< the window on the plateau, after the trigger [s]
  ReachPredictionOptions prediction;
};

/// Stiffness of a hand while it moves.
struct ServoDisplacementStiffness {
  ReachPredictor by;
  StiffnessVerdict verdict;
};

/// Stiffness during a reach (Burdet, Osu, Franklin, Yoshioka, Milner & Kawato 2000): the hand is displaced by 8 mm
/// relative to a prediction of its own undisturbed trajectory, 100 ms out, 100 ms hold, 100 ms back. On the plateau the
/// displacement is at rest relative to the undisturbed reach, so that
///   d = x̄ − x̂,  f = −(F̄_h − F̂_h),  f = K d + e
/// with x̂ and F̂_h predicted from the reach's own past (ReachPrediction); options.prediction.max_components = 0
/// subtracts the mean of the undisturbed reaches instead, which is cruder.
/// @fails  usage: a window that is empty or ends behind the prediction. data: as ReachPrediction and regress_stiffness;
/// a displaced reach ends before the window does; undisturbed reaches without a force.
[[nodiscard]] Result<ServoDisplacementStiffness> servo_displacement_stiffness(
    std::span<const RecordedReach> undisturbed, std::span<const DisplacedReach> displaced, double sample_time,
    const ServoDisplacementOptions& options = {});

}  // namespace mbk::explore
