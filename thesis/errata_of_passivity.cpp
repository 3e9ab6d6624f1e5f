// Errata of chapters 3 and 4 about the passivity of the limb: theorems 3.1 and 3.2 and what follows from them.
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "mbk/base/lti/positive_real.h"
#include "mbk/base/lti/rational_passivity_index.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/measure/analyse/energy_blocks.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/model/robot/dynamics.h"
#include "thesis/errata.h"

namespace mbk::thesis {
namespace {

/// Z = M s + B + K/s, exactly.
Result<lti::RationalMatrix> impedance_of(const impedance::Model& model) {
  return lti::RationalMatrix::impedance(model.M, model.B, model.K);
}

Result<bool> is_positive_real(const impedance::Model& model) {
  const auto Z = MBK_TRY(impedance_of(model));
  const auto real = MBK_TRY(lti::positive_real(Z));
  return real.holds();
}

/// Smallest eigenvalue of Z(jω) + Z(jω)*, of the numbers themselves.
double smallest_of_hermitian_part(const impedance::Model& model, double omega) {
  const std::complex<double> s(0.0, omega);
  const Eigen::MatrixXcd Z = (model.M * s + model.B + model.K / s).eval();
  return numeric::hermitian_eigenvalues(Z + Z.adjoint())[0];
}

impedance::Model with_antisymmetry(impedance::Model model, double k_a) {
  model.K(0, 1) += k_a;
  model.K(1, 0) -= k_a;
  return model;
}

}  // namespace

Result<void> excess_of_the_largest(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {"mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk passivity relaxed.h5"};
  exhibit.related = {"table-3.6", "table-3.3", "table-3.5", "erratum-3", "question-4"};
  ReproducedTable table = computed_table("erratum-1", "participant",
                                         {{"λ_max/2, as published", "N·s/m", 2},
                                          {"λ_min", "N·s/m", 2},
                                          {"index of Z, exactly", "N·s/m", 2},
                                          {"λ_min(H − 2δI), δ as published", "N·s/m", 2}});
  const auto add = [&](const std::vector<PrintedArm>& arms, const char* perturbation) -> Result<void> {
    for (const PrintedArm& arm : arms) {
      const impedance::Model model = model_of(arm);
      const auto Z = MBK_TRY(impedance_of(model));
      const auto index = MBK_TRY(lti::input_passivity_index(Z));
      const double published = impedance::published_excess_of_passivity(model).value;
      table.rows.push_back({fmt::format("{}, {}", arm.name, perturbation),
                            {cell(published), cell(impedance::smallest_eigenvalue(model, 1).value), cell(index.value),
                             cell(smallest_of_hermitian_part(model, 1.0) - 2.0 * published)}});
    }
    return {};
  };
  MBK_TRY(add(bench.given().sinusoidal, "sinusoidal"));
  MBK_TRY(add(bench.given().underdamped, "underdamped"));
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> theorem_at_its_boundary(Workbench& /*bench*/, Draft& exhibit) {
  exhibit.commands = {"mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk passivity relaxed.h5"};
  exhibit.related = {"erratum-3", "erratum-4"};
  ReproducedTable table = computed_table(
      "erratum-2", "diag(0, −1) stands for",
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
    const auto real = MBK_TRY(is_positive_real(model));
    table.rows.push_back(
        {kNames[static_cast<std::size_t>(k)],
         {cell(Z(0, 0)), cell(determinant), words(Z(0, 0) >= 0.0 && determinant >= 0.0 ? "passive" : "not passive"),
          cell(impedance::smallest_eigenvalue(model, std::min(k, 2)).value), words(yes(real))}});
  }
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> theorem_without_poles(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {"mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk passivity relaxed.h5"};
  exhibit.related = {"erratum-1", "erratum-2", "erratum-17"};
  const impedance::Model p1 = model_of(arm_of(bench.given().sinusoidal, "P1"));
  const double excess = impedance::smallest_eigenvalue(p1, 1).value;
  const auto Z = MBK_TRY(impedance_of(p1));
  std::string finite;
  for (const auto& pole : lti::poles(Z)) finite += fmt::format("{}{:g}", finite.empty() ? "" : ", ", pole.real());
  exhibit.values = {{"finite_poles", finite}, {"poles_at_infinity", Z(0, 0).is_proper() ? "none" : "one"}};
  ReproducedTable table = computed_table(
      "erratum-3", "δ taken off the damping",
      {{"δ", "N·s/m", 3}, {"½ λ_min(H)", "N·s/m", 3}, {"λ_min(K)", "N/m", 1}, {"Z − δI positive real", "", 0}});
  const auto add = [&](const char* name, impedance::Model model, double delta) -> Result<void> {
    model.B -= delta * Matrix::Identity(2, 2);
    const auto real = MBK_TRY(is_positive_real(model));
    table.rows.push_back({name,
                          {cell(delta), cell(0.5 * smallest_of_hermitian_part(model, 1.0)),
                           cell(impedance::smallest_eigenvalue(model, 2).value), words(yes(real))}});
    return {};
  };
  impedance::Model springy = p1;
  springy.K = -springy.K;
  MBK_TRY(add("0.999 λ_min", p1, 0.999 * excess));
  MBK_TRY(add("1.001 λ_min", p1, 1.001 * excess));
  MBK_TRY(add("λ_max/2, as published", p1, impedance::published_excess_of_passivity(p1).value));
  MBK_TRY(add("0.999 λ_min, with −K in place of K", springy, 0.999 * excess));
  exhibit.tables = {std::move(table)};
  return {};
}

namespace {

/// Index of P1 over frequency, with and without its antisymmetric stiffness.
Chart index_chart(const impedance::Model& with, const impedance::Model& without) {
  Chart chart;
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

Result<void> antisymmetry_dropped(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {
      "mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk passivity relaxed.h5 --band 0.05:3      # against "
      "--band 0.5:3"};
  exhibit.related = {"figure-3.12", "figure-3.13", "erratum-2", "question-1"};
  const impedance::Model without = model_of(arm_of(bench.given().sinusoidal, "P1"));
  const double k_a = antisymmetric_stiffness(bench.given());
  const impedance::Model with = with_antisymmetry(without, k_a);
  exhibit.values = {
      {"k_a", k_a},
      {"not_passive_below", impedance::nonpassive_below(with).value_or(std::numeric_limits<double>::quiet_NaN())}};
  ReproducedTable table = computed_table(
      "erratum-4", "frequency",
      {{"index, closed form", "N·s/m", 2}, {"½ λ_min(Z + Z*)", "N·s/m", 2}, {"without k_a", "N·s/m", 2}});
  for (const double frequency : {0.05, 0.1, 0.2, 0.5, 1.0, 3.0}) {
    const double omega = 2.0 * std::numbers::pi * frequency;
    table.rows.push_back(
        {fmt::format("{:g} Hz", frequency),
         {cell(impedance::passivity_index(with, omega).value), cell(0.5 * smallest_of_hermitian_part(with, omega)),
          cell(impedance::passivity_index(without, omega).value)}});
  }
  ReproducedTable tolerated =
      computed_table("erratum-4 tolerated", "participant", {{"k_a", "N/m", 1}, {"not passive below", "Hz", 2}});
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

Result<void> hermitian_part(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {
      "mbk simulate rigid_underdamped_2N --out rigid.h5 && mbk passivity rigid.h5      # shortage at "
      "the end and at its largest"};
  exhibit.related = {"erratum-1", "erratum-18", "table-4.5", "figure-4.3"};
  const impedance::Model p1 = model_of(arm_of(bench.given().sinusoidal, "P1"));
  const std::complex<double> s(0.0, 2.0 * std::numbers::pi);
  const auto Z = [&](std::complex<double> at) { return (p1.M * at + p1.B + p1.K / at).eval(); };
  ReproducedTable table = computed_table(
      "erratum-5", "H is", {{"‖H − H*‖, 0 if Hermitian", "N·s/m", 1}, {"½ λ_min of its Hermitian part", "N·s/m", 2}});
  const Eigen::MatrixXcd printed = Z(s) + Z(s).transpose(), right = Z(s) + Z(-s).transpose();
  for (const auto& [name, H] : {std::pair{"Z(jω) + Zᵀ(jω), as printed", &printed}, {"Z(jω) + Zᵀ(−jω)", &right}}) {
    const Eigen::MatrixXcd half = 0.5 * (*H + H->adjoint());
    table.rows.push_back(
        {name, {cell((*H - H->adjoint()).norm()), cell(0.5 * numeric::hermitian_eigenvalues(half)[0])}});
  }
  ReproducedTable lemma = computed_table("erratum-5 lemma", "s", {{"Re Z", "N·s/m"}});
  const auto one = [&](std::complex<double> at) { return (p1.M(1, 1) * at + p1.B(1, 1) + p1.K(1, 1) / at).real(); };
  for (const double real : {-10.0, -1.0, 1.0}) lemma.rows.push_back({fmt::format("{:g}", real), {cell(one(real))}});
  lemma.rows.push_back({"jω, any ω", {cell(one(s))}});
  const std::vector<analyse::EnergyBlock> blocks = {analyse::energy_block(1.0, {{0.02, -0.2}, {0.05, -0.3}})};
  const double smallest = analyse::largest_shortage(blocks, {0}, 0.0);
  exhibit.values = {{"smallest", smallest}};
  ReproducedTable lambda =
      computed_table("erratum-5 shortage", "λ", {{"least of E + λ∫v² over t", "J", 2}, {"holds", "", 0}});
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

Result<void> sign_of_the_force(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {
      "mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk measure relaxed.h5 --channels "
      "x=hand_x,y=hand_y,Fx=-force_x,Fy=-force_y,xr=reference_x,yr=reference_y      # warns of the sign; exit code 4"};
  exhibit.related = {"erratum-5", "figure-3.15", "figure-4.3"};
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
  ReproducedTable energy = computed_table(
      "erratum-18", "", {{"∫F_h·v, as printed", "J", 4}, {"−∫F_h·v", "J", 4}, {"πbωa² a period", "J", 4}});
  energy.rows.push_back({"5 mm at 1 Hz along x", {cell(integral), cell(-integral), cell(expected)}});
  const robot::PlanarRobot robot;
  const Eigen::Vector2d theta(0.3, 0.9), rate(0.8, -0.5), acceleration(2.0, 1.0), push(3.0, -2.0);
  const Eigen::Vector2d torque = robot.motor_torque(theta, rate, acceleration, push);
  const Eigen::Vector2d without = robot.motor_torque(theta, rate, acceleration, {0.0, 0.0});
  const Eigen::Matrix2d J = robot::jacobian(robot.geometry, theta);
  const Eigen::Vector2d right = J.transpose().inverse() * (without - torque);
  const Eigen::Vector2d printed = J.transpose().inverse() * (torque - without);
  ReproducedTable force =
      computed_table("erratum-18 robot", "axis",
                     {{"pushed with", "N", 3}, {"from (5.1)", "N", 3}, {"from (5.2), as printed", "N", 3}});
  for (Index k = 0; k < 2; ++k) {
    force.rows.push_back({k == 0 ? "x" : "y", {cell(push[k]), cell(right[k]), cell(printed[k])}});
  }
  exhibit.tables = {std::move(energy), std::move(force)};
  return {};
}

}  // namespace mbk::thesis
