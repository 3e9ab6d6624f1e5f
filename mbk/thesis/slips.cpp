// The slips of the source, in the order of docs/theory/sources-slips.md.
#include "mbk/thesis/slips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "mbk/model/impedance/ellipse.h"

namespace mbk::thesis {

ReproducedTable computed_table(std::string id, std::string title, std::string what_rows_are,
                               std::vector<ReproducedColumn> columns) {
  ReproducedTable table;
  table.id = std::move(id);
  table.title = std::move(title);
  table.provenance = Provenance::recomputed;
  table.what_rows_are = std::move(what_rows_are);
  table.columns = std::move(columns);
  return table;
}

std::vector<std::string> account(std::string where, std::string right, std::string shown, std::string moved,
                                 std::string tests) {
  return {std::move(where), std::move(right), std::move(shown), std::move(moved), std::move(tests)};
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

constexpr Maker slip(int chapter, const char* id, const char* title,
                     Result<void> (*make)(Workbench& bench, Exhibit& exhibit),
                     Provenance provenance = Provenance::recomputed) {
  return {Exhibit::Kind::slip, chapter, id, title, provenance, make};
}

constexpr std::array kMakers = {
    slip(3, "slip-1", "Table 3.6: half of the largest eigenvalue is no excess of passivity", excess_of_the_largest),
    slip(3, "slip-2", "Theorem 3.2: its boundary", theorem_at_its_boundary),
    slip(3, "slip-3", "Theorem 3.1: poles at zero and infinity", theorem_without_poles),
    slip(3, "slip-4", "(3.18), (3.21): antisymmetry may not be dropped", antisymmetry_dropped),
    slip(3, "slip-5", "(3.27), lemma 4.2 and (4.3): the Hermitian part, and which λ", hermitian_part),
    slip(3, "slip-6", "(3.17): the orientation of an ellipse", orientation_of_an_ellipse),
    slip(3, "slip-7", "(3.6): the cutoff of the smoothing filter", smoothing_cutoff),
    slip(0, "slip-8", "(A.3): the Jacobian", jacobian_in_one_column),
    slip(0, "slip-9", "(A.6): a sign in the Coriolis matrix", coriolis_sign),
    slip(0, "slip-10", "(D.3): the gradient of the springs' force", gradient_of_springs),
    slip(4, "slip-11", "Theorem 4.2: what it allows", any_immittance),
    slip(5, "slip-12", "Table 5.4: its sign", sign_of_the_errors),
    slip(0, "slip-13", "Appendix C: which samples, and filtered before they are cut", samples_of_the_program),
    slip(3, "slip-14", "(3.10): VAF does not see an offset", offset_of_the_fit),
    slip(0, "slip-15", "(E.3): lever arm and converter of the strain gauge", gauge_and_converter),
    slip(4, "slip-16", "Section 4.4.2: an impedance is improper", improper_impedance, Provenance::simulated),
    slip(4, "slip-17", "Theorem 4.1: poles that it does not name", unnamed_poles),
    slip(3, "slip-18", "(3.1), (3.4), (4.3), (5.2): the sign of the force", sign_of_the_force),
    slip(5, "slip-19", "Section 5.3.1: the largest relative discrepancy", largest_discrepancy),
    slip(0, "slip-20", "Section A.2: the majority of the workspace", majority_of_the_workspace),
};

}  // namespace

std::span<const Maker> slips() {
  return kMakers;
}

}  // namespace mbk::thesis
