#include "mbk/measure/identify/consistent_model.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/measure/identify/regression.h"

namespace mbk::identify {
namespace {

constexpr double kZero = 1e-9;  // of the largest eigenvalue: the solver's own numbers are good to 1e-10

double smallest_eigenvalue(const Matrix& matrix) {
  return numeric::symmetric_eigenvalues(0.5 * (matrix + matrix.transpose()))[0];
}

Semidefiniteness compare(const Matrix& free, const Matrix& consistent) {
  Semidefiniteness result{smallest_eigenvalue(free), smallest_eigenvalue(consistent), false};
  result.active = result.smallest <= kZero * free.norm() && result.free_smallest < result.smallest;
  return result;
}

/// What `model_of` was made from.
Matrix coefficients_of(const impedance::Model& model, const Vector& centre, double handle_mass) {
  const Index n = model.axes();
  Matrix coefficients(3 * n + 1, n);
  coefficients << (model.M + handle_mass * Matrix::Identity(n, n)).transpose(), model.B.transpose(),
      model.K.transpose(), (model.K * (centre - model.x0)).transpose();
  return coefficients;
}

/// x₀ of a limb that is free in one direction is NaN.
/// @param free  of the free fit: what its stiffness is zero beside
impedance::Model model_with_equilibrium(const Matrix& coefficients, const Vector& centre, double handle_mass,
                                        const impedance::Model& free) {
  impedance::Model model = model_of(coefficients, centre, handle_mass);
  if (smallest_eigenvalue(model.K) <= kZero * free.K.norm()) {
    model.x0.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return model;
}

/// |Y − Z θ|²/N of three θ, and |Z Δ|²/N; block by block, so that the rows come from memory once.
std::array<double, 4> residual_powers(const numeric::MatrixPart& Z, const numeric::MatrixPart& Y,
                                      const std::array<const Matrix*, 3>& theta, const Matrix& change) {
  constexpr Index kBlock = 1024;
  const Index n = Y.cols();
  std::array<double, 4> powers{};
  Matrix coefficients(Z.cols(), 4 * n);
  coefficients << *theta[0], *theta[1], *theta[2], change;
  for (Index begin = 0; begin < Z.rows(); begin += kBlock) {
    const Index rows = std::min(kBlock, Z.rows() - begin);
    const auto target = Y.middleRows(begin, rows);
    Matrix targets(rows, 4 * n);
    targets << target, target, target, Matrix::Zero(rows, n);
    const Matrix left = numeric::residuals_of({Z.middleRows(begin, rows)}, targets, coefficients);
    for (std::size_t k = 0; k < powers.size(); ++k) {
      powers[k] += left.middleCols(static_cast<Index>(k) * n, n).squaredNorm();
    }
  }
  for (double& power : powers) power /= static_cast<double>(Z.rows());
  return powers;
}

}  // namespace

Result<ConsistentCoefficients> nearest_consistent(const Matrix& coefficients, const Matrix& gram, Structure structure,
                                                  double handle_mass) {
  const Index n = coefficients.cols(), p = 3 * n + 1;
  if (n == 0 || coefficients.rows() != p || gram.rows() != p || gram.cols() != p) {
    return bad_usage(fmt::format("coefficients of {}×{} and a weight of {}×{} do not match", coefficients.rows(), n,
                                 gram.rows(), gram.cols()));
  }
  if (!coefficients.allFinite() || !gram.allFinite() || !std::isfinite(handle_mass)) {
    return bad_data("a coefficient, its weight or the handle's mass is not finite");
  }
  if (!numeric::Cholesky(gram).positive_definite()) {
    return fail(ErrorKind::not_usable, "the terms of the model are not identifiable from this motion",
                "perturb the limb in more directions and frequencies");
  }
  const Matrix S = structure_matrix(structure == Structure::full ? Structure::symmetric : structure, n);
  Matrix W = Matrix::Zero(n * p, n * p);
  for (Index j = 0; j < n; ++j) W.block(j * p, j * p, p, p) = gram;
  const Vector theta = coefficients.reshaped();

  numeric::ConeProgram program;
  program.P = S.transpose() * W * S;
  program.q = Vector::Zero(S.cols());
  // What obeys the ties already is left as it is to the last digit but rounding.
  Vector tied = numeric::PivotedQr(S).solve(theta);
  const Vector unit = program.P.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix scaled = unit.asDiagonal() * program.P * unit.asDiagonal();
  tied += unit.asDiagonal() *
          numeric::PivotedCholesky(scaled).solve(unit.asDiagonal() * (S.transpose() * (W * (theta - S * tied))));

  for (Index part = 0; part < 3; ++part) {  // M, B, K: row j of each belongs to output j
    Matrix A(n * n, S.cols());
    for (Index j = 0; j < n; ++j) A.middleRows(j * n, n) = S.middleRows(j * p + part * n, n);
    if (A.isZero(0.0)) continue;
    Vector b = A * tied;
    if (part == 0) b -= handle_mass * Vector(Matrix::Identity(n, n).reshaped());
    program.cones.push_back({std::move(A), std::move(b)});
  }
  auto solution = MBK_TRY(numeric::solve_cone_program(program));
  ConsistentCoefficients result;
  result.tied = Vector(S * tied).reshaped(p, n);
  result.coefficients = Vector(S * (tied + solution.x)).reshaped(p, n);
  result.certificate = std::move(solution);
  return result;
}

Result<ConsistentFit> consistent_model(const std::vector<PreparedTrial>& trials, const Identification& found) {
  const auto foreign = [] {
    return bad_usage("the model was not identified from these trials", "give the trials that it was identified from");
  };
  if (trials.empty() || !std::ranges::all_of(trials, [&](const auto& trial) { return trial.axes == found.axes; })) {
    return foreign();
  }
  const Regression r = stack_motion_and_force(trials);
  const bool all = found.parameters_from == ParametersFrom::all;
  const std::vector<RowRange> ranges = all ? joined(r.identification, r.validation) : joined(r.identification, {});
  const SelectedRows Z(r.Z, ranges), Y(r.Y, ranges);
  if (Z->rows() != found.samples || Z->rows() == 0) return foreign();
  const auto nearest = [&](const impedance::Model& model, const SelectedRows& rows) {
    return nearest_consistent(coefficients_of(model, r.centre, found.handle_mass), numeric::gram_of({*rows}),
                              found.structure, found.handle_mass);
  };
  if (!impedance::stacked(found.model).allFinite() || !impedance::stacked(found.judged).allFinite()) {
    return fail(ErrorKind::not_usable, "there is no model", "perturb the limb in more directions and frequencies");
  }
  const auto fit = nearest(found.model, Z);
  if (!fit) return tl::unexpected(fit.error());
  // Not copied: the copy of a Result must not throw, and this one may want memory.
  std::optional<Result<ConsistentCoefficients>> of_judged;
  if (all && !r.validation.empty()) of_judged.emplace(nearest(found.judged, SelectedRows(r.Z, r.identification)));
  const Result<ConsistentCoefficients>& check = of_judged ? *of_judged : fit;
  if (!check) return tl::unexpected(check.error());

  ConsistentFit result;
  result.model = model_with_equilibrium(fit->coefficients, r.centre, found.handle_mass, found.model);
  result.judged = model_with_equilibrium(check->coefficients, r.centre, found.handle_mass, found.judged);
  result.centre = r.centre;
  result.force_at_centre = fit->coefficients.bottomRows(1).transpose();
  result.inertia = compare(found.model.M, result.model.M);
  result.damping = compare(found.model.B, result.model.B);
  result.stiffness = compare(found.model.K, result.model.K);
  result.fit = judge(r, check->coefficients);
  const Matrix free = coefficients_of(found.model, r.centre, found.handle_mass);
  const auto powers = residual_powers(*Z, *Y, {&free, &fit->tied, &fit->coefficients}, fit->coefficients - free);
  result.residual_power_free = powers[0];
  result.residual_power_tied = powers[1];
  result.residual_power = powers[2];
  result.force_change = std::sqrt(powers[3]);
  const Index matrices = 3 * found.model.M.size();
  const Vector change = (impedance::stacked(result.model) - impedance::stacked(found.model)).head(matrices);
  const Vector error = impedance::stacked(found.standard_error).head(matrices);
  for (Index i = 0; i < matrices; ++i) {
    const double errors = std::abs(change[i]) / error[i];
    if (!(errors > result.largest_change_errors)) continue;
    result.largest_change_errors = errors;
    result.largest_change = found.parameters[static_cast<std::size_t>(i)];
  }
  result.duality_gap = fit->certificate.gap;
  return result;
}

}  // namespace mbk::identify
