#pragma once

#include <string>
#include <vector>

#include "mbk/model/impedance/model.h"
#include "thesis/exhibits.h"

/// The errata of the source, each with the computation that shows it. For the sources of this module only.
namespace mbk::thesis {

/// An empty table of what mbk computes.
[[nodiscard]] ReproducedTable computed_table(std::string id, std::string what_rows_are,
                                             std::vector<ReproducedColumn> columns);

/// M, B and K of a printed row, symmetric (exhibits.h).
[[nodiscard]] impedance::Model model_of(const PrintedArm& arm);

/// The row of that name; everything that is given has P1.
[[nodiscard]] const PrintedArm& arm_of(const std::vector<PrintedArm>& arms, const std::string& name);

/// k_a with the printed share of 11.5 % for P1 (Dyck 2013, fig. 3.12): z_mean √(λ_max λ_min) = z_mean √(A/π) [N/m].
[[nodiscard]] double antisymmetric_stiffness(const Given& given);

/// "yes" or "no".
[[nodiscard]] std::string yes(bool is);

// Of the passivity of the limb, theorems 3.1 and 3.2.
[[nodiscard]] Result<void> excess_of_the_largest(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> theorem_at_its_boundary(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> theorem_without_poles(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> antisymmetry_dropped(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> hermitian_part(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> sign_of_the_force(Workbench& bench, Draft& exhibit);

// Of the stability of networks, theorems 4.1 and 4.2.
[[nodiscard]] Result<void> any_immittance(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> unnamed_poles(Workbench& bench, Draft& exhibit);

// Of the robot and its springs.
[[nodiscard]] Result<void> jacobian_in_one_column(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> coriolis_sign(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> gradient_of_springs(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> majority_of_the_workspace(Workbench& bench, Draft& exhibit);

// Of the procedure and its judgement.
[[nodiscard]] Result<void> orientation_of_an_ellipse(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> smoothing_cutoff(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> sign_of_the_errors(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> samples_of_the_program(Workbench& bench, Draft& exhibit);
[[nodiscard]] Result<void> offset_of_the_fit(Workbench& bench, Draft& exhibit);

// Errata that an earlier version charged, each with the computation that acquits the source.
[[nodiscard]] Result<void> withdrawn_errata(Workbench& bench, Draft& exhibit);

}  // namespace mbk::thesis
