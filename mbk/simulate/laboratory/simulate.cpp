#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "mbk/simulate/laboratory/make_load.h"
#include "mbk/simulate/laboratory/truth_text.h"

namespace mbk::laboratory {
namespace {

template <int Axes>
Result<Performance> run(const SimulatedTrial<Axes>& trial, const Scenario& scenario, const SimulateOptions& options,
                        perturbation::Schedule schedule) {
  auto load = MBK_TRY(make_load(scenario, trial));
  Experiment<Axes> experiment{trial.robot,   trial.home,    std::move(schedule), trial.control, trial.sensors,
                              scenario.rate, scenario.seed, options.progress,    /*watch=*/{}};
  if constexpr (Axes == 2) experiment.watch = options.watch;
  return perform(experiment, *load);
}

/// The limb's force in space, with its impedance about home.
struct SpaceLimb {
  impedance::Model truth;
  HandForce force;
};

Result<SpaceLimb> make_limb(const SpaceTrial& trial) {
  using Hand = perturbation::Jet<perturbation::AxesVector>;
  if (const auto* model = std::get_if<impedance::Model>(&trial.limb)) {
    const Eigen::Matrix3d M = model->M, B = model->B, K = model->K;
    const Eigen::Vector3d x0 = model->x0;
    if (M != M.transpose()) return bad_usage("participant: the inertia of a limb must be symmetric");
    return SpaceLimb{*model, [=](const Hand& x) -> perturbation::AxesVector {
                       return -(M * x.second + B * x.first + K * (x.value - x0));
                     }};
  }
  auto arm = participant::SpatialArm::create(std::get<participant::SpatialArm::Options>(trial.limb), trial.home);
  if (!arm) return tl::unexpected(arm.error().in("participant"));
  return SpaceLimb{arm->impedance(trial.home),
                   [arm = *arm](const Hand& x) -> perturbation::AxesVector { return arm.force(x); }};
}

Result<Performance> run(const SpaceTrial& trial, const Scenario& scenario, const SimulateOptions& options,
                        perturbation::Schedule schedule) {
  const auto limb = MBK_TRY(make_limb(trial));
  const PrescribedMotion motion(trial.home, std::move(schedule));
  Performance result;
  const double interval = 1.0 / scenario.rate.value;
  const auto force = [&](const perturbation::Jet<perturbation::AxesVector>& hand) {
    const perturbation::AxesVector of_hand = limb.force(hand);
    const double power = of_hand.dot(hand.first);  // of the hand on the robot [W]
    result.energy_absorbed -= power * interval;
    result.energy_exchanged += std::abs(power) * interval;
    return of_hand;
  };
  result.recording = MBK_TRY(record(motion, force, trial.sensors, scenario.seed, scenario.rate));
  result.truth = limb.truth;
  result.recording.metadata.merge(truth_metadata(result.truth, scenario.rate, result.energy_absorbed));
  if (options.progress) options.progress(1.0);
  return result;
}

Result<Performance> run(const ElbowTrial& trial, const Scenario& scenario, const SimulateOptions& options,
                        const perturbation::Schedule& schedule) {
  auto result = record_elbow(trial, schedule, scenario.seed, scenario.rate);
  if (result && options.progress) options.progress(1.0);
  return result;
}

/// The arm at the handle, if there is one.
const participant::ArmOptions* arm_of(const Scenario& scenario) {
  const auto* planar = std::get_if<PlanarTrial>(&scenario.trial);
  return planar == nullptr ? nullptr : std::get_if<participant::ArmOptions>(&planar->load);
}

/// Lengths and position of a two-link arm: they can be measured, so they are not part of the hidden true values.
void add_geometry(const participant::ArmOptions& arm, std::map<std::string, std::string>& metadata) {
  const auto* limb = std::get_if<participant::TwoLinkArm::Options>(&arm.limb);
  if (limb == nullptr) return;
  metadata["shoulder_x_m"] = exact_text(limb->geometry.shoulder.x());
  metadata["shoulder_y_m"] = exact_text(limb->geometry.shoulder.y());
  metadata["upper_arm_m"] = exact_text(limb->geometry.upper_arm);
  metadata["forearm_m"] = exact_text(limb->geometry.forearm);
  metadata["elbow"] = "right";
}

/// Whether the scenario includes voluntary control.
bool has_will(const Scenario& scenario) {
  const auto* arm = arm_of(scenario);
  return arm != nullptr && (arm->controller.position_gain > 0.0 || arm->controller.force_gain > 0.0);
}

}  // namespace

Result<Performance> simulate(const Scenario& scenario, const SimulateOptions& options) {
  auto schedule = MBK_TRY(perturbation::make_schedule(scenario.perturbation, scenario.seed));
  auto performance =
      std::visit([&](const auto& trial) { return run(trial, scenario, options, std::move(schedule)); }, scenario.trial);
  if (!performance) return performance;
  performance->recording.metadata.merge(scenario_metadata(scenario));
  return performance;
}

std::map<std::string, std::string> scenario_metadata(const Scenario& scenario) {
  std::map<std::string, std::string> metadata;
  if (const auto* arm = arm_of(scenario)) add_geometry(*arm, metadata);
  metadata["truth_scenario"] = scenario.protocol;
  if (!scenario.name.empty()) metadata["truth_trial"] = scenario.name;
  if (!scenario.condition.empty()) metadata["truth_condition"] = scenario.condition;
  if (has_will(scenario)) metadata["truth_note"] = kTunedGains;
  metadata["truth_seed"] = std::to_string(scenario.seed);
  return metadata;
}

Recording without_truth(Recording recording) {
  std::erase_if(recording.metadata, [](const auto& entry) { return entry.first.starts_with("truth_"); });
  return recording;
}

}  // namespace mbk::laboratory
