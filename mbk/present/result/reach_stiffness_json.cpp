#include "mbk/present/result/exploration_parts_json.h"

namespace mbk::result {
namespace reach_stiffness_detail {

Json predictor_json(const ReachPredictor& by) {
  return {{"components", by.components},
          {"prediction_error", number(by.prediction_error)},
          {"motion_share", number(by.motion_share)},
          {"stiffness", stiffness_regression_json(by.fit)}};
}

}  // namespace reach_stiffness_detail

Json reach_stiffness_json(const ReachStiffness& found) {
  using reach_stiffness_detail::predictor_json;
  return {{"trigger", found.trigger},
          {"window_s", {number(found.from_s), number(found.to_s)}},
          {"undisturbed", found.undisturbed},
          {"left_out", found.left_out},
          {"own_past", predictor_json(found.own_past)},
          {"mean_reach", predictor_json(found.mean_reach)},
          {"usable", found.usable}};
}

}  // namespace mbk::result
