#include "mbk/simulate/laboratory/make_load.h"

#include "mbk/simulate/laboratory/spring_rig.h"

namespace mbk::laboratory {
namespace {

using participant::Load;

/// Nothing at the handle.
class EmptyHandle : public Load<2> {
 public:
  [[nodiscard]] participant::LoadDynamics<2> dynamics(const participant::HandState<2>& /*hand*/) const override {
    return {};
  }
  [[nodiscard]] impedance::Model impedance(const Vector2d& hand) const override {
    return {Matrix2d::Zero(), Matrix2d::Zero(), Matrix2d::Zero(), hand};
  }
};

/// Each plan of LoadPlan<Axes> has its operator.
template <int Axes>
struct MakeLoad {
  using Made = Result<std::unique_ptr<Load<Axes>>>;
  const Scenario& scenario;
  const SimulatedTrial<Axes>& trial;

  template <class Kind>
  static Made owned(Result<Kind> load, const char* section) {
    if (!load) return tl::unexpected(load.error().in(section));
    return std::make_unique<Kind>(std::move(*load));
  }

  Made operator()(const NoLoad& /*nothing*/) const { return std::make_unique<EmptyHandle>(); }

  Made operator()(participant::OneAxisJoint::Options joint) const {
    joint.seed = scenario.seed;
    return owned(participant::OneAxisJoint::create(joint, 1.0 / scenario.rate.value), "participant");
  }

  Made operator()(participant::ArmOptions arm) const {
    arm.seed = scenario.seed;
    auto made = participant::Arm::create(arm, 1.0 / scenario.rate.value);
    if (!made || !trial.grip) return owned(std::move(made), "participant");
    return owned(participant::CompliantGrip::create(*trial.grip, std::move(*made)), "participant.grip");
  }

  Made operator()(const participant::ToneRobot::Options& tone) const {
    return owned(participant::ToneRobot::create(tone), "participant");
  }

  Made operator()(const RigPlan& rig) const {
    if (!rig.springs.empty()) {
      const auto angles = robot::joint_angles(trial.robot.robot.geometry, trial.home);
      if (!angles) return tl::unexpected(angles.error().in("home"));
      return owned(SpringRig::create(rig.springs, rig.mass, rig.damping, (*angles)[1], trial.home), "rig");
    }
    const impedance::Model field{rig.mass * Matrix2d::Identity(), rig.damping, rig.stiffness, rig.equilibrium};
    return owned(participant::LinearLimb::create(field), "rig");
  }
};

}  // namespace

template <int Axes>
Result<std::unique_ptr<Load<Axes>>> make_load(const Scenario& scenario, const SimulatedTrial<Axes>& trial) {
  return std::visit(MakeLoad<Axes>{scenario, trial}, trial.load);
}

template Result<std::unique_ptr<Load<1>>> make_load(const Scenario&, const SimulatedTrial<1>&);
template Result<std::unique_ptr<Load<2>>> make_load(const Scenario&, const SimulatedTrial<2>&);

}  // namespace mbk::laboratory
