// Tables that follow from other printed numbers, 3.6 and 5.3, and data that cannot be recovered.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

/// √(A R/π) and √(A/(π R)), with what the rounding of A and R leaves open (Dyck 2013, eq. 3.15, 3.16 solved for λ).
struct Eigenvalues {
  ReproducedCell largest, smallest;
};

Eigenvalues eigenvalues(const PrintedEllipse& ellipse, double scale_of_largest) {
  const auto largest = [&](double area, double shape) {
    return scale_of_largest * std::sqrt(area * shape / std::numbers::pi);
  };
  const auto smallest = [](double area, double shape) { return std::sqrt(area / (std::numbers::pi * shape)); };
  const auto& [area, shape, orientation] = ellipse;
  return {
      cell(largest(area.value, shape.value), {largest(area.low(), shape.low()), largest(area.high(), shape.high())}),
      cell(smallest(area.value, shape.value),
           {smallest(area.low(), shape.high()), smallest(area.high(), shape.low())})};
}

Result<void> table_3_6(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"erratum-1", "table-3.3", "table-3.5"};
  exhibit.commands = {"mbk passivity relaxed.h5      # both of your own measurement: \"excess\" in --json"};
  ReproducedTable table;
  table.id = "3.6";
  table.provenance = Provenance::recomputed;
  table.what_rows_are = "participant, perturbation";
  table.columns = {{"λ_max/2, as published", "N·s/m", 2}, {"λ_min, corrected", "N·s/m", 2}};
  table.erratum = "erratum-1";
  const auto add = [&](const std::vector<PrintedArm>& arms, const char* perturbation) {
    for (const PrintedArm& arm : arms) {
      const Eigenvalues both = eigenvalues(arm.ellipses[1], 0.5);
      table.rows.push_back({arm.name + ", " + perturbation, {both.largest, both.smallest}});
    }
  };
  add(bench.given().sinusoidal, "sinusoidal");
  add(bench.given().underdamped, "underdamped");
  exhibit.tables.push_back(std::move(table));
  return {};
}

/// Theoretical minus the printed error, whose sign is the other way round than its caption says.
ReproducedCell identified(const PrintedNumber& theoretical, const PrintedNumber& error) {
  const double value = theoretical.value - error.value, open = theoretical.rounding + error.rounding;
  return cell(value, {value - open, value + open});
}

Result<void> table_5_3(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"erratum-12", "table-5.1", "table-5.4"};
  ReproducedTable stiffness, mass;
  stiffness.id = "5.3 stiffness";
  stiffness.what_rows_are = "stiffness";
  for (const char* method : {"method 1", "method 2"}) {
    for (const char* element : {"k_xx", "k_yy", "k_s"}) {
      stiffness.columns.push_back({std::string(method) + " " + element, "N/m", 2});
    }
    mass.columns.push_back({std::string(method) + " m", "kg", 3});
  }
  mass.id = "5.3 mass";
  mass.what_rows_are = "mass";
  const auto add = [](const std::vector<PrintedRig>& rigs, ReproducedTable& table) {
    for (const PrintedRig& rig : rigs) {
      ReproducedRow row{rig.name, {}};
      for (const auto* errors : {&rig.error_method_1, &rig.error_method_2}) {
        for (std::size_t k = 0; k < errors->size(); ++k) {
          row.cells.push_back(identified(rig.theoretical[k], (*errors)[k]));
        }
      }
      table.rows.push_back(std::move(row));
    }
  };
  add(bench.given().stiffnesses, stiffness);
  add(bench.given().masses, mass);
  exhibit.tables = {std::move(stiffness), std::move(mass)};
  return {};
}

Result<void> lost(Workbench& /*bench*/, Draft& exhibit) {
  exhibit.related = {"table-3.1", "table-3.2", "table-5.1", "table-5.6", "figure-3.12", "figure-3.13", "table-4.4"};
  ReproducedTable table;
  table.id = "lost";
  table.provenance = Provenance::not_recoverable;
  table.what_rows_are = "data";
  table.columns = {{"reason", "", 0}, {"substitute", "", 0}};
  exhibit.tables = {std::move(table)};
  return {};
}

constexpr std::array kReconstructedTables = {
    Maker{Exhibit::Kind::table, 3, "table-3.6", Provenance::recomputed, table_3_6},
    Maker{Exhibit::Kind::table, 5, "table-5.3", Provenance::recomputed, table_5_3},
    Maker{Exhibit::Kind::table, 0, "lost", Provenance::not_recoverable, lost}};

}  // namespace

std::span<const Maker> reconstructed_tables() {
  return kReconstructedTables;
}

}  // namespace mbk::thesis
