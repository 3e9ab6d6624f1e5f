#include "mbk/measure/explore/stiffness_regression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::explore {
namespace {

constexpr double kOneLine = 0.05;        // smallest over largest eigenvalue of Σ z zᵀ
constexpr double kSameDirection = 0.02;  // of |z|: commands that are repetitions of each other
constexpr int kMinPureError = 4;         // degrees of freedom behind a test of linearity

/// Which commands are the same: for each displacement the number of its group.
std::vector<int> groups_of(std::span<const DisplacedHand> displaced, int& groups) {
  std::vector<int> group(displaced.size(), -1);
  groups = 0;
  for (std::size_t i = 0; i < displaced.size(); ++i) {
    if (group[i] >= 0) continue;
    for (std::size_t j = i; j < displaced.size(); ++j) {
      if ((displaced[j].commanded - displaced[i].commanded).norm() <= kSameDirection * displaced[i].commanded.norm()) {
        group[j] = groups;
      }
    }
    ++groups;
  }
  return group;
}

/// F of the mean residuals of the groups against the scatter in them, the smaller p of the axes times their number.
std::optional<double> lack_of_fit(const Matrix& residuals, const std::vector<int>& group, int groups) {
  const auto n = static_cast<int>(residuals.rows()), axes = static_cast<int>(residuals.cols());
  if (groups <= axes || n - groups < kMinPureError) return std::nullopt;
  Matrix sum = Matrix::Zero(groups, axes);
  Vector count = Vector::Zero(groups);
  for (Index i = 0; i < n; ++i) {
    sum.row(group[static_cast<std::size_t>(i)]) += residuals.row(i);
    count[group[static_cast<std::size_t>(i)]] += 1.0;
  }
  double p = 1.0;
  for (int a = 0; a < axes; ++a) {
    double between = 0.0;
    for (Index g = 0; g < groups; ++g) between += sum(g, a) * sum(g, a) / count[g];
    const double within = residuals.col(a).squaredNorm() - between;
    const double first = groups - axes, second = n - groups;
    if (!(within > 0.0)) continue;
    p = std::min(p, axes * numeric::f_probability_above(between / first / (within / second), first, second));
  }
  return std::min(p, 1.0);
}

/// (tr Ω)²/tr Ω² with Ω = (I − H) D (I − H), D = diag(a_ik²/(1 − h_i)), H_ij = a_jᵀ d_i.
double bell_mccaffrey(const Matrix& a, const Matrix& d, Index k) {
  constexpr Index kMax = 1000;  // above, all but the share of each displacement is negligible
  const Index n = a.rows();
  if (n > kMax) return std::pow(a.col(k).squaredNorm(), 2) / a.col(k).cwiseAbs2().squaredNorm();
  Vector weight(n);
  for (Index i = 0; i < n; ++i) weight[i] = a(i, k) * a(i, k) / (1.0 - a.row(i).dot(d.row(i)));
  double squared = 0.0;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const double m = (i == j ? 1.0 : 0.0) - a.row(j).dot(d.row(i));
      squared += weight[i] * weight[j] * m * m;
    }
  }
  return std::pow(a.col(k).squaredNorm(), 2) / squared;
}

}  // namespace

Result<StiffnessRegression> regress_stiffness(std::span<const DisplacedHand> displaced) {
  const auto n = static_cast<Index>(displaced.size());
  if (n < kMinDisplacements) {
    return bad_data(fmt::format("{} displacements are fewer than {}", n, kMinDisplacements), "repeat them more often");
  }
  const Index axes = displaced.front().commanded.size();
  Matrix z(n, axes), d(n, axes), f(n, axes);
  for (Index i = 0; i < n; ++i) {
    const DisplacedHand& one = displaced[static_cast<std::size_t>(i)];
    z.row(i) = one.commanded.transpose();
    d.row(i) = one.displacement.transpose();
    f.row(i) = one.force.transpose();
  }
  if (!z.allFinite() || !d.allFinite() || !f.allFinite()) return bad_data("a displacement or its force is not finite");
  const Matrix squares = z.transpose() * z;
  const Vector spread = numeric::symmetric_eigenvalues(squares);
  if (!(spread[0] > kOneLine * spread[axes - 1])) {
    return bad_data("the displacements lie along one line: the stiffness perpendicular to it is not identifiable",
                    "displace the hand in several directions, ideally eight");
  }
  StiffnessRegression fit;
  const Matrix crossed = d.transpose() * z;
  fit.reached = numeric::singular_values(crossed * numeric::inverse(squares))[axes - 1];
  if (!(fit.reached > 1e-6)) {
    return bad_data("the hand does not follow the reference at all", "check the units and the order of the channels");
  }
  const Matrix a = z * numeric::inverse(crossed);  // rows a_iᵀ
  fit.K = f.transpose() * a;
  const Matrix residuals = f - d * fit.K.transpose();
  fit.covariance = Matrix::Zero(axes * axes, axes * axes);
  for (Index i = 0; i < n; ++i) {
    const double scale = 1.0 / std::max(0.1, 1.0 - a.row(i).dot(d.row(i)));
    Vector score(axes * axes);
    for (Index r = 0; r < axes; ++r) score.segment(r * axes, axes) = residuals(i, r) * a.row(i).transpose();
    fit.covariance += scale * score * score.transpose();
  }
  fit.standard_error = fit.half_width95 = Matrix::Zero(axes, axes);
  for (Index k = 0; k < axes; ++k) {
    const double freedom = std::max(1.0, bell_mccaffrey(a, d, k));
    fit.degrees_of_freedom = k == 0 ? freedom : std::min(fit.degrees_of_freedom, freedom);
    const double t = numeric::student_quantile(0.975, static_cast<int>(freedom));
    for (Index r = 0; r < axes; ++r) {
      fit.standard_error(r, k) = std::sqrt(std::max(0.0, fit.covariance(r * axes + k, r * axes + k)));
      fit.half_width95(r, k) = t * fit.standard_error(r, k);
    }
  }
  fit.residual_rms = (residuals.cwiseAbs2().colwise().sum() / static_cast<double>(n - axes)).cwiseSqrt().transpose();
  fit.relative_error = fit.standard_error.norm() / fit.K.norm();
  fit.displacements = static_cast<int>(n);
  fit.amplitude = z.rowwise().norm().mean();
  const std::vector<int> group = groups_of(displaced, fit.directions);
  fit.linear_p = lack_of_fit(residuals, group, fit.directions);
  return fit;
}

}  // namespace mbk::explore
