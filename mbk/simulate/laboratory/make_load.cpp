#include "mbk/simulate/laboratory/make_load.h"

#include "mbk/simulate/laboratory/spring_rig.h"

namespace mbk::laboratory {
namespace {

using participant::Load;

/// Nothing at the handle.
class EmptyHandle : public Load {
 public:
  [[nodiscard]] participant::LoadDynamics dynamics(const participant::HandState& /*hand*/) const override { return {}; }
  [[nodiscard]] impedance::Model impedance(const Vector2d& hand) const override {
    return {Matrix2d::Zero(), Matrix2d::Zero(), Matrix2d::Zero(), hand};
  }
};

template <class Kind>
Result<std::unique_ptr<Load>> owned(Result<Kind> load, const char* section) {
  if (!load) return tl::unexpected(load.error().in(section));
  return std::make_unique<Kind>(std::move(*load));
}

struct MakeLoad {
  const Scenario& scenario;
  const PlanarTrial& trial;

  Result<std::unique_ptr<Load>> operator()(const NoLoad& /*nothing*/) const { return std::make_unique<EmptyHandle>(); }

  Result<std::unique_ptr<Load>> operator()(participant::ArmOptions arm) const {
    arm.seed = scenario.seed;
    return owned(participant::Arm::create(arm, 1.0 / scenario.rate.value), "participant");
  }

  Result<std::unique_ptr<Load>> operator()(const participant::ToneRobot::Options& tone) const {
    return owned(participant::ToneRobot::create(tone), "participant");
  }

  Result<std::unique_ptr<Load>> operator()(const RigPlan& rig) const {
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

Result<std::unique_ptr<participant::Load>> make_load(const Scenario& scenario, const PlanarTrial& trial) {
  return std::visit(MakeLoad{scenario, trial}, trial.load);
}

}  // namespace mbk::laboratory
