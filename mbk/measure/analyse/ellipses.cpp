#include "mbk/measure/analyse/ellipses.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/base/numeric/statistics.h"

namespace mbk::analyse {
namespace {

double standard_error(const Eigen::RowVector4d& gradient, const Eigen::Matrix4d& covariance) {
  const double variance = (gradient * covariance * gradient.transpose()).value();
  return variance < 0.0 ? 0.0 : std::sqrt(variance);  // NaN, where there is no covariance, stays NaN
}

}  // namespace

EllipseFinding ellipse_finding(const Matrix& Z, const Eigen::Matrix4d& covariance) {
  EllipseFinding finding;
  finding.symmetric = impedance::symmetric_part(Z);
  finding.ellipse = impedance::ellipse(Z);
  const impedance::EllipseGradient gradient = impedance::ellipse_gradient(Z);
  finding.area95 = numeric::positive_interval95(finding.ellipse.area, standard_error(gradient.area, covariance));
  finding.shape95 = numeric::positive_interval95(finding.ellipse.shape, standard_error(gradient.shape, covariance));
  finding.orientation95 =
      numeric::interval95(finding.ellipse.orientation, standard_error(gradient.orientation, covariance));
  return finding;
}

AntisymmetryFinding antisymmetry_finding(const Matrix& Z, const Eigen::Matrix4d& covariance) {
  AntisymmetryFinding finding;
  finding.value = impedance::antisymmetric_part(Z);
  const Eigen::RowVector4d gradient(0.0, 0.5, -0.5, 0.0);
  finding.value95 = numeric::interval95(finding.value, standard_error(gradient, covariance));
  finding.zmean_percent = impedance::antisymmetry_percent(Z);
  if (std::isnan(finding.zmean_percent) || std::isnan(finding.value95.first)) {
    finding.zmean95 = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    return finding;
  }
  // |z_a| folds the interval of z_a at zero; the geometric mean of the eigenvalues is known far better than z_a.
  const impedance::Ellipse e = impedance::ellipse(Z);
  const double scale = 100.0 / std::sqrt(e.lambda_max * e.lambda_min);
  const auto [low, high] = finding.value95;
  finding.zmean95 = {low <= 0.0 && high >= 0.0 ? 0.0 : scale * std::min(std::abs(low), std::abs(high)),
                     scale * std::max(std::abs(low), std::abs(high))};
  return finding;
}

Result<Findings> analyse_ellipses(const Identification& identification) {
  if (identification.axes != 2) return bad_data("one axis has no ellipse", "ellipses need a result with two axes");
  const auto block = [&](Index part) {
    return Eigen::Matrix4d(identification.covariance.block<4, 4>(4 * part, 4 * part));
  };
  const impedance::Model& model = identification.model;
  Findings findings;
  findings.ellipses = {ellipse_finding(model.M, block(0)), ellipse_finding(model.B, block(1)),
                       ellipse_finding(model.K, block(2))};
  findings.antisymmetry = {antisymmetry_finding(model.M, block(0)), antisymmetry_finding(model.K, block(2))};
  return findings;
}

}  // namespace mbk::analyse
