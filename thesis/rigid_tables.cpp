// Tables of chapter 4: 4.1 to 4.5.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/passivity_index.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

Result<void> table_4_1(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-4.3", "figure-4.3"};
  return add_impedances(bench, Task::rigid_underdamped, "4.1", exhibit);
}

Result<void> table_4_2(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-4.3", "figure-4.4"};
  return add_impedances(bench, Task::rigid_sinusoidal, "4.2", exhibit);
}

/// "passive in 24 of 24"
std::string count_text(const char* word, std::ptrdiff_t hits, std::ptrdiff_t of) {
  return fmt::format("{} in {} of {}", word, hits, of);
}

/// Whichever word more trials have.
ReproducedCell majority(std::ptrdiff_t passive, std::ptrdiff_t of) {
  return words(2 * passive > of ? count_text("passive", passive, of) : count_text("active", of - passive, of));
}

std::vector<const TaskTrial*> trials_of(const std::vector<TaskResult>& results) {
  std::vector<const TaskTrial*> all;
  for (const TaskResult& result : results) {
    for (const TaskTrial& trial : result.trials) all.push_back(&trial);
  }
  return all;
}

ReproducedCell by_model(const std::vector<TaskResult>& results) {
  const auto all = trials_of(results);
  return majority(std::ranges::count_if(all, [](const TaskTrial* trial) { return trial->passive_by_model; }),
                  std::ssize(all));
}

ReproducedCell by_energy(const std::vector<TaskResult>& results) {
  const auto all = trials_of(results);
  return majority(
      std::ranges::count_if(all, [](const TaskTrial* trial) { return trial->energy.account.absorbed > 0.0; }),
      std::ssize(all));
}

ReproducedCell by_instruments(const std::vector<TaskResult>& results) {
  const auto passive = std::ranges::count_if(results, [](const TaskResult& result) {
    const ModelPassivity* model = result.passivity_by(Method::instrumental_variables);
    return model != nullptr && model->published_rule;
  });
  return majority(passive, std::ssize(results));
}

/// Eigenvalues of the symmetric parts: of the limb itself, by least squares, by instrumental variables.
void add_bias_rows(const TaskResult& result, ReproducedTable& table) {
  const auto add = [&](const char* what, const impedance::Model& model, std::string verdict) {
    ReproducedRow row{fmt::format("{}, {}", person(result.participant), what), {}};
    for (int matrix = 0; matrix < 3; ++matrix) {
      const impedance::Ellipse ellipse = impedance::ellipse(impedance::matrix_of(model, matrix));
      row.cells.push_back(cell(ellipse.lambda_min));
      row.cells.push_back(cell(ellipse.lambda_max));
    }
    row.cells.push_back(words(std::move(verdict)));
    table.rows.push_back(std::move(row));
  };
  const auto published = [&](Method method) {
    const ModelPassivity* model = result.passivity_by(method);
    if (model == nullptr) return std::string("no model");
    return std::string(model->published_rule ? "passive" : "active");
  };
  add("the limb itself", result.truth, "passive");
  add("least squares", result.by(Method::least_squares).model, published(Method::least_squares));
  add("instrumental variables", result.by(Method::instrumental_variables).model,
      published(Method::instrumental_variables));
  ReproducedRow energy{person(result.participant) + ", energy", std::vector<ReproducedCell>(6)};
  energy.cells.push_back(words(fmt::format("{}, {:+.2f} J", word_of(result.pooled.passivity->trial->energy.verdict),
                                           result.pooled.passivity->trial->energy.absorbed)));
  table.rows.push_back(std::move(energy));
}

Result<void> table_4_3(Workbench& bench, Draft& exhibit) {
  const auto relaxed_sines = MBK_TRY(bench.results(Task::relaxed_sinusoidal));
  const auto relaxed_pulses = MBK_TRY(bench.results(Task::relaxed_underdamped));
  const auto rigid_sines = MBK_TRY(bench.results(Task::rigid_sinusoidal));
  const auto rigid_pulses = MBK_TRY(bench.results(Task::rigid_underdamped));

  exhibit.related = {"table-4.1", "table-4.2", "figure-4.3", "figure-4.4"};
  exhibit.commands = {
      fmt::format("mbk simulate rigid_sinusoidal_6N --seed {} --out p1.h5 && mbk passivity p1.h5 --handle-mass {}",
                  bench.seed(1, 1), kHandleMass),
      "mbk validate closed-loop      # the same for twenty seeds, with intervals"};

  ReproducedTable verdicts;
  verdicts.id = "4.3";
  verdicts.provenance = Provenance::simulated;
  verdicts.what_rows_are = "task, approach";
  verdicts.columns = {{"sinusoidal", "", 0}, {"underdamped", "", 0}};
  verdicts.rows = {{"relaxed, impedance model", {by_model(*relaxed_sines), by_model(*relaxed_pulses)}},
                   {"relaxed, integral", {by_energy(*relaxed_sines), by_energy(*relaxed_pulses)}},
                   {"rigid, impedance model", {by_model(*rigid_sines), by_model(*rigid_pulses)}},
                   {"rigid, impedance model by instrumental variables, trials pooled",
                    {by_instruments(*rigid_sines), words("no valid instrument")}},
                   {"rigid, integral", {by_energy(*rigid_sines), by_energy(*rigid_pulses)}}};

  ReproducedTable bias;
  bias.id = "4.3 mechanism";
  bias.provenance = Provenance::simulated;
  bias.what_rows_are = "participant, method";
  for (const auto& [name, unit] : {std::pair{"M", "kg"}, std::pair{"B", "N·s/m"}, std::pair{"K", "N/m"}}) {
    for (const char* which : {"λ_min", "λ_max"}) {
      bias.columns.push_back({fmt::format("{} {}", which, name), unit, name[0] == 'M' ? 2 : name[0] == 'B' ? 1 : 0});
    }
  }
  bias.columns.push_back({"verdict", "", 0});
  for (const TaskResult& result : *rigid_sines) add_bias_rows(result, bias);

  ReproducedTable pulses;
  pulses.id = "4.3 pulses";
  pulses.provenance = Provenance::simulated;
  pulses.what_rows_are = "participant";
  pulses.columns = {{"force that the best model explains", "%", 1},
                    {"energy absorbed", "J", 2},
                    {"95 %, low", "J", 2},
                    {"95 %, high", "J", 2},
                    {"the trial", "", 0},
                    {"the model predicts", "", 0}};
  for (const TaskResult& result : *rigid_pulses) {
    const Passivity& passivity = *result.pooled.passivity;
    const EnergyAccount& energy = passivity.trial->energy;
    const auto& predicted = passivity.prediction.verdict;
    pulses.rows.push_back(
        {person(result.participant),
         {cell(result.by(Method::least_squares).fit.vaf.mean()), cell(energy.absorbed), cell(energy.absorbed95.first),
          cell(energy.absorbed95.second), words(std::string(word_of(energy.verdict))),
          words(predicted ? std::string(word_of(*predicted)) : "nothing")}});
  }
  exhibit.tables = {std::move(verdicts), std::move(bias), std::move(pulses)};
  return {};
}

Result<void> table_4_4(Workbench& bench, Draft& exhibit) {
  const auto trials = MBK_TRY(bench.one_axis_grasps());
  exhibit.related = {"figure-4.6", "figure-4.7", "withdrawn-errata"};
  exhibit.commands = {"mbk validate one-dimensional"};
  ReproducedTable table;
  table.id = "4.4";
  table.provenance = Provenance::simulated;
  table.what_rows_are = "trial";
  table.columns = {{"VAF", "%", 1}};
  for (std::size_t k = 0; k < trials->size(); ++k) {
    table.rows.push_back({fmt::format("trial {}", k + 1), {cell((*trials)[k].vaf)}});
  }
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> table_4_5(Workbench& bench, Draft& exhibit) {
  const auto results = MBK_TRY(bench.results(Task::rigid_underdamped));
  exhibit.related = {"figure-4.3", "erratum-5"};
  exhibit.commands = {
      fmt::format("mbk simulate rigid_underdamped_2N --seed {} --out p1.h5 && mbk passivity p1.h5 --handle-mass {}",
                  bench.seed(1, 1), kHandleMass)};
  ReproducedTable table;
  table.id = "4.5";
  table.provenance = Provenance::simulated;
  table.what_rows_are = "participant";
  table.spread_is = fmt::format("standard error over {} trials", kTrials);
  table.columns = {{"shortage of passivity", "N·s/m", 1}, {"at the end of the trial", "N·s/m", 1}};
  for (const TaskResult& result : *results) {
    table.rows.push_back(
        {person(result.participant),
         {cell(of_trials(result, [](const TaskTrial& trial) { return trial.energy.account.shortage_largest; }),
               Spread::standard_error),
          cell(of_trials(result, [](const TaskTrial& trial) { return trial.energy.account.shortage_at_end; }),
               Spread::standard_error)}});
  }
  exhibit.tables = {std::move(table)};
  return {};
}

constexpr std::array kRigidTables = {Maker{kTable, 4, "table-4.1", Provenance::simulated, table_4_1},
                                     Maker{kTable, 4, "table-4.2", Provenance::simulated, table_4_2},
                                     Maker{kTable, 4, "table-4.3", Provenance::simulated, table_4_3},
                                     Maker{kTable, 4, "table-4.4", Provenance::simulated, table_4_4},
                                     Maker{kTable, 4, "table-4.5", Provenance::simulated, table_4_5}};

}  // namespace

std::span<const Maker> rigid_tables() {
  return kRigidTables;
}

}  // namespace mbk::thesis
