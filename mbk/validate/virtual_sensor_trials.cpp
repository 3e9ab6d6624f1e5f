#include "mbk/validate/virtual_sensor_trials.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "mbk/files/recording/inspect.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/preprocess/prepare.h"
#include "mbk/measure/preprocess/virtual_force.h"

namespace mbk::validation {
namespace {

using RobotModel = std::shared_ptr<const robot::DynamicModel>;

/// The recording with another force.
Recording with_force(Recording recording, const Matrix& force) {
  for (Channel& channel : recording.channels) {
    if (channel.name == "force_x") channel.values = force.col(0);
    if (channel.name == "force_y") channel.values = force.col(1);
  }
  return recording;
}

/// RMSE of each axis over the rows that count.
Result<Eigen::Vector2d> force_rmse(const PreparedTrial& trial, const PreparedTrial& truth) {
  Eigen::Vector2d squares(0.0, 0.0);
  Index rows = 0;
  for (const Segment& segment : truth.segments) {
    const Index begin = segment.begin, size = std::min(segment.size(), trial.force_hand_on_robot.rows() - begin);
    if (size < segment.size() || trial.time[begin] != truth.time[begin]) {
      return bad_data("two forces of one recording were prepared differently");
    }
    squares += (trial.force_hand_on_robot - truth.force_hand_on_robot)
                   .middleRows(begin, size)
                   .colwise()
                   .squaredNorm()
                   .transpose();
    rows += size;
  }
  return Eigen::Vector2d((squares / static_cast<double>(rows)).cwiseSqrt());
}

Result<ForceOutcome> measured(const Recording& recording, Force force, const Robots& robots, const PreparedTrial& truth,
                              const measurement::Options& options) {
  preprocess::Options signals = options.preprocess;
  signals.cutoff = truth.preparation.cutoff;
  signals.every = truth.preparation.every;
  const auto trial = MBK_TRY(prepare_with(recording, force, robots, std::move(signals)));
  const auto rmse = MBK_TRY(force_rmse(trial, truth));
  auto found = MBK_TRY(identify::identify_impedance({trial}, options.identify));
  return ForceOutcome{std::move(found.model), std::move(found.standard_error), std::move(found.fit.vaf), rmse};
}

}  // namespace

RobotModel Robots::behind(Force force) const {
  const FrictionModel friction = force == Force::no_coulomb    ? FrictionModel::viscous
                                 : force == Force::no_friction ? FrictionModel::none
                                                               : FrictionModel::full;
  return models[static_cast<std::size_t>(friction)];
}

Result<Robots> identify_robots(std::uint64_t seed, const std::optional<robot::Capstan>& capstan) {
  const auto recording = MBK_TRY(free_motion(seed, capstan));
  Robots robots;
  for (const FrictionModel friction : {FrictionModel::full, FrictionModel::viscous, FrictionModel::none}) {
    auto found = MBK_TRY(identified_robot(recording, friction));
    robots.models[static_cast<std::size_t>(friction)] = std::make_shared<robot::DynamicModel>(std::move(found.model));
  }
  return robots;
}

Result<PreparedTrial> prepare_with(const Recording& recording, Force force, const Robots& robots,
                                   preprocess::Options options) {
  const Inspection inspection = recording::inspect(recording);
  if (force == Force::sensor) return preprocess::prepare(recording, inspection, options);
  options.force_source = force == Force::observer ? ForceSource::observer : ForceSource::virtual_sensor;
  options.robot = robots.behind(force);
  const auto computed = MBK_TRY(preprocess::virtual_force(recording, inspection, *options.robot, options));
  return preprocess::prepare(computed.recording, recording::inspect(computed.recording), options, &computed);
}

Result<ForceTrial> perform(const laboratory::Scenario& scenario, const Robots& robots,
                           const ForceMeasurement& measurement) {
  std::vector<Eigen::Vector2d> force;
  laboratory::SimulateOptions watching;
  watching.watch = [&](const laboratory::TrueState<2>& state) { force.push_back(state.force_hand_on_robot); };
  const auto performance = MBK_TRY(laboratory::simulate(scenario, watching));
  const Recording& recording = performance.recording;
  Matrix acted(static_cast<Index>(force.size()), 2);
  for (std::size_t k = 0; k < force.size(); ++k) acted.row(static_cast<Index>(k)) = force[k].transpose();
  const auto truth =
      MBK_TRY(prepare_with(with_force(recording, acted), Force::sensor, robots, measurement.options.preprocess));

  ForceTrial trial;
  std::tie(trial.stiffness, trial.mass) = rig_names(scenario.name);
  trial.truth = performance.truth;
  for (const Force source : measurement.forces) {
    auto outcome = measured(recording, source, robots, truth, measurement.options);
    if (!outcome) return tl::unexpected(outcome.error().in(scenario.name));
    trial.by[static_cast<std::size_t>(source)] = std::move(*outcome);
  }
  return trial;
}

}  // namespace mbk::validation
