#include "mbk/validate/simulated_trials.h"

#include <fmt/format.h>

#include <numbers>

#include "mbk/validate/each_run.h"

namespace mbk::validation {
namespace {

double handle_mass(const laboratory::Scenario& scenario) {
  const auto* planar = std::get_if<laboratory::PlanarTrial>(&scenario.trial);
  return planar == nullptr ? 0.0 : planar->robot.handle_mass;
}

Result<SimulatedTrial> run(const TrialPlan& plan) {
  const auto performance = MBK_TRY(laboratory::simulate(plan.scenario));
  SimulatedTrial trial{performance.energy_absorbed, performance.truth, {}};
  if (!plan.measurement) return trial;
  measurement::Options options = *plan.measurement;
  options.passivity = false;
  options.identify.handle_mass = handle_mass(plan.scenario);
  auto measured = MBK_TRY(measurement::measure({&performance.recording, 1}, options));
  trial.identification = std::move(measured.identification);
  return trial;
}

}  // namespace

Result<std::vector<laboratory::Scenario>> ready(std::string_view name) {
  const auto* scenario = laboratory::find_ready_scenario(name);
  if (scenario == nullptr) return bad_usage(fmt::format("there is no ready scenario '{}'", name));
  return laboratory::read_scenarios(scenario->text, std::string(name) + ".toml");
}

Result<laboratory::Scenario> with_limb(laboratory::Scenario scenario, int number) {
  const auto limb = MBK_TRY(participant::participant_limb(number));
  auto& arm = std::get<participant::ArmOptions>(std::get<laboratory::PlanarTrial>(scenario.trial).load);
  std::get<participant::TwoLinkArm::Options>(arm.limb).joints = limb.joints;
  return scenario;
}

void perturb_along_a_diagonal(laboratory::Scenario& scenario) {
  perturbation::RandomBinaryPlan plan;
  plan.quantity = perturbation::Quantity::position;
  plan.sequence.amplitude = 0.008;
  plan.angle = std::numbers::pi / 4.0;
  scenario.perturbation.kind = plan;
}

Result<std::vector<SimulatedTrial>> run_trials(const std::vector<TrialPlan>& plans, const StudyOptions& options) {
  return each_run(options, static_cast<int>(plans.size()),
                  [&](int i) { return run(plans[static_cast<std::size_t>(i)]); });
}

std::pair<std::string, std::string> rig_names(const std::string& trial) {
  const auto cut = trial.find("_M");
  if (cut == std::string::npos) return {trial, trial};
  return {trial.substr(0, cut), trial.substr(cut + 1)};
}

measurement::Options mass_and_springs() {
  measurement::Options options;
  options.identify.structure = Structure::mass_spring;
  return options;
}

Chart identified_against_true(std::string title, const std::string& unit) {
  Chart chart;
  chart.title = std::move(title);
  chart.x = {"true", unit};
  chart.y = {"identified", unit};
  chart.identity = true;
  return chart;
}

}  // namespace mbk::validation
