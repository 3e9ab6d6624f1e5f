#include "mbk/simulate/laboratory/simulation.h"

#include <utility>

namespace mbk::laboratory {
namespace {

/// Whoever reaches begins when the perturbation does: behind soft start, way to the test location and rest there.
void reach_after_settling(PlanarTrial& planar, const control::SequenceOptions& sequence) {
  auto* const arm = std::get_if<participant::ArmOptions>(&planar.load);
  if (arm == nullptr || !arm->reaching) return;
  arm->reaching->first += sequence.soft_start + sequence.shortest_move + sequence.settle;
}

class ScenarioSimulation : public protocol::Simulation {
 public:
  explicit ScenarioSimulation(Scenario scenario) : scenario_(std::move(scenario)) {}

  [[nodiscard]] Scenario scenario(const protocol::Trial& trial) const {
    Scenario scenario = scenario_;
    static_cast<protocol::TrialPlan&>(scenario) = trial;
    auto& planar = std::get<PlanarTrial>(scenario.trial);
    planar.robot.robot = trial.robot;
    planar.robot.handle_mass = trial.handle_mass;
    planar.home = trial.home;
    planar.control = trial.control;
    reach_after_settling(planar, trial.sequence);
    return scenario;
  }

  [[nodiscard]] Result<std::unique_ptr<device::Device>> robot(const protocol::Trial& trial) const override {
    auto made = MBK_TRY(SimulatedDevice::create(scenario(trial)));
    return std::unique_ptr<device::Device>(std::move(made));
  }

  [[nodiscard]] std::map<std::string, std::string> metadata(const protocol::Trial& trial) const override {
    return scenario_metadata(scenario(trial));
  }

 private:
  Scenario scenario_;  // planar
};

}  // namespace

Result<std::shared_ptr<const protocol::Simulation>> read_simulation(const config::Section& root,
                                                                    const protocol::Trial& /*trial*/) {
  return std::make_shared<const ScenarioSimulation>(read_scenario(root));
}

Result<Scenario> scenario_of(const protocol::Trial& trial) {
  const auto* simulation = dynamic_cast<const ScenarioSimulation*>(trial.simulation.get());
  if (simulation == nullptr) {
    return bad_usage("the trial has no scenario to simulate", "pass laboratory::read_simulation to read_experiment");
  }
  return simulation->scenario(trial);
}

Result<std::unique_ptr<SimulatedDevice>> simulated_robot(const protocol::Trial& trial) {
  const auto scenario = MBK_TRY(scenario_of(trial));
  return SimulatedDevice::create(scenario);
}

}  // namespace mbk::laboratory
