#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/model/robot/mechanism.h"

namespace mbk::robot {

struct ChainParts;

/// Bodies of any serial robot, read from a URDF: revolute, continuous and prismatic joints from a base link to a tip
/// link; links fixed to a moving link form one body with it. Ten coefficients φ for each body, named after its link,
/// in the link's frame and about its origin, which is where URDF puts the joint:
///   LINK.mass m [kg], LINK.mass_x, _y, _z: m c [kg·m], LINK.inertia_xx, _xy, _xz, _yy, _yz, _zz: Ī [kg·m²]
/// Frames, twists and wrenches are orocos-kdl's.
class SerialChain : public Mechanism {
 public:
  enum class Axis { x, y, z };

  struct Options {
    std::string base_link;                             ///< empty: the root of the tree
    std::string tip_link;                              ///< empty: the only leaf of the tree
    Eigen::Vector3d gravity = {0.0, 0.0, -9.81};       ///< acceleration of free fall, base frame [m/s²]
    std::vector<Axis> hand_axes = {Axis::x, Axis::y};  ///< of the base frame, along which the hand is measured
    Eigen::Vector3d tool = {0.0, 0.0, 0.0};            ///< the hand from the tip link, tip frame [m]
    std::vector<double> zero;  ///< the URDF's coordinate where the recording's is 0 [rad or m]; empty: 0 for all
    std::vector<int> sign;     ///< +1 or −1: the URDF's coordinate is zero + sign · the recording's; empty: +1
  };

  /// A moving joint, in the coordinate of the recording.
  struct Joint {
    std::string name;
    std::string link;  ///< the link that it moves, which names the coefficients of its body
    bool slides = false;
    JointRange range;       ///< infinite for a continuous joint
    double damping = 0.0;   ///< that the URDF states [N·m·s/rad or N·s/m]
    double friction = 0.0;  ///< that the URDF states [N·m or N]
  };

  /// Joints that branch off between base and tip, or follow the tip, are fixed at zero.
  /// @fails  data: it is not a URDF; a joint on the way is planar, floating or a mimic joint, has an axis of zero
  /// length, or limits without range; a moving body has no `<inertial>` or a non-finite number; the number of moving
  /// joints is not 1 … kMaxJoints; a link has two parents; several leaves and no tip_link.   usage: a link is unknown,
  /// the tip is not a descendant of the base; hand_axes are not one to three different ones; zero or sign does not fit
  /// the joints; a number is not finite.
  [[nodiscard]] static Result<std::shared_ptr<const SerialChain>> from_urdf(std::string_view urdf,
                                                                            const Options& options);

  explicit SerialChain(std::unique_ptr<const ChainParts> parts);
  ~SerialChain() override;

  [[nodiscard]] const std::vector<Joint>& joint_descriptions() const;
  /// Links with a physically impossible inertia, one sentence each.
  [[nodiscard]] const std::vector<std::string>& impossible() const;
  /// Links at both ends, after defaults.
  [[nodiscard]] const std::string& base_link() const;
  [[nodiscard]] const std::string& tip_link() const;

  [[nodiscard]] int joints() const override;
  [[nodiscard]] std::string joint_name(int joint) const override;
  [[nodiscard]] std::vector<std::string> joint_names() const override;
  [[nodiscard]] JointRange joint_range(int joint) const override;
  [[nodiscard]] bool slides(int joint) const override;
  [[nodiscard]] int hand_axes() const override;
  [[nodiscard]] const std::vector<Coefficient>& coefficients() const override;
  /// The pseudo-inertia of each body, by its link.
  [[nodiscard]] std::vector<PhysicalCondition> physical_conditions() const override;
  /// The φ that the URDF states.
  [[nodiscard]] const Vector& stated_coefficients() const override;
  void regressor(const JointVector& position, const JointVector& velocity, const JointVector& acceleration,
                 Eigen::Ref<Matrix> Y) const override;
  [[nodiscard]] JointTerms terms(const JointVector& position, const JointVector& velocity,
                                 const Vector& phi) const override;
  [[nodiscard]] HandVector hand_position(const JointVector& position) const override;
  [[nodiscard]] HandJacobian jacobian(const JointVector& position) const override;
  [[nodiscard]] HandJacobian jacobian_across(const JointVector& position) const override;
  [[nodiscard]] std::string hand_axis_name(int axis) const override;
  [[nodiscard]] HandJacobian jacobian_rate(const JointVector& position, const JointVector& velocity) const override;
  [[nodiscard]] Result<void> check_joints(const JointVector& position) const override;
  /// A continuous joint is spread over one turn; fewer points per joint if there would be more than 50 000.
  [[nodiscard]] std::vector<JointVector> postures(int per_joint) const override;

 private:
  [[nodiscard]] HandJacobian jacobian_along(const std::vector<int>& axes, const JointVector& position) const;

  std::unique_ptr<const ChainParts> parts_;
};

}  // namespace mbk::robot
