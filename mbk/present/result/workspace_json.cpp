#include "mbk/base/core/units.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/present/result/json.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;
using document::through;

namespace robot {

void describe(Fields<Margin>& fields) {
  using From = const Margin&;
  fields.type("RobotMargin", "Margin to a limit of the joints.");
  fields.add("quantity", &Margin::quantity);
  fields.add_number(
      "limit_deg", [](From margin) { return kDegrees * margin.limit; }, "[°]");
  fields.add_choice("kind", &Margin::upper, "most", "least");
  fields.add(
      "left_deg", [](From margin) { return kDegrees * margin.left(); }, "[°]");
}

void describe(Fields<Posture>& fields) {
  using From = const Posture&;
  fields.type("RobotPosture", "The robot at one hand position.");
  fields.add("hand_m", &Posture::hand, "base frame [m]");
  fields.add(
      "theta_deg", [](From posture) -> Vector { return kDegrees * posture.theta; }, "[°]");
  fields.add("jacobian_m", &Posture::jacobian, "[m]");
  fields.add("manipulability_m2", &Posture::manipulability, "[m²]");
  fields.add("margins", &Posture::margins);
  const auto inertia = [](Fields<Posture>& part) {
    const auto felt = [](From posture) { return impedance::ellipse(posture.inertia_at_hand); };
    part.add("matrix", &Posture::inertia_at_hand);
    part.add("eigenvalues", [felt](From posture) {
      const impedance::Ellipse ellipse = felt(posture);
      return std::pair(ellipse.lambda_min, ellipse.lambda_max);
    });
    part.add(
        "orientation_deg", [felt](From posture) { return kDegrees * felt(posture).orientation; }, "[°]");
  };
  fields.group("inertia_at_hand_kg", inertia, "[kg]");
}

}  // namespace robot

namespace result {
namespace {

struct WorkspaceDocument {
  const robot::Workspace& workspace;
  const std::optional<robot::Posture>& posture;

  [[nodiscard]] const robot::JointLimits& limits() const { return workspace.geometry.limits; }
};

void describe(Fields<WorkspaceDocument>& fields) {
  using From = const WorkspaceDocument&;
  fields.type("Workspace", "Output of `mbk robot workspace --json`: the workspace of the hand.");
  fields.header("mbk.workspace/1");
  fields.add(
      "links_m", [](From one) { return std::pair(one.workspace.geometry.d1, one.workspace.geometry.d2); }, "[m]");
  const auto limits = [](Fields<WorkspaceDocument>& part) {
    const auto degrees = [](double low, double high) { return std::pair(kDegrees * low, kDegrees * high); };
    part.add("theta1", [=](From one) { return degrees(one.limits().theta1_low, one.limits().theta1_high); });
    part.add("theta2", [=](From one) { return degrees(one.limits().theta2_low, one.limits().theta2_high); });
    part.add_number("smallest_opening", [](From one) { return kDegrees * one.limits().smallest_opening; });
  };
  fields.group("limits_deg", limits, "[°]");
  fields.add(
      "x_m", [](From one) { return std::pair(one.workspace.low.x(), one.workspace.high.x()); }, "[m]");
  fields.add(
      "y_m", [](From one) { return std::pair(one.workspace.low.y(), one.workspace.high.y()); }, "[m]");
  fields.add(
      "area_m2", [](From one) { return one.workspace.area; }, "[m²]");
  fields.add(
      "outline_m", [](From one) { return one.workspace.outline; }, "base frame [m]");
  fields.add("at", [](From one) { return one.posture; });
}

}  // namespace

std::string to_json(const robot::Workspace& workspace, const std::optional<robot::Posture>& posture) {
  return document::document(WorkspaceDocument{workspace, posture});
}

void add_workspace_schema(document::Schemas& schemas) {
  schemas["workspace"] = document::schema_of<WorkspaceDocument>();
}

}  // namespace result
}  // namespace mbk
