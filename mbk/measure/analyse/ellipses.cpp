#include "mbk/measure/analyse/ellipses.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/base/numeric/statistics.h"

namespace mbk::analyse {
namespace {

double standard_error(const Eigen::RowVector4d& gradient, const Eigen::Matrix4d& covariance) {
  const double variance = (gradient * covariance * gradient.transpose()).value();
  return variance < 0.0 ? 0.0 : std::sqrt(variance);  // NaN, where there is no covariance, stays NaN
}

/// What is known of v = [(z_xx − z_yy)/2, z_s], whose direction is twice the orientation and whose length is half the
/// difference of the eigenvalues.
class Deviator {
 public:
  Deviator(const Matrix& Z, const Eigen::Matrix4d& covariance) {
    Eigen::Matrix<double, 2, 4> of;
    of << 0.5, 0.0, 0.0, -0.5, 0.0, 0.5, 0.5, 0.0;
    v_ << 0.5 * (Z(0, 0) - Z(1, 1)), 0.5 * (Z(0, 1) + Z(1, 0));
    const Eigen::LLT<Eigen::Matrix2d> factor(of * covariance * of.transpose());
    known_ = covariance.allFinite() && factor.info() == Eigen::Success;
    if (!known_) return;
    root_ = factor.matrixL();
    white_ = root_.triangularView<Eigen::Lower>().solve(v_);
  }

  [[nodiscard]] bool may_be_zero() const {
    constexpr double kChiSquared2 = 5.991464547107982;
    return known_ && white_.squaredNorm() <= kChiSquared2;
  }

  /// The directions of the vectors that lie within 1.96 standard errors of their own component across v: between the
  /// tangents from the origin to that ellipse around v.
  [[nodiscard]] Interval orientation95() const {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    if (!known_) return {kNaN, kNaN};
    const double at = 0.5 * std::atan2(v_[1], v_[0]);
    const double centre = at < 0.0 ? at + std::numbers::pi : at;
    constexpr double kAny = 0.5 * std::numbers::pi * (1.0 + 1e-12);  // 180° wide in any unit
    if (may_be_zero()) return {centre - kAny, centre + kAny};
    const double half = std::asin(numeric::kNormal95 / white_.norm());
    const auto turned = [&](double angle) {
      const Eigen::Vector2d edge = root_ * (Eigen::Rotation2Dd(angle) * white_);
      return 0.5 * std::remainder(std::atan2(edge[1], edge[0]) - 2.0 * at, 2.0 * std::numbers::pi);
    };
    const auto [low, high] = std::minmax({turned(-half), turned(half)});
    return {centre + low, centre + high};
  }

 private:
  Eigen::Vector2d v_, white_;
  Eigen::Matrix2d root_;
  bool known_ = false;
};

}  // namespace

EllipseFinding ellipse_finding(const Matrix& Z, const Eigen::Matrix4d& covariance) {
  EllipseFinding finding;
  finding.symmetric = impedance::symmetric_part(Z);
  finding.ellipse = impedance::ellipse(Z);
  const impedance::EllipseGradient gradient = impedance::ellipse_gradient(Z);
  finding.area95 = numeric::positive_interval95(finding.ellipse.area, standard_error(gradient.area, covariance));
  finding.shape95 = numeric::positive_interval95(finding.ellipse.shape, standard_error(gradient.shape, covariance));
  finding.lambda_min95 =
      numeric::interval95(finding.ellipse.lambda_min, standard_error(gradient.lambda_min, covariance));
  finding.lambda_max95 =
      numeric::interval95(finding.ellipse.lambda_max, standard_error(gradient.lambda_max, covariance));
  const Deviator deviator(Z, covariance);
  finding.orientation95 = deviator.orientation95();
  finding.round = deviator.may_be_zero();
  const bool closed = finding.ellipse.lambda_min > 0.0;
  if (closed) finding.shape95.first = std::max(finding.shape95.first, 1.0);
  if (!finding.round) return finding;
  // Both eigenvalues may be their mean.
  const Interval mean =
      numeric::interval95(0.5 * (Z(0, 0) + Z(1, 1)), standard_error({0.5, 0.0, 0.0, 0.5}, covariance));
  if (closed) finding.shape95.first = 1.0;
  finding.lambda_min95.second = std::max(finding.lambda_min95.second, mean.second);
  finding.lambda_max95.first = std::min(finding.lambda_max95.first, mean.first);
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
  if (identification.axes != 2) return bad_data("a result with one axis has no ellipses", "use a result with two axes");
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
