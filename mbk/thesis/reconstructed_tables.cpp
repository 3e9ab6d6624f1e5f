// Tables that follow from other printed numbers, 3.6 and 5.3, and what no number leads to.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mbk/thesis/exhibits.h"

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

Result<void> table_3_6(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {
      "The excess of passivity of Z = M s + B + K/s is the smallest eigenvalue of the symmetric part of B. What the "
      "source prints under that name is half of the largest. Both follow from the area A and the shape R of the "
      "damping "
      "ellipses in tables 3.3 and 3.5: λ_max = √(A R/π), λ_min = √(A/(π R)).",
      "The range is what the rounding of A and R leaves open. That of the published formula reaches every printed "
      "cell, "
      "that of the excess itself reaches none."};
  exhibit.related = {"slip-1", "table-3.3", "table-3.5"};
  exhibit.commands = {"mbk passivity relaxed.h5      # both of a measurement of one's own: \"excess\" in --json"};
  ReproducedTable table;
  table.id = "3.6";
  table.title = "Excess of passivity, as published and corrected";
  table.provenance = Provenance::recomputed;
  table.what_rows_are = "participant, perturbation";
  table.columns = {{"λ_max/2, as published", "N·s/m", 2}, {"λ_min, corrected", "N·s/m", 2}};
  table.slip = "slip-1";
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

Result<void> table_5_3(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {
      "The body of this table is lost. Its entries are those of table 5.1 less those of table 5.4, for table 5.4 is "
      "printed as theoretical − identified, although its caption says the opposite (slip 12).",
      "The standard deviations of the fifteen trials behind each entry cannot be had."};
  exhibit.related = {"slip-12", "table-5.1", "table-5.4"};
  ReproducedTable stiffness, mass;
  stiffness.id = "5.3 stiffness";
  stiffness.title = "Identified stiffness, reconstructed";
  stiffness.what_rows_are = "stiffness";
  for (const char* method : {"method 1", "method 2"}) {
    for (const char* element : {"k_xx", "k_yy", "k_s"}) {
      stiffness.columns.push_back({std::string(method) + " " + element, "N/m", 2});
    }
    mass.columns.push_back({std::string(method) + " m", "kg", 3});
  }
  mass.id = "5.3 mass";
  mass.title = "Identified mass, reconstructed";
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

Result<void> lost(Workbench& /*bench*/, Exhibit& exhibit) {
  exhibit.text = {
      "What was never published, or is lost in the text of the thesis, cannot be computed and is not invented. Where "
      "something else can show the same, that stands in its place and says so."};
  exhibit.related = {"table-3.1", "table-3.2", "table-5.1", "table-5.6", "figure-3.12", "figure-3.13", "table-4.4"};
  ReproducedTable table;
  table.id = "lost";
  table.title = "What is missing, and what stands in its place";
  table.provenance = Provenance::not_recoverable;
  table.what_rows_are = "what";
  table.columns = {{"why it cannot be had", "", 0}, {"in its place", "", 0}};
  const auto add = [&](const char* what, const char* why, const char* instead) {
    table.rows.push_back({what, {words(why), words(instead)}});
  };
  add("recordings of all trials", "not published", "simulated trials with the same protocols");
  add("numbers in tables 3.2, 3.4, 4.1, 4.2, 5.6", "their bodies are lost in the text",
      "the same tables of simulated participants");
  add("entries of table 5.3", "its body is lost", "table 5.1 less table 5.4; not the standard deviations");
  add("antisymmetric parts of the participants' M and K", "only z_mean of P1's K is printed, without its sign",
      "symmetric limbs; k_a of P1 in figure 3.12 and slip 4");
  add("spring constants and lengths behind tables 3.1 and 5.1", "not published",
      "arrays that were found for the printed K");
  add("data of Mussa-Ivaldi et al. in figure 3.13 (b)", "another paper's", "nothing");
  add("frequencies and phases of the ten sines", "only their range is printed", "0.1 to 2.9 Hz with random phases");
  add("how long the random binary force keeps its sign", "not published", "4 s at least; other times in mbk validate");
  add("link lengths of the participants", "not published", "0.31 and 0.34 m");
  add("what the participants willed", "no one knows", "an intermittent controller with tuned gains");
  add("photographs and drawings of apparatus (figures 3.2, 3.3, 3.7, 5.1, D.1, D.2, E.1 to E.4)", "pictures, no data",
      "nothing");
  exhibit.tables = {std::move(table)};
  return {};
}

constexpr std::array kMakers = {
    Maker{Exhibit::Kind::table, 3, "table-3.6", "Excess of passivity of the relaxed arm", Provenance::recomputed,
          table_3_6},
    Maker{Exhibit::Kind::table, 5, "table-5.3", "Identified stiffness and mass of the rigs", Provenance::recomputed,
          table_5_3},
    Maker{Exhibit::Kind::table, 0, "lost", "What cannot be had, and why", Provenance::not_recoverable, lost}};

}  // namespace

std::span<const Maker> reconstructed_tables() {
  return kMakers;
}

}  // namespace mbk::thesis
