// Slips of chapters 3 and 4 about passivity: theorems 3.1 to 4.2 and what follows from them.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "mbk/base/lti/positive_real.h"
#include "mbk/base/lti/rational_passivity_index.h"
#include "mbk/measure/analyse/energy_blocks.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/model/robot/dynamics.h"
#include "mbk/teleop/admissible.h"
#include "mbk/teleop/architectures.h"
#include "mbk/teleop/llewellyn.h"
#include "mbk/thesis/slips.h"

namespace mbk::thesis {
namespace {

using lti::Rational;

/// Z = M s + B + K/s, exactly.
Result<lti::RationalMatrix> impedance_of(const impedance::Model& model) {
  return lti::RationalMatrix::impedance(model.M, model.B, model.K);
}

Result<bool> is_positive_real(const impedance::Model& model) {
  const auto Z = impedance_of(model);
  if (!Z) return tl::unexpected(Z.error());
  const auto real = lti::positive_real(*Z);
  if (!real) return tl::unexpected(real.error());
  return real->holds();
}

/// Smallest eigenvalue of Z(jω) + Z(jω)*, of the numbers themselves.
double smallest_of_hermitian_part(const impedance::Model& model, double omega) {
  const std::complex<double> s(0.0, omega);
  const Eigen::MatrixXcd Z = (model.M * s + model.B + model.K / s).eval();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd>(Z + Z.adjoint(), Eigen::EigenvaluesOnly).eigenvalues()[0];
}

impedance::Model with_antisymmetry(impedance::Model model, double k_a) {
  model.K(0, 1) += k_a;
  model.K(1, 0) -= k_a;
  return model;
}

}  // namespace

Result<void> excess_of_the_largest(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = account(
      "Where: table 3.6 and the range in sections 3.6.3 and 4.5. Printed as the excess of passivity is half of the "
      "largest eigenvalue of B_s.",
      "Right: theorem 3.1 as it is meant asks for H(jω) ⪰ 2δI at every frequency. H is 2B_s where M and K are "
      "symmetric, so the largest δ is the smallest eigenvalue of B_s.",
      "What shows it: M, B and K rebuilt from tables 3.3 and 3.5. The input passivity index of the rational matrix Z, "
      "bounded in exact arithmetic, is λ_min in each row; with the published value H − 2δI has a negative eigenvalue "
      "wherever that value is larger.",
      "What moves: all eight cells of table 3.6, and the range of 4.3 to 7.2 N·s/m that section 4.5 builds on. The "
      "verdict that the relaxed arm has an excess stays, and an excess of 0.9 N·s/m is still exceeded by all.",
      "Tests: Slips.ExcessIsTheIndexOfTheRationalMatrix; mbk/model/impedance/passivity_index_test.cpp, "
      "Table36.IsNotTheExcessOfPassivityInAnyCell.");
  exhibit.commands = {"mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk passivity relaxed.h5"};
  exhibit.related = {"table-3.6", "table-3.3", "table-3.5", "slip-3", "question-4"};
  ReproducedTable table = computed_table("slip-1", "The published value and the excess itself", "participant",
                                         {{"λ_max/2, as published", "N·s/m", 2},
                                          {"λ_min", "N·s/m", 2},
                                          {"index of Z, exactly", "N·s/m", 2},
                                          {"λ_min(H − 2δI), δ as published", "N·s/m", 2}});
  const auto add = [&](const std::vector<PrintedArm>& arms, const char* perturbation) -> Result<void> {
    for (const PrintedArm& arm : arms) {
      const impedance::Model model = model_of(arm);
      const auto Z = impedance_of(model);
      if (!Z) return tl::unexpected(Z.error());
      const auto index = lti::input_passivity_index(*Z);
      if (!index) return tl::unexpected(index.error());
      const double published = impedance::published_excess_of_passivity(model).value;
      table.rows.push_back({fmt::format("{}, {}", arm.name, perturbation),
                            {cell(published), cell(impedance::smallest_eigenvalue(model, 1).value), cell(index->value),
                             cell(smallest_of_hermitian_part(model, 1.0) - 2.0 * published)}});
    }
    return {};
  };
  if (auto ok = add(bench.given().sinusoidal, "sinusoidal"); !ok) return ok;
  if (auto ok = add(bench.given().underdamped, "underdamped"); !ok) return ok;
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> theorem_at_its_boundary(Workbench& /*bench*/, Exhibit& exhibit) {
  exhibit.text = account(
      "Where: theorem 3.2, (3.19) to (3.25). Printed: of each matrix one diagonal element and the determinant must not "
      "be negative (leading principal minors).",
      "Right: that is enough for a positive definite matrix; a semidefinite one needs every principal minor, so k_yy, "
      "m_yy and b_yy ≥ 0 too. The text below the theorem already speaks of all diagonal elements.",
      "What shows it: diag(0, −1) in the place of M, B or K, the other two the identity, against the exact decision "
      "whether Z is positive real.",
      "What moves: nothing that is printed, since no identified matrix lies on the boundary. A program that codes the "
      "theorem calls such a limb passive.",
      "Tests: Slips.BoundaryOfTheTheoremIsNotPassive; tests/pipeline/passive_models_test.cpp, "
      "SymmetricModels.OfTheTheoremsBoundaryAreNotPassive.");
  exhibit.commands = {"mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk passivity relaxed.h5"};
  exhibit.related = {"slip-3", "slip-4"};
  ReproducedTable table = computed_table(
      "slip-2", "Models on the boundary of theorem 3.2", "diag(0, −1) stands for",
      {{"z_xx", "", 1}, {"determinant", "", 1}, {"theorem 3.2", "", 0}, {"λ_min", "", 1}, {"positive real", "", 0}});
  constexpr std::array<const char*, 4> kNames = {"M", "B", "K", "none of them"};
  for (int k = 0; k < 4; ++k) {
    const Matrix I = Matrix::Identity(2, 2);
    impedance::Model model{I, I, I, Vector::Zero(2)};
    const Matrix edge{{0.0, 0.0}, {0.0, -1.0}};
    if (k == 0) model.M = edge;
    if (k == 1) model.B = edge;
    if (k == 2) model.K = edge;
    const Matrix& Z = impedance::matrix_of(model, std::min(k, 2));
    const double determinant = Z(0, 0) * Z(1, 1) - Z(0, 1) * Z(1, 0) + 0.0;  // no minus zero
    const auto real = is_positive_real(model);
    if (!real) return tl::unexpected(real.error());
    table.rows.push_back(
        {kNames[static_cast<std::size_t>(k)],
         {cell(Z(0, 0)), cell(determinant), words(Z(0, 0) >= 0.0 && determinant >= 0.0 ? "passive" : "not passive"),
          cell(impedance::smallest_eigenvalue(model, std::min(k, 2)).value), words(yes(*real))}});
  }
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> theorem_without_poles(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = account(
      "Where: theorem 3.1 (and lemma 4.2), applied to Z in section 3.6.3. Printed: all poles must have negative real "
      "parts.",
      "Right: Z = M s + B + K/s has poles at 0 and at infinity, so the theorem does not apply to it. What holds: "
      "Z − δI is positive real if and only if M = Mᵀ ⪰ 0, K = Kᵀ ⪰ 0 and λ_min(B_s) ≥ δ.",
      "What shows it: the poles of P1's Z, and whether Z − δI is positive real just below and just above λ_min, "
      "decided "
      "in exact arithmetic with the poles counted.",
      "What moves: no number, for the residues M and K of the relaxed arm are positive definite. With a K that is not, "
      "H alone would show an excess that the limb does not have: the last row.",
      "Tests: Slips.PolesOfTheImpedanceAreNotWhatTheTheoremAsks; tests/pipeline/passive_models_test.cpp, "
      "ExcessOfPassivity.IsTheInputPassivityIndexOfTheRationalMatrix.");
  exhibit.commands = {"mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk passivity relaxed.h5"};
  exhibit.related = {"slip-1", "slip-2", "slip-17"};
  const impedance::Model p1 = model_of(arm_of(bench.given().sinusoidal, "P1"));
  const double excess = impedance::smallest_eigenvalue(p1, 1).value;
  const auto Z = impedance_of(p1);
  if (!Z) return tl::unexpected(Z.error());
  std::string finite;
  for (const auto& pole : lti::poles(*Z)) finite += fmt::format("{}{:g}", finite.empty() ? "" : ", ", pole.real());
  const bool proper = (*Z)(0, 0).is_proper();
  ReproducedTable table = computed_table(
      "slip-3", fmt::format("Z of P1: finite poles at {}; {}", finite, proper ? "none at infinity" : "one at infinity"),
      "δ taken off the damping",
      {{"δ", "N·s/m", 3}, {"½ λ_min(H)", "N·s/m", 3}, {"λ_min(K)", "N/m", 1}, {"Z − δI positive real", "", 0}});
  const auto add = [&](const char* name, impedance::Model model, double delta) -> Result<void> {
    model.B -= delta * Matrix::Identity(2, 2);
    const auto real = is_positive_real(model);
    if (!real) return tl::unexpected(real.error());
    table.rows.push_back({name,
                          {cell(delta), cell(0.5 * smallest_of_hermitian_part(model, 1.0)),
                           cell(impedance::smallest_eigenvalue(model, 2).value), words(yes(*real))}});
    return {};
  };
  impedance::Model springy = p1;
  springy.K = -springy.K;
  if (auto ok = add("0.999 λ_min", p1, 0.999 * excess); !ok) return ok;
  if (auto ok = add("1.001 λ_min", p1, 1.001 * excess); !ok) return ok;
  if (auto ok = add("λ_max/2, as published", p1, impedance::published_excess_of_passivity(p1).value); !ok) return ok;
  if (auto ok = add("0.999 λ_min, with −K in place of K", springy, 0.999 * excess); !ok) return ok;
  exhibit.tables = {std::move(table)};
  return {};
}

namespace {

/// Index of P1 over frequency, with and without its antisymmetric stiffness.
Chart index_chart(const impedance::Model& with, const impedance::Model& without) {
  Chart chart;
  chart.title = "Passivity index of P1's relaxed arm";
  chart.x = {"frequency", "Hz", true};
  chart.y = {"½ λ_min(Z + Z*)", "N·s/m"};
  for (const auto& [name, model] : {std::pair{"with k_a", &with}, {"without k_a, as in the source", &without}}) {
    ChartSeries series{name, {}, {}, {}, ChartSeries::Drawn::line};
    for (int i = 0; i <= 60; ++i) {
      const double frequency = 0.1 * std::pow(100.0, i / 60.0);
      series.x.push_back(frequency);
      series.y.push_back(impedance::passivity_index(*model, 2.0 * std::numbers::pi * frequency).value);
    }
    chart.series.push_back(std::move(series));
  }
  chart.horizontal = {{0.0, "below: not passive"}};
  return chart;
}

}  // namespace

Result<void> antisymmetry_dropped(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = account(
      "Where: section 3.6.1.2 and theorem 3.2. Printed: below 15 % the antisymmetric parts of K and M are neglected, "
      "and the symmetric ones decide over all frequencies.",
      "Right: with k_a ≠ 0 the index tr(B_s)/2 − √( ((b_xx − b_yy)/2)² + b_s² + (ω m_a − k_a/ω)² ) falls without bound "
      "as ω → 0. Below f₀ = |k_a|/(2π √det B_s) a limb is not passive, however small its k_a is; the verdict depends "
      "on "
      "the band, which has to be named.",
      "What shows it: P1 with the 11.5 % of figure 3.12, k_a = z_mean √(A/π). The closed form and the eigenvalues of "
      "Z + Z* agree. The second table is what the tolerated 15 % would mean for each participant.",
      "What moves: \"passive\" for all frequencies becomes \"passive above f₀\", some tenths of a hertz, which is "
      "below "
      "most of the perturbation's band. No printed number moves. Random errors alone give z_mean a 95th percentile of "
      "about 31 % in one trial at 0.3 N of noise (a simulation), so that a share without an interval shows nothing.",
      "Tests: Slips.AntisymmetryMakesTheArmActiveAtLowFrequencies; mbk/model/impedance/passivity_index_test.cpp, "
      "PassivityIndex.OfP1WithItsAntisymmetryIsNegativeAtLowFrequencies.");
  exhibit.commands = {
      "mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk passivity relaxed.h5 --band 0.05:3      # against "
      "--band 0.5:3"};
  exhibit.related = {"figure-3.12", "figure-3.13", "slip-2", "question-1"};
  const impedance::Model without = model_of(arm_of(bench.given().sinusoidal, "P1"));
  const double k_a = antisymmetric_stiffness(bench.given());
  const impedance::Model with = with_antisymmetry(without, k_a);
  ReproducedTable table = computed_table(
      "slip-4",
      fmt::format("P1 with k_a = {:.2f} N/m; not passive below {:.3f} Hz", k_a,
                  impedance::nonpassive_below(with).value_or(std::numeric_limits<double>::quiet_NaN())),
      "frequency", {{"index, closed form", "N·s/m", 2}, {"½ λ_min(Z + Z*)", "N·s/m", 2}, {"without k_a", "N·s/m", 2}});
  for (const double frequency : {0.05, 0.1, 0.2, 0.5, 1.0, 3.0}) {
    const double omega = 2.0 * std::numbers::pi * frequency;
    table.rows.push_back(
        {fmt::format("{:g} Hz", frequency),
         {cell(impedance::passivity_index(with, omega).value), cell(0.5 * smallest_of_hermitian_part(with, omega)),
          cell(impedance::passivity_index(without, omega).value)}});
  }
  ReproducedTable tolerated = computed_table("slip-4 tolerated", "What the tolerated share of antisymmetry would mean",
                                             "participant", {{"k_a", "N/m", 1}, {"not passive below", "Hz", 2}});
  const double share = 0.01 * bench.given().number("setup", "antisymmetry that was neglected, %");
  for (const PrintedArm& arm : bench.given().sinusoidal) {
    const double largest = share * std::sqrt(arm.ellipses[2].area.value / std::numbers::pi);
    tolerated.rows.push_back(
        {arm.name,
         {cell(largest), cell(impedance::nonpassive_below(with_antisymmetry(model_of(arm), largest))
                                  .value_or(std::numeric_limits<double>::quiet_NaN()))}});
  }
  exhibit.tables = {std::move(table), std::move(tolerated)};
  exhibit.charts = {index_chart(with, without)};
  return {};
}

Result<void> hermitian_part(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = account(
      "Where: the sentence after (3.27), lemma 4.2 and (4.3). Printed: H = Z(jω) + Zᵀ(jω); Re Z(s) ≥ δ; the largest λ "
      "for which the inequality holds.",
      "Right: H = Z(jω) + Zᵀ(−jω); Re Z(jω) ≥ δ; the smallest λ. The first is not Hermitian, so that it has no order "
      "to "
      "compare with 2δI. Re Z(s) has no lower bound left of the axis. Of (4.3) every larger λ holds too.",
      "What shows it: P1's Z at 1 Hz; its m_yy, b_yy and k_yy along the real axis; an energy that falls to −0.2 J at "
      "∫v² = 0.02 m²/s and ends with −0.3 J at 0.05 m²/s.",
      "What moves: nothing, if table 4.5 was computed with the smallest λ. Whether over a whole trial or at its end "
      "cannot be told from the table, and both differ.",
      "Tests: Slips.PrintedHermitianPartIsNotHermitian, Slips.EveryLargerShortageHoldsToo; "
      "mbk/measure/analyse/energy_blocks_test.cpp, LargestShortage.IsThatOfEverySample.");
  exhibit.commands = {
      "mbk simulate rigid_underdamped_2N --out rigid.h5 && mbk passivity rigid.h5      # shortage at "
      "the end and at its largest"};
  exhibit.related = {"slip-1", "slip-18", "table-4.5", "figure-4.3"};
  const impedance::Model p1 = model_of(arm_of(bench.given().sinusoidal, "P1"));
  const std::complex<double> s(0.0, 2.0 * std::numbers::pi);
  const auto Z = [&](std::complex<double> at) { return (p1.M * at + p1.B + p1.K / at).eval(); };
  ReproducedTable table =
      computed_table("slip-5", "Z of P1 at 1 Hz", "H is",
                     {{"‖H − H*‖, 0 if Hermitian", "N·s/m", 1}, {"½ λ_min of its Hermitian part", "N·s/m", 2}});
  const Eigen::MatrixXcd printed = Z(s) + Z(s).transpose(), right = Z(s) + Z(-s).transpose();
  for (const auto& [name, H] : {std::pair{"Z(jω) + Zᵀ(jω), as printed", &printed}, {"Z(jω) + Zᵀ(−jω)", &right}}) {
    const Eigen::MatrixXcd half = 0.5 * (*H + H->adjoint());
    table.rows.push_back(
        {name,
         {cell((*H - H->adjoint()).norm()),
          cell(0.5 * Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd>(half, Eigen::EigenvaluesOnly).eigenvalues()[0])}});
  }
  ReproducedTable lemma =
      computed_table("slip-5 lemma", "Re Z of m s + b + k/s, y axis of P1", "s", {{"Re Z", "N·s/m"}});
  const auto one = [&](std::complex<double> at) { return (p1.M(1, 1) * at + p1.B(1, 1) + p1.K(1, 1) / at).real(); };
  for (const double real : {-10.0, -1.0, 1.0}) lemma.rows.push_back({fmt::format("{:g}", real), {cell(one(real))}});
  lemma.rows.push_back({"jω, any ω", {cell(one(s))}});
  const std::vector<analyse::EnergyBlock> blocks = {analyse::energy_block(1.0, {{0.02, -0.2}, {0.05, -0.3}})};
  const double smallest = analyse::largest_shortage(blocks, {0}, 0.0);
  ReproducedTable lambda =
      computed_table("slip-5 shortage", fmt::format("(4.3) up to every t; the smallest λ is {:g} N·s/m", smallest), "λ",
                     {{"least of E + λ∫v² over t", "J", 2}, {"holds", "", 0}});
  for (const double value : {0.6 * smallest, smallest, 2.0 * smallest, 100.0 * smallest}) {
    double least = std::numeric_limits<double>::infinity();
    for (const analyse::EnergySums& sums : blocks[0].sums) {
      least = std::min(least, sums.absorbed + value * sums.squared_velocity);
    }
    lambda.rows.push_back({fmt::format("{:g} N·s/m", value), {cell(least), words(yes(least >= -1e-12))}});
  }
  exhibit.tables = {std::move(table), std::move(lemma), std::move(lambda)};
  return {};
}

namespace {

/// n over d of one entry, coefficients in ascending order.
lti::RationalFunction ratio(const lti::Polynomial& numerator, const lti::Polynomial& denominator) {
  return lti::RationalFunction::of(numerator, denominator).value_or(lti::RationalFunction());
}

teleop::TwoPort resistive(teleop::Form form, const std::array<Rational, 4>& entries) {
  teleop::TwoPort two_port{form, lti::RationalMatrix(2)};
  for (Index k = 0; k < 4; ++k) {
    two_port.matrix(k / 2, k % 2) = lti::RationalFunction(lti::Polynomial{entries[static_cast<std::size_t>(k)]});
  }
  return two_port;
}

/// Condition 3 as printed on a grid of the axis: the least of each.
teleop::ConditionValues least_on_a_grid(const teleop::TwoPort& two_port) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  teleop::ConditionValues least{kInfinity, kInfinity, kInfinity};
  for (int i = 0; i <= 200; ++i) {
    const Eigen::MatrixXcd z = two_port.matrix(RadPerSec(1e-3 * std::pow(1e6, i / 200.0)));
    const double r11 = z(0, 0).real(), r22 = z(1, 1).real();
    const std::complex<double> p = z(0, 1) * z(1, 0);
    least = {std::min(least.r11, r11), std::min(least.r22, r22),
             std::min(least.third, 2.0 * r11 * r22 - p.real() - std::abs(p))};
  }
  return least;
}

std::string violated_text(const AbsoluteStability& stability) {
  std::string text;
  for (const StabilityOutcome& outcome : stability.conditions) {
    if (!outcome.violated.empty()) text += fmt::format("{}{}", text.empty() ? "" : "; ", mbk::text(outcome.condition));
  }
  return text.empty() ? "none" : text;
}

}  // namespace

Result<void> any_immittance(Workbench& /*bench*/, Exhibit& exhibit) {
  exhibit.text = account(
      "Where: theorem 4.2. Printed: −a ≤ Re z_t2 ≤ b with conditions on b, and \"any immittance parameters\" in place "
      "of "
      "the impedance ones. Section 4.6 calls it theorem 4.1.",
      "Right: the upper bound never matters, for the criterion has no b in it: a termination with Re z ≥ −a is −a in "
      "series with a passive one, so z₂₂ → z₂₂ − a and then Llewellyn. A bound on Re z is none on Re 1/z, so port 2 "
      "has "
      "to stand as an impedance.",
      "What shows it: a resistive two-port z = [[0.2, 0.1], [0.1, 0.2]] with a = 1. Its y form passes the printed "
      "conditions with y₂₂ − a. Loop 2 has the resistance z₂₂ − a = −0.8 with port 1 open, so its current grows. The "
      "second table: a bound of −a on z allows −1/a on 1/z. The third: the shortage that a position–position "
      "teleoperator allows, exactly, and that of the closed form b_s + d_s b_m/(b_m + d_m).",
      "What moves: nothing that is printed; a design that is judged in its y form with the theorem as printed may be "
      "called stable and is not.",
      "Tests: Slips.ImmittanceFormHidesAShortage; mbk/teleop/two_port_test.cpp, "
      "WithShortage.TakesAFromTheImpedanceOfThatPortAlone.");
  exhibit.commands = {"mbk teleop examples/teleop/position_position.toml      # the largest shortage it allows"};
  exhibit.related = {"slip-17", "question-4", "slip-5"};
  const Rational a = 1;
  const teleop::TwoPort z =
      resistive(teleop::Form::z, {Rational(1, 5), Rational(1, 10), Rational(1, 10), Rational(1, 5)});
  const auto y = teleop::convert(z, teleop::Form::y);
  const auto right = teleop::with_shortage(z, teleop::Port::two, a);
  if (!y) return tl::unexpected(y.error());
  if (!right) return tl::unexpected(right.error());
  teleop::TwoPort printed = *y;
  printed.matrix(1, 1) = printed.matrix(1, 1) - lti::RationalFunction(lti::Polynomial{a});
  ReproducedTable table = computed_table(
      "slip-11", "A two-port with an operator of a = 1 N·s/m", "form",
      {{"r₁₁", "", 2}, {"r₂₂ − a", "", 2}, {"third condition, scaled", "", 2}, {"criterion says", "", 0}});
  for (const auto& [name, network] : std::array<std::pair<const char*, const teleop::TwoPort*>, 2>{
           {{"y₂₂ − a, as the theorem allows", &printed}, {"z₂₂ − a", &*right}}}) {
    const teleop::ConditionValues values = teleop::condition_values(network->matrix(RadPerSec(1.0)));
    table.rows.push_back({name,
                          {cell(values.r11), cell(values.r22), cell(values.third),
                           words(teleop::is_absolutely_stable(*network) ? "stable" : "not stable")}});
  }
  ReproducedTable bound = computed_table("slip-11 bound", "A termination z = −a, whose real part is not below −a", "a",
                                         {{"Re z", "N·s/m", 2}, {"Re 1/z", "m/(N·s)", 2}, {"−a holds for 1/z", "", 0}});
  for (const double value : {0.1, 0.5, 2.0}) {
    bound.rows.push_back(
        {fmt::format("{:g}", value), {cell(-value), cell(-1.0 / value), words(yes(-1.0 / value >= -value))}});
  }
  teleop::Teleoperator teleoperator;
  const int b_m = 2, b_s = 3, d_m = 10, d_s = 20;
  teleoperator.values = {{"master.m", 0},   {"slave.m", 0},    {"master.b", b_m}, {"slave.b", b_s},
                         {"master.d", d_m}, {"master.k", 100}, {"slave.d", d_s},  {"slave.k", 200}};
  const LargestShortage largest = teleop::largest_shortage(teleoperator.equations(), teleop::Port::two);
  ReproducedTable allowed =
      computed_table("slip-11 allowed", "The largest a of position–position, without any b", "",
                     {{"bisection between exact decisions", "N·s/m", 4}, {"closed form", "N·s/m", 4}});
  allowed.rows.push_back({"b_m = 2, b_s = 3, d_m = 10, d_s = 20 N·s/m",
                          {cell(largest.value()), cell(b_s + static_cast<double>(d_s * b_m) / (b_m + d_m))}});
  exhibit.tables = {std::move(table), std::move(bound), std::move(allowed)};
  return {};
}

Result<void> unnamed_poles(Workbench& /*bench*/, Exhibit& exhibit) {
  exhibit.text = account(
      "Where: theorem 4.1. Printed: poles of z₁₁ and z₂₂ on the right and on the axis, and condition 3 on the axis.",
      "Right: the axis includes infinity; z₁₂ and z₂₁ must have no pole on the right either; and residues at a pole on "
      "the axis have to meet k₁₁ k₂₂ ≥ k₁₂ k₂₁.",
      "What shows it: three networks that meet the printed conditions (the least values of condition 3 over 201 "
      "frequencies from 10⁻³ to 10³ rad/s are not negative) and that are not absolutely stable. With port 2 free, port "
      "1 shows z₁₁ − z₁₂z₂₁/z₂₂: a negative mass, an impedance with a pole on the right, a negative spring.",
      "What moves: nothing that is printed, for the thesis applies the theorem to no network.",
      "Tests: Slips.NetworksMeetTheTheoremAndAreNotStable; mbk/teleop/llewellyn_test.cpp, "
      "Llewellyn.AsksForJointResiduesThatTheTheoremDoesNotName.");
  exhibit.commands = {"mbk teleop examples/teleop/narrow_resonance.toml      # each condition, decided exactly"};
  exhibit.related = {"slip-11", "slip-3"};
  using lti::Polynomial;
  const Polynomial one{1}, s{0, 1};
  teleop::TwoPort mass{teleop::Form::z, lti::RationalMatrix(2)}, right = mass, spring = mass;
  mass.matrix(0, 0) = lti::RationalFunction(Polynomial{0, -1});
  mass.matrix(1, 1) = lti::RationalFunction(one);
  right.matrix(0, 0) = right.matrix(1, 1) = lti::RationalFunction(Polynomial{5});
  right.matrix(0, 1) = ratio(one, Polynomial{-1, 1});
  right.matrix(1, 0) = lti::RationalFunction(Polynomial{Rational(1, 10)});
  spring.matrix(0, 0) = spring.matrix(1, 1) = ratio(one, s);
  spring.matrix(0, 1) = spring.matrix(1, 0) = ratio(Polynomial{2}, s);
  ReproducedTable table = computed_table("slip-17", "Networks that meet theorem 4.1 as printed", "z",
                                         {{"least r₁₁", "", 3},
                                          {"least r₂₂", "", 3},
                                          {"least third condition", "", 3},
                                          {"absolutely stable", "", 0},
                                          {"what fails", "", 0}});
  for (const auto& [name, network] : {std::pair{"[[−s, 0], [0, 1]]", &mass},
                                      {"[[5, 1/(s − 1)], [0.1, 5]]", &right},
                                      {"[[1, 2], [2, 1]]/s", &spring}}) {
    const teleop::ConditionValues least = least_on_a_grid(*network);
    const AbsoluteStability stability = teleop::llewellyn(*network);
    table.rows.push_back({name,
                          {cell(least.r11), cell(least.r22), cell(least.third), words(yes(stability.holds())),
                           words(violated_text(stability))}});
  }
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> sign_of_the_force(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = account(
      "Where: (3.1) with F_h as output, F_h = Z V after (3.4), (4.3) and (5.2). Printed: with the F_h of (3.2), the "
      "force of the hand on the robot, all four have the other sign. (5.1) contradicts (5.2).",
      "Right: −F_h = Z V, E = −∫F_h·v dt, and J⁻ᵀ(I θ̈ + C θ̇ + F_r − τ) for the force on the robot.",
      "What shows it: P1's arm moved along x by 5 mm at 1 Hz, ten periods: it absorbs πbωa² in each. A robot that is "
      "pushed with 3 N and −2 N while it moves: (5.1) and (5.2) solved for the force.",
      "What moves: nothing that is printed; the energies of figures 3.15, 3.17 and 4.3 to 4.5 are drawn with the right "
      "sign. Coded literally, a passive arm looks active.",
      "Tests: Slips.PrintedSignsTurnEnergyAndForce; mbk/measure/analyse/absorbed_energy_test.cpp, "
      "AbsorbedEnergy.ChangesItsSignWithTheForce.");
  exhibit.commands = {
      "mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk measure relaxed.h5 --channels "
      "x=hand_x,y=hand_y,Fx=-force_x,Fy=-force_y,xr=reference_x,yr=reference_y      # warns of the sign; exit code 4"};
  exhibit.related = {"slip-5", "figure-3.15", "figure-4.3"};
  const impedance::Model p1 = model_of(arm_of(bench.given().sinusoidal, "P1"));
  const double amplitude = 0.005, omega = 2.0 * std::numbers::pi;
  constexpr int kSamples = 10000, kPeriods = 10;
  double integral = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double t = (i + 0.5) * kPeriods / kSamples;
    const double x = amplitude * std::sin(omega * t), v = omega * amplitude * std::cos(omega * t),
                 a = -omega * omega * x;
    const double force_hand_on_robot = -(p1.M(0, 0) * a + p1.B(0, 0) * v + p1.K(0, 0) * x);
    integral += force_hand_on_robot * v * kPeriods / kSamples;
  }
  const double expected = kPeriods * std::numbers::pi * p1.B(0, 0) * omega * amplitude * amplitude;
  ReproducedTable energy =
      computed_table("slip-18", "Energy that P1's arm absorbs in ten periods", "",
                     {{"∫F_h·v, as printed", "J", 4}, {"−∫F_h·v", "J", 4}, {"πbωa² a period", "J", 4}});
  energy.rows.push_back({"5 mm at 1 Hz along x", {cell(integral), cell(-integral), cell(expected)}});
  const robot::PlanarRobot robot;
  const Eigen::Vector2d theta(0.3, 0.9), rate(0.8, -0.5), acceleration(2.0, 1.0), push(3.0, -2.0);
  const Eigen::Vector2d torque = robot.motor_torque(theta, rate, acceleration, push);
  const Eigen::Vector2d without = robot.motor_torque(theta, rate, acceleration, {0.0, 0.0});
  const Eigen::Matrix2d J = robot::jacobian(robot.geometry, theta);
  const Eigen::Vector2d right = J.transpose().inverse() * (without - torque);
  const Eigen::Vector2d printed = J.transpose().inverse() * (torque - without);
  ReproducedTable force =
      computed_table("slip-18 robot", "Force on the robot from its motion and torques", "axis",
                     {{"pushed with", "N", 3}, {"from (5.1)", "N", 3}, {"from (5.2), as printed", "N", 3}});
  for (Index k = 0; k < 2; ++k) {
    force.rows.push_back({k == 0 ? "x" : "y", {cell(push[k]), cell(right[k]), cell(printed[k])}});
  }
  exhibit.tables = {std::move(energy), std::move(force)};
  return {};
}

}  // namespace mbk::thesis
