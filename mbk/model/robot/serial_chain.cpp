#include "mbk/model/robot/serial_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <kdl/rotationalinertia.hpp>
#include <numbers>

#include "mbk/model/robot/chain_parts.h"
#include "mbk/model/robot/rigid_body.h"

namespace mbk::robot {
namespace {

using KDL::Frame;
using KDL::Twist;
using KDL::Wrench;

constexpr auto kMax = static_cast<std::size_t>(kMaxJoints);

/// One body while a recursion runs from base to tip: everything in its frame, at its origin.
struct Motion {
  Twist velocity;
  Twist acceleration;            ///< spatial, less gravity
  std::array<Twist, kMax> axes;  ///< ∂(twist)/∂q̇_j for the joints j up to it

  /// From the body before to that of joint i, with the joint at q and moving with q̇ and q̈.
  void pass(const ChainJoint& joint, std::size_t i, double q, double dq, double ddq) {
    const Frame pose = joint.pose(q);
    for (std::size_t j = 0; j < i; ++j) axes[j] = pose.Inverse(axes[j]);
    axes[i] = joint.subspace();
    const Twist own = axes[i] * dq;
    velocity = pose.Inverse(velocity) + own;
    acceleration = pose.Inverse(acceleration) + axes[i] * ddq + velocity * own;  // KDL's * of twists: spatial ×
  }
};

/// The standard parameters of a body, as wrench of a twist.
struct Body {
  double mass;
  KDL::Vector first_moment;
  KDL::RotationalInertia inertia;

  explicit Body(const double* phi)
      : mass(phi[0]), first_moment(phi[1], phi[2], phi[3]), inertia(phi[4], phi[7], phi[9], phi[5], phi[6], phi[8]) {}

  /// I s = [m v + ω × h; Ī ω + h × v]
  Wrench operator*(const Twist& s) const {
    return {mass * s.vel + s.rot * first_moment, inertia * s.rot + first_moment * s.vel};  // KDL's * of vectors: ×
  }
};

/// Joint axes and the origins on them, base frame.
struct Lines {
  std::array<KDL::Vector, kMax> axis, origin;
  KDL::Vector hand;

  Lines(const ChainParts& parts, const JointVector& position) {
    Frame body;
    for (std::size_t i = 0; i < parts.joints.size(); ++i) {
      body = body * parts.joints[i].pose(position[static_cast<Index>(i)]);
      axis[i] = body.M * parts.joints[i].axis;
      origin[i] = body.p;
    }
    hand = body * parts.hand;
  }
};

HandVector along(const std::vector<int>& axes, const KDL::Vector& v) {
  HandVector kept(static_cast<Index>(axes.size()));
  for (std::size_t k = 0; k < axes.size(); ++k) kept[static_cast<Index>(k)] = v[axes[k]];
  return kept;
}

}  // namespace

Result<std::shared_ptr<const SerialChain>> SerialChain::from_urdf(std::string_view urdf, const Options& options) {
  auto parts = chain_from_urdf(urdf, options);
  if (!parts) return tl::unexpected(parts.error());
  return std::make_shared<const SerialChain>(std::make_unique<const ChainParts>(*std::move(parts)));
}

SerialChain::SerialChain(std::unique_ptr<const ChainParts> parts) : parts_(std::move(parts)) {}
SerialChain::~SerialChain() = default;

const std::vector<SerialChain::Joint>& SerialChain::joint_descriptions() const {
  return parts_->descriptions;
}
const std::string& SerialChain::base_link() const {
  return parts_->base_link;
}
const std::string& SerialChain::tip_link() const {
  return parts_->tip_link;
}

int SerialChain::joints() const {
  return static_cast<int>(parts_->joints.size());
}
std::string SerialChain::joint_name(int joint) const {
  return parts_->descriptions[static_cast<std::size_t>(joint)].name;
}
std::vector<std::string> SerialChain::joint_names() const {
  std::vector<std::string> names;
  for (const Joint& joint : parts_->descriptions) names.push_back(joint.name);
  return names;
}
JointRange SerialChain::joint_range(int joint) const {
  return parts_->descriptions[static_cast<std::size_t>(joint)].range;
}
bool SerialChain::slides(int joint) const {
  return parts_->joints[static_cast<std::size_t>(joint)].slides;
}
int SerialChain::hand_axes() const {
  return static_cast<int>(parts_->hand_axes.size());
}
const std::vector<Coefficient>& SerialChain::coefficients() const {
  return parts_->coefficients;
}
std::vector<PhysicalCondition> SerialChain::physical_conditions() const {
  std::vector<PhysicalCondition> all;
  const auto bodies = static_cast<Index>(parts_->joints.size());
  for (Index body = 0; body < bodies; ++body) {
    PhysicalCondition one{parts_->descriptions[static_cast<std::size_t>(body)].link,
                          Matrix::Zero(16, bodies * kCoefficientsPerBody), true};
    for (Index k = 0; k < kCoefficientsPerBody; ++k) {
      one.A.col(body * kCoefficientsPerBody + k) =
          pseudo_inertia(Eigen::Matrix<double, kCoefficientsPerBody, 1>::Unit(k)).reshaped();
    }
    all.push_back(std::move(one));
  }
  return all;
}
const std::vector<std::string>& SerialChain::impossible() const {
  return parts_->impossible;
}

const mbk::Vector& SerialChain::stated_coefficients() const {
  return parts_->stated;
}

/// The wrench that moves a body, with c = v̇ + ω × v of its origin less gravity and α = ω̇ (Newton–Euler; its linear form
/// as Atkeson, An & Hollerbach 1986):
///   f = m c + α × h + ω × (ω × h),   n = Ī α + ω × Ī ω + h × c
/// and its part along a joint's twist [u; w] is u·f + w·n, sorted here by what multiplies m, h and Ī.
void SerialChain::regressor(const JointVector& position, const JointVector& velocity, const JointVector& acceleration,
                            Eigen::Ref<Matrix> Y) const {
  Y.setZero();
  Motion body;
  body.acceleration.vel = -parts_->gravity;
  for (std::size_t i = 0; i < parts_->joints.size(); ++i) {
    const auto row = static_cast<Index>(i);
    body.pass(parts_->joints[i], i, position[row], velocity[row], acceleration[row]);
    const KDL::Vector &w = body.velocity.rot, &a = body.acceleration.rot;
    const KDL::Vector c = body.acceleration.vel + w * body.velocity.vel;
    for (std::size_t j = 0; j <= i; ++j) {
      const KDL::Vector &along = body.axes[j].vel, &about = body.axes[j].rot;
      const KDL::Vector h = along * a + w * (w * along) + c * about;
      const KDL::Vector b = about * w;
      const auto mixed = [&](int p, int q) { return about[p] * a[q] + about[q] * a[p] + b[p] * w[q] + b[q] * w[p]; };
      Y.block<1, kCoefficientsPerBody>(static_cast<Index>(j), row * kCoefficientsPerBody) << dot(along, c), h[0], h[1],
          h[2], 0.5 * mixed(0, 0), mixed(0, 1), mixed(0, 2), 0.5 * mixed(1, 1), mixed(1, 2), 0.5 * mixed(2, 2);
    }
  }
}

/// I_jk = Σ s_jᵀ I_i s_k and g_j = Σ s_jᵀ I_i a_g over the bodies i beyond both joints; and since turning joint k moves
/// what lies before it, as seen from body i, by −s_k×:
///   (Cᵀ q̇)_k = ½ ∂(q̇ᵀ I q̇)/∂q_k = Σ_{i ≥ k} (I_i v_i)·(v_k × s_k)
JointTerms SerialChain::terms(const JointVector& position, const JointVector& velocity, const mbk::Vector& phi) const {
  const Index n = joints();
  JointTerms terms{JointMatrix::Zero(n, n), JointVector::Zero(n), JointVector::Zero(n)};
  Motion body;
  Twist weight(-parts_->gravity, KDL::Vector::Zero());
  std::array<Twist, kMax> drift;  // v_k × s_k
  for (Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const ChainJoint& joint = parts_->joints[at];
    const Frame pose = joint.pose(position[i]);
    weight = pose.Inverse(weight);
    for (std::size_t k = 0; k < at; ++k) drift[k] = pose.Inverse(drift[k]);
    body.pass(joint, at, position[i], velocity[i], 0.0);
    drift[at] = body.velocity * body.axes[at];
    const Body mass(phi.data() + i * kCoefficientsPerBody);
    const Wrench momentum = mass * body.velocity, held = mass * weight;
    for (Index k = 0; k <= i; ++k) {
      const auto kth = static_cast<std::size_t>(k);
      const Wrench moved = mass * body.axes[kth];
      for (Index j = 0; j <= i; ++j) terms.inertia(j, k) += dot(body.axes[static_cast<std::size_t>(j)], moved);
      terms.gravity[k] += dot(body.axes[kth], held);
      terms.coriolis_transposed[k] += dot(drift[kth], momentum);
    }
  }
  return terms;
}

HandVector SerialChain::hand_position(const JointVector& position) const {
  return along(parts_->hand_axes, Lines(*parts_, position).hand);
}

HandJacobian SerialChain::jacobian_along(const std::vector<int>& axes, const JointVector& position) const {
  const Lines lines(*parts_, position);
  HandJacobian J(static_cast<Index>(axes.size()), joints());
  for (std::size_t i = 0; i < parts_->joints.size(); ++i) {
    const KDL::Vector column =
        slides(static_cast<int>(i)) ? lines.axis[i] : lines.axis[i] * (lines.hand - lines.origin[i]);
    J.col(static_cast<Index>(i)) = along(axes, column);
  }
  return J;
}

HandJacobian SerialChain::jacobian(const JointVector& position) const {
  return jacobian_along(parts_->hand_axes, position);
}

HandJacobian SerialChain::jacobian_across(const JointVector& position) const {
  return jacobian_along(parts_->other_axes, position);
}

std::string SerialChain::hand_axis_name(int axis) const {
  return std::string(1, "xyz"[parts_->hand_axes[static_cast<std::size_t>(axis)]]);
}

HandJacobian SerialChain::jacobian_rate(const JointVector& position, const JointVector& velocity) const {
  const Lines lines(*parts_, position);
  const std::size_t n = parts_->joints.size();
  std::array<KDL::Vector, kMax> axis_rate, origin_rate;
  KDL::Vector turning, moving, before;  // ω, velocity and place of the origin, of the body before
  for (std::size_t i = 0; i < n; ++i) {
    const double rate = velocity[static_cast<Index>(i)];
    axis_rate[i] = turning * lines.axis[i];
    moving += turning * (lines.origin[i] - before);
    if (slides(static_cast<int>(i))) {
      moving += lines.axis[i] * rate;
    } else {
      turning += lines.axis[i] * rate;
    }
    origin_rate[i] = moving;
    before = lines.origin[i];
  }
  const KDL::Vector hand_rate = moving + turning * (lines.hand - before);
  HandJacobian rate(hand_axes(), joints());
  for (std::size_t i = 0; i < n; ++i) {
    KDL::Vector column = axis_rate[i];
    if (!slides(static_cast<int>(i))) {
      column = axis_rate[i] * (lines.hand - lines.origin[i]) + lines.axis[i] * (hand_rate - origin_rate[i]);
    }
    rate.col(static_cast<Index>(i)) = along(parts_->hand_axes, column);
  }
  return rate;
}

Result<void> SerialChain::check_joints(const JointVector& position) const {
  constexpr double kOnTheLimit = 1e-9;  // [rad or m]
  double worst = kOnTheLimit;
  std::string message;
  for (Index i = 0; i < position.size(); ++i) {
    const Joint& joint = parts_->descriptions[static_cast<std::size_t>(i)];
    const double q = position[i];
    const char* unit = joint.slides ? "m" : "rad";
    if (!std::isfinite(q)) return bad_data(fmt::format("joint {} is at {}", joint.name, q), "repair the recording");
    if (joint.range.low - q > worst) {
      worst = joint.range.low - q;
      message = fmt::format("joint {} at {:.4g} {} is {:.3g} {} below its limit", joint.name, q, unit, worst, unit);
    }
    if (q - joint.range.high > worst) {
      worst = q - joint.range.high;
      message = fmt::format("joint {} at {:.4g} {} is {:.3g} {} above its limit", joint.name, q, unit, worst, unit);
    }
  }
  if (message.empty()) return {};
  return bad_data(message, "check the units, signs and zeros of the joints, or the limits in the URDF");
}

std::vector<JointVector> SerialChain::postures(int per_joint) const {
  constexpr double kMaxPostures = 50'000.0;
  const Index n = joints();
  const auto root = static_cast<int>(std::pow(kMaxPostures, 1.0 / static_cast<double>(n)) + 1e-9);
  const int steps = std::max(1, std::min(per_joint, root));
  const auto at = [&](Index i, int step) {
    const JointRange range = joint_range(static_cast<int>(i));
    if (!std::isfinite(range.high - range.low)) return 2.0 * std::numbers::pi * step / steps - std::numbers::pi;
    const double along = steps == 1 ? 0.5 : step / (steps - 1.0);
    return range.low + along * (range.high - range.low);
  };
  std::vector<JointVector> all;
  std::vector<int> step(static_cast<std::size_t>(n), 0);
  for (;;) {
    JointVector q(n);
    for (Index i = 0; i < n; ++i) q[i] = at(i, step[static_cast<std::size_t>(i)]);
    all.push_back(q);
    std::size_t digit = 0;
    while (digit < step.size() && ++step[digit] == steps) step[digit++] = 0;
    if (digit == step.size()) return all;
  }
}

}  // namespace mbk::robot
