#pragma once

#include <kdl/frames.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/model/robot/rigid_body.h"
#include "mbk/model/robot/serial_chain.h"

namespace mbk::robot {

/// A joint and the body beyond it. KDL::Joint caches its last angle in a const call, a data race between threads; so
/// the pose is computed here.
struct ChainJoint {
  KDL::Frame origin;  ///< of the joint at the recording's zero, from the frame of the body before
  KDL::Vector axis;   ///< unit, in the frame of its body; its sign is the recording's
  bool slides = false;

  /// Of the body, from the one before.
  [[nodiscard]] KDL::Frame pose(double position) const {
    if (slides) return {origin.M, origin.p + origin.M * (position * axis)};
    return {origin.M * KDL::Rotation::Rot2(axis, position), origin.p};
  }
  /// ∂(twist)/∂q̇ in the frame and at the origin of its body.
  [[nodiscard]] KDL::Twist subspace() const {
    return slides ? KDL::Twist(axis, KDL::Vector::Zero()) : KDL::Twist(KDL::Vector::Zero(), axis);
  }
};

/// Data of a SerialChain.
struct ChainParts {
  std::vector<ChainJoint> joints;
  KDL::Vector hand;     ///< from the last body, in its frame [m]
  KDL::Vector gravity;  ///< base frame [m/s²]
  std::vector<int> hand_axes, other_axes;
  std::vector<SerialChain::Joint> descriptions;
  std::vector<Coefficient> coefficients;
  Vector stated;
  std::vector<std::string> impossible;
  std::string base_link, tip_link;
};

/// @fails  as SerialChain::from_urdf.
[[nodiscard]] Result<ChainParts> chain_from_urdf(std::string_view urdf, const SerialChain::Options& options);

}  // namespace mbk::robot
