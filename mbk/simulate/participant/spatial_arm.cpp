#include "mbk/simulate/participant/spatial_arm.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <utility>

namespace mbk::participant {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A segment relative to the body's mass and the segment's length (de Leva 1996, table 4, men).
struct Segment {
  double mass, centre;                 // centre from the proximal joint
  double sagittal, transverse, axial;  // radii of gyration
  double length;                       // [m]
};
constexpr Segment kUpperArm{0.0271, 0.5772, 0.285, 0.269, 0.158, 0.2817};
constexpr Segment kForearm{0.0162, 0.4574, 0.276, 0.265, 0.121, 0.2689};
constexpr Segment kHand{0.0061, 0.7900, 0.628, 0.513, 0.401, 0.0862};  // wrist to third knuckle

/// From the elbow to the centre of the hand [m].
constexpr double kElbowToGrip = kForearm.length + kHand.centre * kHand.length;

/// Below it the hand hardly determines the joints: the determinant of J relative to the cube of the arm's length.
constexpr double kSingular = 1e-3;

Result<void> check(const SpatialArm::Options& o, const Vector3d& home) {
  const std::pair<const char*, double> positive[] = {
      {"body mass", o.body_mass}, {"length of the upper arm", o.upper_arm}, {"length of the forearm", o.forearm}};
  for (const auto& [name, value] : positive) {
    if (!(value > 0.0 && std::isfinite(value))) return bad_usage(fmt::format("{} {} is not positive", name, value));
  }
  if (!o.posture.allFinite() || !std::isfinite(o.axial_rotation) || !o.damping.allFinite() ||
      !o.stiffness.allFinite() || !home.allFinite()) {
    return bad_usage("posture, joint matrices and home must be finite");
  }
  return {};
}

}  // namespace

SpatialArm::SpatialArm(const Options& options, const Vector3d& home)
    : options_(options), shoulder_(Vector3d::Zero()), q0_(options.posture) {
  const double forearm_scale = options.forearm / kElbowToGrip;
  const auto body = [&](const Segment& segment, double length, bool beyond_elbow, double distance) {
    const double mass = segment.mass * options.body_mass;
    const auto moment = [&](double radius) { return mass * std::pow(radius * length, 2); };
    return Body{beyond_elbow, mass, distance, moment(0.5 * (segment.sagittal + segment.transverse)),
                moment(segment.axial)};
  };
  const double forearm = forearm_scale * kForearm.length;
  bodies_ = {body(kUpperArm, options.upper_arm, false, kUpperArm.centre * options.upper_arm),
             body(kForearm, forearm, true, kForearm.centre * forearm),
             body(kHand, forearm_scale * kHand.length, true, options.forearm)};
  shoulder_ = home - hand_position(options.posture);
}

Result<SpatialArm> SpatialArm::create(const Options& options, const Vector3d& home) {
  MBK_TRY(check(options, home));
  SpatialArm arm(options, home);
  const double length = options.upper_arm + options.forearm;
  const double volume = arm.jacobian(arm.pose(options.posture), true, options.forearm).determinant();
  const Vector3d found = arm.joint_angles(home);
  constexpr double kSame = 1e-6;  // [rad]
  const auto turn = [](double angle) { return std::abs(std::remainder(angle, 2.0 * std::numbers::pi)); };
  const Vector3d away = (found - options.posture).unaryExpr(turn);
  if (!(std::abs(volume) > kSingular * length * length * length) || !(away.maxCoeff() < kSame)) {
    return bad_usage("the hand position does not determine this posture",
                     "bend the elbow by 0 to 180 degrees and keep the hand away from the vertical line through the "
                     "shoulder");
  }
  if (options.equilibrium) arm.q0_ = arm.joint_angles(*options.equilibrium);
  if (!arm.q0_.allFinite()) return bad_usage("the equilibrium is out of the arm's reach", "move it closer to home");
  return arm;
}

SpatialArm::Pose SpatialArm::pose(const Vector3d& q) const {
  const Vector3d z = Vector3d::UnitZ(), back = -Vector3d::UnitY();
  const Matrix3d plane = AngleAxisd(q[0], z).toRotationMatrix();
  const Matrix3d upper_arm = plane * AngleAxisd(q[1], back).toRotationMatrix();
  Pose at;
  at.axes.col(0) = z;
  at.axes.col(1) = plane * back;
  at.axes.col(2) = upper_arm * (AngleAxisd(options_.axial_rotation, z) * back);
  at.upper_arm = -upper_arm.col(2);
  at.forearm = AngleAxisd(q[2], at.axes.col(2)) * at.upper_arm;
  return at;
}

/// From the shoulder to a place on a link, at this distance from the link's joint.
Vector3d SpatialArm::place(const Pose& at, bool beyond_elbow, double distance) const {
  if (!beyond_elbow) return distance * at.upper_arm;
  return options_.upper_arm * at.upper_arm + distance * at.forearm;
}

/// Column i is a_i × (p − o_i).
Matrix3d SpatialArm::jacobian(const Pose& at, bool beyond_elbow, double distance) const {
  const Vector3d p = place(at, beyond_elbow, distance);
  Matrix3d J = Matrix3d::Zero();
  J.col(0) = at.axes.col(0).cross(p);
  J.col(1) = at.axes.col(1).cross(p);
  if (beyond_elbow) J.col(2) = at.axes.col(2).cross(distance * at.forearm);
  return J;
}

Vector3d SpatialArm::acceleration(const Pose& at, const Turning& turning, bool beyond_elbow, double distance) const {
  const auto of = [&](std::size_t link, const Vector3d& r) -> Vector3d {
    const Vector3d& w = turning.velocity[link];
    return turning.acceleration[link].cross(r) + w.cross(w.cross(r));
  };
  if (!beyond_elbow) return of(0, distance * at.upper_arm);
  return of(0, options_.upper_arm * at.upper_arm) + of(1, distance * at.forearm);
}

Vector3d SpatialArm::elastic_torque(const Vector3d& q) const {
  Vector3d away = q - q0_;
  away[0] = std::remainder(away[0], 2.0 * std::numbers::pi);
  return options_.stiffness * away;
}

Vector3d SpatialArm::hand_position(const Vector3d& q) const {
  return shoulder_ + place(pose(q), true, options_.forearm);
}

Vector3d SpatialArm::joint_angles(const Vector3d& hand) const {
  const double l1 = options_.upper_arm, l2 = options_.forearm, psi = options_.axial_rotation;
  const Vector3d p = hand - shoulder_;
  const double q3 = std::acos((p.squaredNorm() - l1 * l1 - l2 * l2) / (2.0 * l1 * l2));
  // The hand of the arm that hangs down, with this elbow; elevation turns its x and z, then the plane x and y
  const Vector3d hanging(l2 * std::sin(q3) * std::cos(psi), l2 * std::sin(q3) * std::sin(psi), -l1 - l2 * std::cos(q3));
  const double radius = std::hypot(hanging.x(), hanging.z());
  const double elevated = std::acos(-p.z() / radius);  // q₂ and what the elbow adds to it
  const double q2 = elevated - std::atan2(hanging.x(), -hanging.z());
  const double q1 = std::atan2(p.y(), p.x()) - std::atan2(hanging.y(), radius * std::sin(elevated));
  return {q1, q2, q3};
}

Vector3d SpatialArm::force(const perturbation::Jet<perturbation::AxesVector>& hand) const {
  const Vector3d q = joint_angles(hand.value);
  const Pose at = pose(q);
  const Matrix3d J_inverse = jacobian(at, true, options_.forearm).inverse();
  const Vector3d rate = J_inverse * hand.first;
  const auto turning = [&](const Vector3d& second) {
    Turning now;
    const Vector3d first_turn = rate[0] * at.axes.col(0), second_turn = rate[1] * at.axes.col(1);
    const Vector3d elbow_turn = rate[2] * at.axes.col(2);
    now.velocity[0] = first_turn + second_turn;
    now.velocity[1] = now.velocity[0] + elbow_turn;
    now.acceleration[0] = second[0] * at.axes.col(0) + second[1] * at.axes.col(1) + first_turn.cross(second_turn);
    now.acceleration[1] = now.acceleration[0] + second[2] * at.axes.col(2) + now.velocity[0].cross(elbow_turn);
    return now;
  };
  const Vector3d without = acceleration(at, turning(Vector3d::Zero()), true, options_.forearm);  // J̇ q̇
  const Turning now = turning(J_inverse * (Vector3d(hand.second) - without));

  Vector3d torque = options_.damping * rate + elastic_torque(q);
  for (const Body& body : bodies_) {
    const std::size_t link = body.beyond_elbow ? 1 : 0;
    const Vector3d& along = body.beyond_elbow ? at.forearm : at.upper_arm;
    const Matrix3d inertia =
        body.transverse * Matrix3d::Identity() + (body.axial - body.transverse) * along * along.transpose();
    const Vector3d& w = now.velocity[link];
    const Vector3d moment = inertia * now.acceleration[link] + w.cross(inertia * w);
    torque += jacobian(at, body.beyond_elbow, body.distance).transpose() * body.mass *
              acceleration(at, now, body.beyond_elbow, body.distance);
    for (Index i = 0; i < (body.beyond_elbow ? 3 : 2); ++i) torque[i] += at.axes.col(i).dot(moment);
  }
  return -J_inverse.transpose() * torque;
}

impedance::Model SpatialArm::impedance(const Vector3d& hand) const {
  const Vector3d q = joint_angles(hand);
  const Pose at = pose(q);
  const Matrix3d J_inverse = jacobian(at, true, options_.forearm).inverse();
  const Vector3d force = -J_inverse.transpose() * elastic_torque(q);

  Matrix3d inertia = Matrix3d::Zero();
  for (const Body& body : bodies_) {
    const Vector3d& along = body.beyond_elbow ? at.forearm : at.upper_arm;
    const Matrix3d J = jacobian(at, body.beyond_elbow, body.distance);
    Matrix3d turns = at.axes;
    if (!body.beyond_elbow) turns.col(2).setZero();
    const Vector3d axial = turns.transpose() * along;
    inertia += body.mass * J.transpose() * J + body.transverse * turns.transpose() * turns +
               (body.axial - body.transverse) * axial * axial.transpose();
  }
  // ∂²p/∂q_i∂q_j = a_i × (a_j × (p − o_j)), joint i not beyond joint j
  const Matrix3d J = jacobian(at, true, options_.forearm);
  Matrix3d geometric;
  for (Index j = 0; j < 3; ++j) {
    for (Index i = 0; i <= j; ++i) {
      geometric(i, j) = geometric(j, i) = force.dot(at.axes.col(i).cross(J.col(j)));
    }
  }
  impedance::Model model;
  model.M = J_inverse.transpose() * inertia * J_inverse;
  model.B = J_inverse.transpose() * options_.damping * J_inverse;
  const Matrix3d K = J_inverse.transpose() * (options_.stiffness + geometric) * J_inverse;
  model.K = K;
  model.x0 = hand + K.inverse() * force;
  return model;
}

}  // namespace mbk::participant
