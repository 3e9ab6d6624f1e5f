#include "thesis/apparatus.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "mbk/base/numeric/parallel.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/measure/measurement/identify_robot.h"
#include "mbk/measure/preprocess/prepare_dynamics.h"
#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/validate/robot_trials.h"
#include "mbk/validate/simulated_trials.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

using robot::PlanarMechanism;
using validation::FrictionModel;

constexpr std::uint64_t kSeedStep = 1000;

robot::DynamicModel model_of(FrictionModel friction, PlanarMechanism::Coriolis coriolis) {
  PlanarMechanism::Options mechanism;
  mechanism.coriolis = coriolis;
  robot::DynamicModel model{std::make_shared<PlanarMechanism>(mechanism), validation::drive_terms(friction)};
  model.parameters = Vector::Zero(static_cast<Index>(model.coefficients().size()));
  return model;
}

/// Sampled from 12 s on, forty seconds to identify and ten to judge; W = 151 and 4.5 Hz (Dyck 2013, A.2 and §5.2.1).
preprocess::DynamicsOptions published_signals() {
  preprocess::DynamicsOptions options;
  options.signals.smoothing_window = 151;
  options.signals.cutoff = Hertz(4.5);
  options.signals.window = {12.0, 52.0, 62.0};
  return options;
}

Result<RobotIdentification> published(const Recording& recording, FrictionModel friction,
                                      PlanarMechanism::Coriolis coriolis = PlanarMechanism::Coriolis::skew) {
  measurement::RobotOptions options;
  options.preprocess = published_signals();
  options.fit.method = RobotMethod::least_squares;
  return measurement::identify_robot({&recording, 1}, {}, model_of(friction, coriolis), options);
}

Result<FreeMotion> identified(const Recording& recording) {
  auto viscous = MBK_TRY(published(recording, FrictionModel::viscous));
  auto full = MBK_TRY(published(recording, FrictionModel::full));
  auto by_default = MBK_TRY(validation::identified_robot(recording, FrictionModel::full));
  auto printed = MBK_TRY(published(recording, FrictionModel::full, PlanarMechanism::Coriolis::printed));
  return FreeMotion{std::move(viscous), std::move(full), std::move(by_default), std::move(printed)};
}

}  // namespace

std::uint64_t rig_seed(const Workbench& bench, const laboratory::Scenario& scenario) {
  return scenario.seed + kSeedStep * (bench.options().seed - 1);
}

std::string seed_option(const Workbench& bench, const laboratory::Scenario& scenario) {
  const std::uint64_t seed = rig_seed(bench, scenario);
  return seed == scenario.seed ? std::string() : fmt::format(" --seed {}", seed);
}

ReproducedTable claims_table(const char* id) {
  ReproducedTable table;
  table.id = id;
  table.provenance = Provenance::simulated;
  table.what_rows_are = "claim";
  table.columns = {{"the source", "", 0}, {"ours", "", 0}};
  return table;
}

void add_claim(ReproducedTable& table, const char* claim, std::string ours) {
  table.rows.push_back({claim, {words(std::move(ours))}});
}

Result<FreeMotions> make_free_motions(Workbench& bench) {
  const auto scenarios = MBK_TRY(validation::ready("free_motion"));
  FreeMotions all;
  all.trials.resize(kFreeMotions);
  MBK_TRY(numeric::parallel_for(kFreeMotions, bench.options().threads, [&](int i) -> Result<void> {
    laboratory::Scenario scenario = scenarios.front();
    scenario.seed = rig_seed(bench, scenario) + static_cast<std::uint64_t>(i);
    auto performance = MBK_TRY(laboratory::simulate(scenario));
    auto found = MBK_TRY(identified(performance.recording));
    all.trials[static_cast<std::size_t>(i)] = std::move(found);
    if (i == 0) all.first = std::move(performance.recording);
    return {};
  }));
  return all;
}

Result<PreparedDynamics> prepare_free_motion(const Recording& recording, const robot::DynamicModel& model) {
  return preprocess::prepare_dynamics(recording, recording::inspect(recording), model, published_signals());
}

Result<validation::Robots> identified_robots(Workbench& bench) {
  const auto scenarios = MBK_TRY(validation::ready("free_motion"));
  laboratory::Scenario scenario = scenarios.front();
  scenario.seed = rig_seed(bench, scenario);
  const auto performance = MBK_TRY(laboratory::simulate(scenario));
  validation::Robots robots;
  for (const FrictionModel friction : {FrictionModel::viscous, FrictionModel::full}) {
    auto found = MBK_TRY(published(performance.recording, friction));
    found.model.covariance.resize(0, 0);  // no interval of what rests on it is shown
    robots.models[static_cast<std::size_t>(friction)] = std::make_shared<robot::DynamicModel>(std::move(found.model));
  }
  return robots;
}

}  // namespace mbk::thesis
