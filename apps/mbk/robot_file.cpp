#include "apps/mbk/robot_file.h"

#include <memory>

#include "apps/mbk/output.h"
#include "mbk/result/robot_json.h"
#include "mbk/robot/planar_mechanism.h"

namespace mbk::app {
namespace {

robot::DynamicModel thesis_robot() {
  const robot::PlanarRobot robot;
  robot::DynamicModel model;
  model.mechanism = std::make_shared<robot::PlanarMechanism>(robot::PlanarMechanism::Options());
  model.drive.coulomb = model.drive.offset = false;
  model.parameters = Vector(5);
  model.parameters << robot.inertia.alpha1, robot.inertia.alpha2, robot.inertia.alpha3, robot.friction[0].viscous,
      robot.friction[1].viscous;
  return model;
}

}  // namespace

Result<robot::DynamicModel> robot_of(const std::optional<std::filesystem::path>& file) {
  robot::DynamicModel model = thesis_robot();
  if (!file) return model;
  const auto text = read_text(*file);
  if (!text) return tl::unexpected(text.error());
  auto stored = result::robot_from_json(*text);
  if (!stored) return tl::unexpected(stored.error().in(file->string()));
  model.drive = stored->drive;
  model.parameters = stored->parameters;
  model.covariance = stored->covariance;
  model.delay = stored->delay;
  return model;
}

}  // namespace mbk::app
