#include "thesis/workbench.h"

#include <functional>

#include "mbk/base/numeric/parallel.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/validate/simulated_trials.h"

namespace mbk::thesis {
namespace {

measurement::Options published_procedure() {
  measurement::Options options;
  options.preprocess.mode = Mode::reference;
  options.identify.handle_mass = kHandleMass;
  return options;
}

const ModelPassivity* passivity_of(const Measurement& measured, Method method) {
  for (const ModelPassivity& model : measured.passivity->models) {
    if (model.method == method) return &model;
  }
  return nullptr;
}

bool passive_as_published(const Measurement& measured) {
  const ModelPassivity* model = passivity_of(measured, Method::least_squares);
  return model != nullptr && model->published_rule;
}

Result<TaskResult> perform(Task task, int participant, const Workbench& bench) {
  TaskResult result;
  result.participant = participant;
  std::vector<Recording> recordings;
  Vector truth;
  for (int k = 1; k <= kTrials; ++k) {
    const auto scenario = MBK_TRY(task_scenario(task, participant, bench.seed(participant, k)));
    auto performance = MBK_TRY(laboratory::simulate(scenario));
    const Vector one = impedance::stacked(performance.truth) / kTrials;
    truth = k == 1 ? one : Vector(truth + one);
    recordings.push_back(std::move(performance.recording));
    auto measured = MBK_TRY(measurement::measure({&recordings.back(), 1}, published_procedure()));
    result.trials.push_back(
        {std::move(measured.identification), std::move(measured.energies.front()), passive_as_published(measured)});
  }
  result.truth = impedance::unstacked(truth, 2);
  measurement::Options options;
  options.identify.handle_mass = kHandleMass;
  auto pooled = MBK_TRY(measurement::measure(recordings, options));
  result.pooled = std::move(pooled);
  result.first = std::move(recordings.front());
  return result;
}

Result<OneAxisGrasp> grasp(laboratory::Scenario scenario) {
  namespace one_dimensional = validation::one_dimensional;
  std::get<perturbation::RandomBinaryPlan>(scenario.perturbation.kind).sequence.switching_time = kSwitchingTime;
  auto performance = MBK_TRY(laboratory::simulate(scenario));
  const auto axis = MBK_TRY(one_dimensional::axis_of(performance.recording));
  const auto attempt = MBK_TRY(one_dimensional::attempted(axis.impedance));
  return OneAxisGrasp{attempt.vaf, one_dimensional::validation_output(attempt, axis.impedance),
                      std::move(performance.recording)};
}

/// make(i) for i = 0, …, count − 1, several at a time, in their order.
template <class Value>
Result<std::vector<Value>> made(std::size_t count, unsigned threads,
                                const std::function<Result<Value>(std::size_t)>& make) {
  std::vector<Value> all(count);
  MBK_TRY(numeric::parallel_for(static_cast<int>(count), threads, [&](int i) -> Result<void> {
    const auto at = static_cast<std::size_t>(i);
    all[at] = MBK_TRY(make(at));
    return {};
  }));
  return all;
}

Result<std::vector<OneAxisGrasp>> make_grasps(Workbench& bench) {
  const auto scenarios = MBK_TRY(validation::ready("one_axis_random_binary"));
  return made<OneAxisGrasp>(scenarios.size(), bench.options().threads, [&](std::size_t i) {
    laboratory::Scenario scenario = scenarios[i];
    scenario.seed = bench.options().seed + i;
    return grasp(std::move(scenario));
  });
}

}  // namespace

const Identification& TaskResult::by(Method method) const {
  const bool chosen = pooled.identification.method == method || !pooled.alternative;
  return chosen ? pooled.identification : *pooled.alternative;
}

const ModelPassivity* TaskResult::passivity_by(Method method) const {
  return passivity_of(pooled, method);
}

const char* scenario_of(Task task) {
  switch (task) {
    case Task::relaxed_sinusoidal:
      return "relaxed_sinusoidal";
    case Task::relaxed_underdamped:
      return "relaxed_underdamped";
    case Task::rigid_underdamped:
      return "rigid_underdamped_2N";
    case Task::rigid_sinusoidal:
      break;
  }
  return "rigid_sinusoidal_6N";
}

const char* text(Task task) {
  switch (task) {
    case Task::relaxed_sinusoidal:
      return "relaxed, sinusoidal";
    case Task::relaxed_underdamped:
      return "relaxed, underdamped";
    case Task::rigid_underdamped:
      return "rigid, underdamped";
    case Task::rigid_sinusoidal:
      break;
  }
  return "rigid, sinusoidal";
}

std::vector<int> participants_of(Task task) {
  switch (task) {
    case Task::relaxed_sinusoidal:
    case Task::rigid_underdamped:
      return {1, 2, 3, 4, 5, 6};
    case Task::relaxed_underdamped:
      return {1, 4};
    case Task::rigid_sinusoidal:
      break;
  }
  return {1, 4, 5};  // three people did it; which is not said
}

Result<laboratory::Scenario> task_scenario(Task task, int participant, std::uint64_t seed) {
  auto scenarios = MBK_TRY(validation::ready(scenario_of(task)));
  auto scenario = validation::with_limb(scenarios.front(), participant);
  if (scenario) scenario->seed = seed;
  return scenario;
}

std::uint64_t Workbench::seed(int participant, int trial) const {
  return 1000 * (options_.seed - 1) + 10 * static_cast<std::uint64_t>(participant) + static_cast<std::uint64_t>(trial);
}

Result<const std::vector<TaskResult>*> Workbench::results(Task task) {
  if (const auto found = results_.find(task); found != results_.end()) return &found->second;
  const std::vector<int> people = participants_of(task);
  auto all = MBK_TRY(made<TaskResult>(people.size(), options_.threads,
                                      [&](std::size_t i) { return perform(task, people[i], *this); }));
  return &(results_[task] = std::move(all));
}

Result<const std::vector<OneAxisGrasp>*> Workbench::one_axis_grasps() {
  return once(make_grasps);
}

}  // namespace mbk::thesis
