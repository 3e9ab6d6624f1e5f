#include "mbk/present/result/robot_description_json.h"

#include <algorithm>
#include <cmath>

#include "mbk/present/result/json_parts.h"

namespace mbk::result {
namespace {

Json joints_json(const robot::Mechanism& mechanism) {
  Json joints = Json::array();
  for (int joint = 0; joint < mechanism.joints(); ++joint) {
    const robot::JointRange range = mechanism.joint_range(joint);
    joints.push_back({{"name", mechanism.joint_name(joint)},
                      {"slides", mechanism.slides(joint)},
                      {"limits", {number(range.low), number(range.high)}}});
  }
  return joints;
}

Json drives_json(const robot::DynamicModel& model) {
  const robot::DriveTerms& drive = model.drive;
  Json terms = Json::array();
  const std::pair<const char*, bool> all[] = {
      {"motor_inertia", drive.motor_inertia}, {"viscous", drive.viscous}, {"coulomb", drive.coulomb},
      {"stribeck", drive.stribeck},           {"cable", drive.cable},     {"offset", drive.offset}};
  for (const auto& [word, expected] : all) {
    if (expected) terms.push_back(word);
  }
  return {{"terms", terms},
          {"smoothing", number(drive.smoothing)},
          {"stribeck_velocity", number(drive.stribeck_velocity)},
          {"delay", number(model.delay)}};
}

}  // namespace

std::string to_json(const robot::RobotDescription& description, const numeric::IndependentColumns& base) {
  const robot::DynamicModel& model = description.model;
  const robot::Mechanism& mechanism = *model.mechanism;
  Json json = header("mbk.robot_description/1");
  json["file"] = description.source;
  json["joints"] = joints_json(mechanism);
  json["hand_axes"] = mechanism.hand_axes();
  json["hand_at_zero"] = list(mechanism.hand_position(robot::JointVector::Zero(mechanism.joints())));
  json["drive"] = drives_json(model);
  json["structural_rank"] = base.kept.size();
  json["coefficients"] = Json::array();
  const std::vector<robot::Coefficient> coefficients = model.coefficients();
  for (std::size_t j = 0; j < coefficients.size(); ++j) {
    const auto& [name, unit] = coefficients[j];
    const auto column = static_cast<Index>(j);
    const bool stated = std::ranges::find(description.unstated, name) == description.unstated.end();
    Json one = {{"name", name}, {"unit", unit}, {"value", stated ? number(model.parameters[column]) : Json(nullptr)}};
    if (std::ranges::find(base.kept, column) == base.kept.end()) {
      constexpr double kNone = 1e-6;
      one["part_of"] = Json::object();
      for (std::size_t k = 0; k < base.kept.size(); ++k) {
        const double factor = base.combination(static_cast<Index>(k), column);
        if (std::abs(factor) >= kNone) {
          one["part_of"][coefficients[static_cast<std::size_t>(base.kept[k])].name] = number(factor);
        }
      }
    }
    json["coefficients"].push_back(std::move(one));
  }
  json["impossible"] = description.impossible;
  return dumped(json);
}

}  // namespace mbk::result
