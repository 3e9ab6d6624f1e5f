// Tables of chapter 3 from simulated participants: 3.2 to 3.5.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/passivity_index.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

/// The place of a number of M, B, K and x₀ in a stacked model, and how it is shown.
struct Parameter {
  const char *name, *unit;
  int decimals;
  double scale = 1.0;
};
constexpr std::array kParameters = {
    Parameter{"m_xx", "kg", 2},    Parameter{"m_xy", "kg", 2},    Parameter{"m_yx", "kg", 2},
    Parameter{"m_yy", "kg", 2},    Parameter{"b_xx", "N·s/m", 2}, Parameter{"b_xy", "N·s/m", 2},
    Parameter{"b_yx", "N·s/m", 2}, Parameter{"b_yy", "N·s/m", 2}, Parameter{"k_xx", "N/m", 1},
    Parameter{"k_xy", "N/m", 1},   Parameter{"k_yx", "N/m", 1},   Parameter{"k_yy", "N/m", 1},
    Parameter{"x0", "mm", 1, 1e3}, Parameter{"y0", "mm", 1, 1e3}};

/// M, B, K, x₀, the fit and the verdict by the published procedure: one row of tables 3.2, 3.4, 4.1 and 4.2.
ReproducedRow impedance_row(const TaskResult& result) {
  ReproducedRow row{person(result.participant), {}};
  for (std::size_t k = 0; k < kParameters.size(); ++k) {
    row.cells.push_back(cell(of_trials(result,
                                       [&](const TaskTrial& trial) {
                                         return kParameters[k].scale *
                                                impedance::stacked(trial.identification.model)[static_cast<Index>(k)];
                                       }),
                             Spread::standard_error));
  }
  for (Index axis = 0; axis < 2; ++axis) {
    row.cells.push_back(
        cell(of_trials(result, [&](const TaskTrial& trial) { return trial.identification.fit.vaf[axis]; }),
             Spread::standard_error));
  }
  const auto passive = std::ranges::count_if(result.trials, &TaskTrial::passive_by_model);
  row.cells.push_back(words(fmt::format("{} of {}", passive, result.trials.size())));
  return row;
}

}  // namespace

Result<void> add_impedances(Workbench& bench, Task task, const char* id, Draft& exhibit) {
  const auto results = MBK_TRY(bench.results(task));
  ReproducedTable table;
  table.id = id;
  table.provenance = Provenance::simulated;
  table.what_rows_are = "participant";
  table.spread_is = fmt::format("standard error over {} trials", kTrials);
  for (const Parameter& parameter : kParameters) {
    table.columns.push_back({parameter.name, parameter.unit, parameter.decimals});
  }
  table.columns.push_back({"VAF x", "%", 1});
  table.columns.push_back({"VAF y", "%", 1});
  table.columns.push_back({"passive by theorem 3.2", "", 0});
  for (const TaskResult& result : *results) table.rows.push_back(impedance_row(result));
  exhibit.tables.push_back(std::move(table));
  exhibit.commands.push_back(
      fmt::format("mbk simulate {} --seed {} --out p1.h5 && mbk measure p1.h5 --mode reference --handle-mass {}"
                  "      # the first trial of P1",
                  scenario_of(task), bench.seed(1, 1), kHandleMass));
  return {};
}

namespace {

Result<void> table_3_2(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-3.3", "figure-3.11"};
  return add_impedances(bench, Task::relaxed_sinusoidal, "3.2", exhibit);
}

Result<void> table_3_4(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-3.5", "figure-3.16"};
  return add_impedances(bench, Task::relaxed_underdamped, "3.4", exhibit);
}

ReproducedTable ellipse_table(const char* id, Provenance provenance) {
  ReproducedTable table;
  table.id = id;
  table.provenance = provenance;
  table.what_rows_are = "participant";
  constexpr std::array<const char*, 3> kAreas = {"kg²", "N²s²/m²", "N²/m²"};
  for (std::size_t k = 0; k < 3; ++k) {
    table.columns.push_back({fmt::format("{} A", kMatrices[k]), kAreas[k], 1});
    table.columns.push_back({fmt::format("{} R", kMatrices[k]), "", 1});
    table.columns.push_back({fmt::format("{} θ", kMatrices[k]), "°", 1});
  }
  return table;
}

/// Matrices out of A, R and θ, and A, R and θ out of these again.
ReproducedRow rebuilt_row(const PrintedArm& arm) {
  ReproducedRow row{arm.name, {}};
  for (const PrintedEllipse& printed : arm.ellipses) {
    const Matrix Z = symmetric_matrix(printed);
    const impedance::Ellipse again = impedance::ellipse(Z);
    row.cells.push_back(cell(again.area));
    row.cells.push_back(cell(again.shape));
    row.cells.push_back(cell(kDegrees * again.orientation));
  }
  return row;
}

/// A, R and θ of each trial's matrices.
ReproducedRow measured_row(const TaskResult& result) {
  ReproducedRow row{person(result.participant), {}};
  for (int matrix = 0; matrix < 3; ++matrix) {
    const auto add = [&](const std::function<double(const impedance::Ellipse&)>& quantity) {
      row.cells.push_back(cell(
          of_trials(result,
                    [&](const TaskTrial& trial) {
                      return quantity(impedance::ellipse(impedance::matrix_of(trial.identification.model, matrix)));
                    }),
          Spread::standard_error));
    };
    add([](const impedance::Ellipse& ellipse) { return ellipse.area; });
    add([](const impedance::Ellipse& ellipse) { return ellipse.shape; });
    add([](const impedance::Ellipse& ellipse) { return kDegrees * ellipse.orientation; });
  }
  return row;
}

Result<void> ellipse_exhibit(Workbench& bench, Task task, const std::vector<PrintedArm>& arms, const char* id,
                             Draft& exhibit) {
  exhibit.commands = {
      fmt::format("mbk simulate {} --seed {} --out p1.h5 && mbk measure p1.h5 --mode reference --handle-mass {} --json "
                  "--out p1.json && "
                  "mbk ellipse p1.json      # the first trial of P1",
                  scenario_of(task), bench.seed(1, 1), kHandleMass)};
  exhibit.tables.push_back(ellipse_table(id, Provenance::recomputed));
  for (const PrintedArm& arm : arms) exhibit.tables.back().rows.push_back(rebuilt_row(arm));
  const auto results = MBK_TRY(bench.results(task));
  exhibit.tables.push_back(ellipse_table(id, Provenance::simulated));
  exhibit.tables.back().spread_is = fmt::format("standard error over {} trials", kTrials);
  for (const TaskResult& result : *results) exhibit.tables.back().rows.push_back(measured_row(result));
  return {};
}

Result<void> table_3_3(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-3.2", "figure-3.10", "figure-3.11", "erratum-6"};
  return ellipse_exhibit(bench, Task::relaxed_sinusoidal, bench.given().sinusoidal, "3.3", exhibit);
}

Result<void> table_3_5(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-3.4", "figure-3.16"};
  return ellipse_exhibit(bench, Task::relaxed_underdamped, bench.given().underdamped, "3.5", exhibit);
}

constexpr std::array kRelaxedTables = {
    Maker{Exhibit::Kind::table, 3, "table-3.2", Provenance::simulated, table_3_2},
    Maker{Exhibit::Kind::table, 3, "table-3.3", Provenance::recomputed, table_3_3},
    Maker{Exhibit::Kind::table, 3, "table-3.4", Provenance::simulated, table_3_4},
    Maker{Exhibit::Kind::table, 3, "table-3.5", Provenance::recomputed, table_3_5},
};

}  // namespace

std::span<const Maker> relaxed_tables() {
  return kRelaxedTables;
}

}  // namespace mbk::thesis
