// The errata of the source, in the order of docs/theory/errata.md.
#include "thesis/errata.h"

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

constexpr Maker erratum(int chapter, const char* id, Result<void> (*make)(Workbench& bench, Draft& exhibit)) {
  return {Exhibit::Kind::erratum, chapter, id, Provenance::recomputed, make};
}

// 15, 16 and 19 were withdrawn; a number is not given again.
constexpr std::array kMakers = {
    erratum(3, "erratum-1", excess_of_the_largest),
    erratum(3, "erratum-2", theorem_at_its_boundary),
    erratum(3, "erratum-3", theorem_without_poles),
    erratum(3, "erratum-4", antisymmetry_dropped),
    erratum(3, "erratum-5", hermitian_part),
    erratum(3, "erratum-6", orientation_of_an_ellipse),
    erratum(3, "erratum-7", smoothing_cutoff),
    erratum(0, "erratum-8", jacobian_in_one_column),
    erratum(0, "erratum-9", coriolis_sign),
    erratum(0, "erratum-10", gradient_of_springs),
    erratum(4, "erratum-11", any_immittance),
    erratum(5, "erratum-12", sign_of_the_errors),
    erratum(0, "erratum-13", samples_of_the_program),
    erratum(3, "erratum-14", offset_of_the_fit),
    erratum(4, "erratum-17", unnamed_poles),
    erratum(3, "erratum-18", sign_of_the_force),
    erratum(0, "erratum-20", majority_of_the_workspace),
    erratum(0, "withdrawn-errata", withdrawn_errata),
};

}  // namespace

std::span<const Maker> errata() {
  return kMakers;
}

}  // namespace mbk::thesis
