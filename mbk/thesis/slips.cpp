// The slips of the source, in the order of docs/theory/sources-slips.md.
#include "mbk/thesis/slips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "mbk/model/impedance/ellipse.h"

namespace mbk::thesis {

ReproducedTable computed_table(std::string id, std::string what_rows_are, std::vector<ReproducedColumn> columns) {
  ReproducedTable table;
  table.id = std::move(id);
  table.provenance = Provenance::recomputed;
  table.what_rows_are = std::move(what_rows_are);
  table.columns = std::move(columns);
  return table;
}

impedance::Model model_of(const PrintedArm& arm) {
  // Symmetric to the last digit, for what is decided exactly.
  const auto exactly = [&](std::size_t k) { return impedance::symmetric_part(symmetric_matrix(arm.ellipses[k])); };
  return {exactly(0), exactly(1), exactly(2), Vector::Zero(2)};
}

const PrintedArm& arm_of(const std::vector<PrintedArm>& arms, const std::string& name) {
  return *std::ranges::find(arms, name, &PrintedArm::name);
}

double antisymmetric_stiffness(const Given& given) {
  const double share = 0.01 * given.number("setup", "antisymmetry of the stiffness of P1, %");
  return share * std::sqrt(arm_of(given.sinusoidal, "P1").ellipses[2].area.value / std::numbers::pi);
}

std::string yes(bool is) {
  return is ? "yes" : "no";
}

namespace {

constexpr Maker slip(int chapter, const char* id, Result<void> (*make)(Workbench& bench, Draft& exhibit),
                     Provenance provenance = Provenance::recomputed) {
  return {Exhibit::Kind::slip, chapter, id, provenance, make};
}

constexpr std::array kMakers = {
    slip(3, "slip-1", excess_of_the_largest),   slip(3, "slip-2", theorem_at_its_boundary),
    slip(3, "slip-3", theorem_without_poles),   slip(3, "slip-4", antisymmetry_dropped),
    slip(3, "slip-5", hermitian_part),          slip(3, "slip-6", orientation_of_an_ellipse),
    slip(3, "slip-7", smoothing_cutoff),        slip(0, "slip-8", jacobian_in_one_column),
    slip(0, "slip-9", coriolis_sign),           slip(0, "slip-10", gradient_of_springs),
    slip(4, "slip-11", any_immittance),         slip(5, "slip-12", sign_of_the_errors),
    slip(0, "slip-13", samples_of_the_program), slip(3, "slip-14", offset_of_the_fit),
    slip(0, "slip-15", gauge_and_converter),    slip(4, "slip-16", improper_impedance, Provenance::simulated),
    slip(4, "slip-17", unnamed_poles),          slip(3, "slip-18", sign_of_the_force),
    slip(5, "slip-19", largest_discrepancy),    slip(0, "slip-20", majority_of_the_workspace),
};

}  // namespace

std::span<const Maker> slips() {
  return kMakers;
}

}  // namespace mbk::thesis
