#include "mbk/measure/explore/servo_displacement.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mbk/measure/explore/motion_share.h"
#include "mbk/measure/explore/stiffness_regression.h"

namespace mbk::explore {

Result<ServoDisplacementStiffness> servo_displacement_stiffness(std::span<const RecordedReach> undisturbed,
                                                                std::span<const DisplacedReach> displaced,
                                                                double sample_time,
                                                                const ServoDisplacementOptions& options) {
  const auto prediction = MBK_TRY(ReachPrediction::create(undisturbed, sample_time, options.prediction));
  const auto from = static_cast<Index>(std::llround(options.from / sample_time)),
             to = static_cast<Index>(std::llround(options.to / sample_time));
  if (!(from >= 0 && to - from >= 4 && to <= prediction.future_rows())) {
    return bad_usage(fmt::format("the plateau from {:g} ms to {:g} ms after the trigger is not within the prediction",
                                 1e3 * options.from, 1e3 * options.to));
  }
  std::vector<DisplacedHand> hands;
  MotionShare motion;
  for (const DisplacedReach& one : displaced) {
    const RecordedReach& reach = one.reach;
    if (reach.trigger + to > reach.position.rows() || reach.force_hand_on_robot.rows() != reach.position.rows()) {
      return bad_data("a displaced reach ends before its plateau, or has no force");
    }
    const auto predicted = MBK_TRY(prediction.predict(reach));
    if (predicted.force_hand_on_robot.size() == 0) return bad_data("the undisturbed reaches have no force");
    const Index rows = to - from;
    const Matrix away =
        reach.position.middleRows(reach.trigger + from, rows) - predicted.position.middleRows(from, rows);
    const Matrix force = reach.force_hand_on_robot.middleRows(reach.trigger + from, rows) -
                         predicted.force_hand_on_robot.middleRows(from, rows);
    hands.push_back({static_cast<double>(reach.trigger) * sample_time, 0, one.commanded,
                     away.colwise().mean().transpose(), -force.colwise().mean().transpose()});
    motion.add(away, sample_time, one.commanded);
  }
  auto fit = MBK_TRY(regress_stiffness(hands));
  ServoDisplacementStiffness found;
  found.by.fit = std::move(fit);
  found.by.components = prediction.components();
  found.by.prediction_error = prediction.left_out_error()[(from + to) / 2];
  found.by.motion_share = motion.value();
  found.verdict = judge_stiffness(found.by.fit, found.by.motion_share);
  return found;
}

}  // namespace mbk::explore
