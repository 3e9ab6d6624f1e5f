// Simulates a trial with your own participant and compares the measurement with the true values.
//   usage: simulate_a_participant
#include <cstdio>
#include <variant>
#include <vector>

#include "mbk/measure/measurement/measure.h"
#include "mbk/simulate/laboratory/scenario.h"

namespace {

int report(const mbk::Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  return 1;
}

}  // namespace

int main() {
  // Start from a built-in scenario; everything not changed here keeps the value in its file.
  const mbk::laboratory::ReadyScenario* const ready = mbk::laboratory::find_ready_scenario("relaxed_sinusoidal");
  if (ready == nullptr) return 1;
  auto scenarios = mbk::laboratory::read_scenarios(ready->text, "relaxed_sinusoidal.toml");
  if (!scenarios) return report(scenarios.error());
  mbk::laboratory::Scenario scenario = scenarios->front();

  // Participant 5 of the thesis holds the handle, with 0.2 N of slow force noise.
  auto arm = mbk::participant::participant_options(5);
  if (!arm) return report(arm.error());
  arm->remnant.floor = 0.2;  // [N]
  auto& trial = std::get<mbk::laboratory::PlanarTrial>(scenario.trial);
  auto& shown = std::get<mbk::participant::ArmOptions>(trial.load);
  auto& limb = std::get<mbk::participant::TwoLinkArm::Options>(arm->limb);
  limb.geometry = std::get<mbk::participant::TwoLinkArm::Options>(shown.limb).geometry;  // same seat as in the scenario
  trial.load = *arm;

  const auto performance = mbk::laboratory::simulate(scenario);
  if (!performance) return report(performance.error());
  std::printf("%.1f s, the limb absorbed %.2f J\n",
              static_cast<double>(performance->recording.samples()) / scenario.rate.value,
              performance->energy_absorbed);

  // The true values are in the metadata of the recording; the measurement does not read them.
  mbk::measurement::Options options;
  options.identify.handle_mass = 0.194;  // [kg], between sensor and hand
  const auto measured = mbk::measurement::measure(std::vector{performance->recording}, options);
  if (!measured) return report(measured.error());

  const mbk::impedance::Model& found = measured->identification.model;
  const mbk::impedance::Model& truth = performance->truth;
  const mbk::Vector error = measured->identification.covariance.diagonal().cwiseSqrt();
  const mbk::Vector found_values = mbk::impedance::stacked(found), true_values = mbk::impedance::stacked(truth);
  const std::vector<std::string> names = mbk::identify::parameter_names(2);
  const char* const units[] = {"kg", "N.s/m", "N/m", "m"};
  std::printf("        found     +-        truth\n");
  for (mbk::Index i = 0; i < found_values.size(); ++i) {
    std::printf("%-5s %9.4f %8.4f %9.4f  %s\n", names[static_cast<std::size_t>(i)].c_str(), found_values[i],
                1.96 * error[i], true_values[i], units[i / 4]);
  }
  for (const mbk::Warning& warning : measured->identification.warnings)
    std::printf("warning %s\n", warning.message.c_str());
  return measured->identification.usable ? 0 : 1;
}
