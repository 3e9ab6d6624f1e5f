// The questions of section 3.2, answered with what the simulated participants and the printed numbers give.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "mbk/model/impedance/passivity_index.h"
#include "mbk/teleop/admissible.h"
#include "mbk/teleop/architectures.h"
#include "thesis/errata.h"

namespace mbk::thesis {
namespace {

constexpr std::array kTasks = {Task::relaxed_sinusoidal, Task::relaxed_underdamped, Task::rigid_sinusoidal,
                               Task::rigid_underdamped};

/// What all participants of a task come to.
struct Outcome {
  int people = 0, trials = 0;
  int passive_by_theorem = 0;             ///< trials, by the published rule and procedure
  int absorbing = 0;                      ///< trials whose energy ended above zero
  std::array<int, 3> verdicts{};          ///< of people, pooled, by the energy: passive, active, undecided
  double min_energy = 0, max_energy = 0;  ///< of a trial [J]
  double mean_vaf = 0;                    ///< [%], of the published procedure
};

Result<Outcome> outcome_of(Workbench& bench, Task task) {
  const auto results = MBK_TRY(bench.results(task));
  Outcome outcome;
  outcome.min_energy = std::numeric_limits<double>::infinity();
  outcome.max_energy = -outcome.min_energy;
  for (const TaskResult& result : *results) {
    ++outcome.people;
    const Verdict verdict = result.pooled.passivity->trial->energy.verdict;
    ++outcome.verdicts[verdict == Verdict::passive ? 0 : verdict == Verdict::active ? 1 : 2];
    for (const TaskTrial& trial : result.trials) {
      const double energy = trial.energy.account.absorbed;
      ++outcome.trials;
      outcome.passive_by_theorem += trial.passive_by_model ? 1 : 0;
      outcome.absorbing += energy > 0.0 ? 1 : 0;
      outcome.min_energy = std::min(outcome.min_energy, energy);
      outcome.max_energy = std::max(outcome.max_energy, energy);
      outcome.mean_vaf += trial.identification.fit.vaf.mean();
    }
  }
  outcome.mean_vaf /= outcome.trials;
  return outcome;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string of(int part, int whole) {
  return fmt::format("{} of {}", part, whole);
}

ReproducedTable simulated_table(const char* id, const char* what_rows_are, std::vector<ReproducedColumn> columns) {
  ReproducedTable table = computed_table(id, what_rows_are, std::move(columns));
  table.provenance = Provenance::simulated;
  return table;
}

std::string simulate_command(const Workbench& bench, Task task) {
  return fmt::format("mbk simulate {} --seed {} --out p1.h5 && mbk passivity p1.h5      # the first trial of P1",
                     scenario_of(task), bench.seed(1, 1));
}

Result<void> with_dynamics(Workbench& bench, Draft& exhibit) {
  ReproducedTable table = simulated_table("question-1", "participant, perturbation",
                                          {{"smallest index in the band", "N·s/m", 2},
                                           {"its lower 95 %", "N·s/m", 2},
                                           {"band", "", 0},
                                           {"energy of all trials", "J", 2},
                                           {"prediction", "", 0}});
  int passive = 0, absorbing = 0, people = 0, by_theorem = 0, trials = 0;
  for (const Task task : {Task::relaxed_sinusoidal, Task::relaxed_underdamped}) {
    const auto results = MBK_TRY(bench.results(task));
    for (const TaskResult& result : *results) {
      const Passivity& passivity = *result.pooled.passivity;
      const ModelPassivity& model = passivity.models.front();
      const auto& predicted = passivity.prediction.verdict;
      table.rows.push_back(
          {fmt::format("{}, {}", person(result.participant), text(task)),
           {cell(model.smallest_index), cell(model.smallest_index95.first),
            words(fmt::format("{:.2f} to {:.2f} Hz", model.band.low.value, model.band.high.value)),
            cell(passivity.trial->energy.absorbed), words(predicted ? std::string(word_of(*predicted)) : "none")}});
      ++people;
      passive += predicted == Verdict::passive ? 1 : 0;
      absorbing += passivity.trial->energy.verdict == Verdict::passive ? 1 : 0;
      for (const TaskTrial& trial : result.trials) {
        ++trials;
        by_theorem += trial.passive_by_model ? 1 : 0;
      }
    }
  }
  impedance::Model p1 = model_of(arm_of(bench.given().sinusoidal, "P1"));
  const double k_a = antisymmetric_stiffness(bench.given());
  p1.K(0, 1) += k_a;
  p1.K(1, 0) -= k_a;
  exhibit.values = {{"passive", passive}, {"absorbing", absorbing},
                    {"people", people},   {"by_theorem", by_theorem},
                    {"trials", trials},   {"passive_above", impedance::nonpassive_below(p1).value_or(0.0)}};
  exhibit.commands = {simulate_command(bench, Task::relaxed_sinusoidal)};
  exhibit.related = {"table-3.2", "table-3.4", "erratum-2", "erratum-4", "question-3"};
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> with_a_task(Workbench& bench, Draft& exhibit) {
  const auto results = MBK_TRY(bench.results(Task::rigid_underdamped));
  ReproducedTable table = simulated_table("question-2", "participant",
                                          {{"energy of all trials", "J", 2},
                                           {"low", "J", 2},
                                           {"high", "J", 2},
                                           {"largest shortage", "N·s/m", 1},
                                           {"VAF, published procedure", "%", 1},
                                           {"prediction", "", 0},
                                           {"verdict", "", 0}});
  int active = 0;
  double explained = 0.0;
  for (const TaskResult& result : *results) {
    const Passivity& passivity = *result.pooled.passivity;
    const EnergyAccount& energy = passivity.trial->energy;
    const auto& predicted = passivity.prediction.verdict;
    active += energy.verdict == Verdict::active ? 1 : 0;
    const ReproducedCell vaf =
        cell(of_trials(result, [](const TaskTrial& trial) { return trial.identification.fit.vaf.mean(); }),
             Spread::standard_error);
    explained += vaf.ours.value_or(0.0);
    table.rows.push_back(
        {person(result.participant),
         {cell(energy.absorbed), cell(energy.absorbed95.first), cell(energy.absorbed95.second),
          cell(energy.shortage_largest), vaf, words(predicted ? std::string(word_of(*predicted)) : "none"),
          words(std::string(word_of(energy.verdict)))}});
  }
  table.spread_is = fmt::format("standard error over {} trials", kTrials);
  const auto people = static_cast<int>(results->size());
  exhibit.values = {{"active", active}, {"people", people}, {"explained", explained / people}};
  exhibit.commands = {simulate_command(bench, Task::rigid_underdamped)};
  exhibit.related = {"table-4.1", "table-4.5", "figure-4.3", "question-3"};
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> with_other_protocols(Workbench& bench, Draft& exhibit) {
  ReproducedTable table = simulated_table("question-3", "task",
                                          {{"passive by theorem 3.2", "", 0},
                                           {"absorbed energy", "", 0},
                                           {"least of a trial", "J", 2},
                                           {"most of a trial", "J", 2},
                                           {"mean VAF", "%", 1},
                                           {"mbk: passive, active, undecided", "", 0}});
  std::array<Outcome, kTasks.size()> outcomes;
  for (std::size_t k = 0; k < kTasks.size(); ++k) {
    const auto outcome = MBK_TRY(outcome_of(bench, kTasks[k]));
    outcomes[k] = outcome;
    table.rows.push_back(
        {text(kTasks[k]),
         {words(of(outcome.passive_by_theorem, outcome.trials)), words(of(outcome.absorbing, outcome.trials)),
          cell(outcome.min_energy), cell(outcome.max_energy), cell(outcome.mean_vaf),
          words(fmt::format("{}, {}, {}", outcome.verdicts[0], outcome.verdicts[1], outcome.verdicts[2]))}});
  }
  for (const auto& [of_whom, outcome] : {std::pair{"relaxed_sines", &outcomes[0]},
                                         {"relaxed_pulses", &outcomes[1]},
                                         {"rigid_sines", &outcomes[2]},
                                         {"rigid_pulses", &outcomes[3]}}) {
    exhibit.values[fmt::format("{}_absorbing", of_whom)] = outcome->absorbing;
    exhibit.values[fmt::format("{}_trials", of_whom)] = outcome->trials;
  }
  const Outcome& sines = outcomes[2];
  exhibit.values.insert({{"by_theorem", sines.passive_by_theorem},
                         {"passive", sines.verdicts[0]},
                         {"active", sines.verdicts[1]},
                         {"undecided", sines.verdicts[2]},
                         {"people", sines.people}});
  exhibit.commands = {simulate_command(bench, Task::rigid_sinusoidal), simulate_command(bench, Task::rigid_underdamped),
                      "mbk validate closed-loop --runs 4"};
  exhibit.related = {"table-4.3", "figure-4.3", "figure-4.4", "figure-4.5", "question-2"};
  exhibit.tables = {std::move(table)};
  return {};
}

// What the excess buys.

/// Position–position, as examples/teleop/position_position.toml.
teleop::Teleoperator example_teleoperator() {
  using lti::Rational;
  teleop::Teleoperator result;
  result.values = {{"master.m", Rational(1, 2)},
                   {"slave.m", Rational(4, 5)},
                   {"master.b", 1},
                   {"slave.b", 1},
                   {"master.d", 10},
                   {"master.k", 100},
                   {"slave.d", 20},
                   {"slave.k", 200}};
  return result;
}

constexpr int kStiffestSlave = 2000;  // looked at [N/m]

/// The stiffest slave that is stable with an operator of that excess [N/m]; 0 where none is.
Result<double> stiffest_slave(double excess) {
  const auto delta = MBK_TRY(lti::exact(std::round(100.0 * excess) / 100.0));
  const auto equations =
      example_teleoperator().equations("slave.k").with_shortage(teleop::Port::one, lti::Polynomial{-delta});
  const auto set = MBK_TRY(teleop::admissible_set(equations, 0, kStiffestSlave));
  return set.intervals.empty() ? 0.0 : set.intervals.back().high.value;
}

Result<ReproducedTable> bought(Workbench& bench, double min_excess, double published, double shortage) {
  ReproducedTable table = computed_table("question-4 teleoperation", "the operator is taken to have",
                                         {{"excess", "N·s/m", 2}, {"stiffest slave", "N/m", 1}});
  for (const auto& [name, excess] :
       {std::pair{"none: passive, as by convention", 0.0},
        {"the least that was said to be useful", bench.given().number("setup", "excess said to be useful, N·s/m")},
        {"the least of table 3.6, corrected", min_excess},
        {"the least of table 3.6, as published", published},
        {"the least shortage of table 4.5", -shortage}}) {
    const auto stiffness = MBK_TRY(stiffest_slave(excess));
    table.rows.push_back({name, {cell(excess), stiffness > 0.0 ? cell(stiffness) : words("none is stable")}});
  }
  return table;
}

Result<ReproducedTable> measured_excess(Workbench& bench) {
  ReproducedTable table = simulated_table("question-4", "participant",
                                          {{"excess, relaxed", "N·s/m", 2},
                                           {"excess, low", "N·s/m", 2},
                                           {"excess, high", "N·s/m", 2},
                                           {"largest shortage, rigid, 2 N pulses", "N·s/m", 1},
                                           {"shortage, low", "N·s/m", 1},
                                           {"shortage, high", "N·s/m", 1}});
  const auto relaxed = MBK_TRY(bench.results(Task::relaxed_sinusoidal));
  const auto rigid = MBK_TRY(bench.results(Task::rigid_underdamped));
  for (std::size_t i = 0; i < relaxed->size(); ++i) {
    const TaskResult& result = (*relaxed)[i];
    ReproducedRow row{person(result.participant), {}};
    const auto& excess = result.pooled.passivity->models.front().excess;
    for (const double value : {excess ? excess->corrected : kNone, excess ? excess->corrected95.first : kNone,
                               excess ? excess->corrected95.second : kNone}) {
      row.cells.push_back(std::isfinite(value) ? cell(value) : words("none"));
    }
    const EnergyAccount& energy = (*rigid)[i].pooled.passivity->trial->energy;
    for (const double value :
         {energy.shortage_largest, energy.shortage_largest95.first, energy.shortage_largest95.second}) {
      row.cells.push_back(cell(value));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Result<void> how_much(Workbench& bench, Draft& exhibit) {
  double least = std::numeric_limits<double>::infinity(), published = least, shortage = least;
  for (const auto* arms : {&bench.given().sinusoidal, &bench.given().underdamped}) {
    for (const PrintedArm& arm : *arms) {
      const impedance::Model model = model_of(arm);
      least = std::min(least, impedance::smallest_eigenvalue(model, 1).value);
      published = std::min(published, impedance::published_excess_of_passivity(model).value);
    }
  }
  for (const auto& [name, row] : bench.given().tables.at("4.5").rows) {
    shortage = std::min(shortage, row.front().value);
  }
  auto simulated = MBK_TRY(measured_excess(bench));
  auto teleoperation = MBK_TRY(bought(bench, least, published, shortage));
  const auto shown = [&](std::size_t row) {
    const auto& value = teleoperation.rows[row].cells[1].ours;
    return value ? fmt::format("{:.0f} N/m", *value) : std::string("none");
  };
  exhibit.values = {{"least", least},
                    {"published", published},
                    {"slave_if_passive", shown(0)},
                    {"slave_with_least", shown(2)},
                    {"slave_as_published", shown(3)},
                    {"slave_with_shortage", shown(4)}};
  exhibit.commands = {"mbk teleop examples/teleop/position_position.toml --parameter slave.k=0:2000 --excess 0:10:6",
                      simulate_command(bench, Task::relaxed_sinusoidal)};
  exhibit.related = {"table-3.6", "table-4.5", "erratum-1", "erratum-5", "erratum-11"};
  exhibit.tables = {std::move(simulated), std::move(teleoperation)};
  return {};
}

constexpr Maker question(const char* id, Result<void> (*make)(Workbench& bench, Draft& exhibit)) {
  return {Exhibit::Kind::question, 3, id, Provenance::simulated, make};
}

constexpr std::array kQuestions = {question("question-1", with_dynamics), question("question-2", with_a_task),
                                   question("question-3", with_other_protocols), question("question-4", how_much)};

}  // namespace

std::span<const Maker> questions() {
  return kQuestions;
}

}  // namespace mbk::thesis
