#include "mbk/measure/analyse/ellipses.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::analyse {
namespace {

template <class Gradient, class Covariance>
double standard_error(const Gradient& gradient, const Covariance& covariance) {
  const double variance = (gradient * covariance * gradient.transpose()).value();
  return variance < 0.0 ? 0.0 : std::sqrt(variance);  // NaN, where there is no covariance, stays NaN
}

constexpr double kChiSquared2 = 5.991464547107982, kChiSquared3 = 7.814727903251179,
                 kChiSquared5 = 11.070497693516351;  // 95 %

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

  [[nodiscard]] bool may_be_zero() const { return known_ && white_.squaredNorm() <= kChiSquared2; }

  /// The directions of the vectors that lie within so many standard errors of their own component across v: between the
  /// tangents from the origin to that ellipse around v.
  [[nodiscard]] Interval orientation95(double errors = numeric::kNormal95) const {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    if (!known_) return {kNaN, kNaN};
    const double at = 0.5 * std::atan2(v_[1], v_[0]);
    const double centre = at < 0.0 ? at + std::numbers::pi : at;
    constexpr double kAny = 0.5 * std::numbers::pi * (1.0 + 1e-12);  // 180° wide in any unit
    if (may_be_zero()) return {centre - kAny, centre + kAny};
    const double half = std::asin(errors / white_.norm());
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

/// Derivative of uᵀ Z w by the elements of Z, row by row.
Eigen::RowVectorXd bilinear(const Vector& u, const Vector& w) {
  return Vector((w * u.transpose()).reshaped()).transpose();
}

/// Whether a sphere is not rejected: of three eigenvalues the largest and the smallest are farther apart by chance than
/// two, so that this is tested for all three together.
bool may_be_sphere(const Matrix& Z, const Matrix& covariance) {
  Matrix to_deviator = Matrix::Zero(5, 9);
  to_deviator.row(0) << 0.5, 0, 0, 0, -0.5, 0, 0, 0, 0;
  to_deviator.row(1) << 1, 0, 0, 0, 1, 0, 0, 0, -2;
  for (Index k = 0; k < 3; ++k) {
    const Index i = k, j = (k + 1) % 3;
    to_deviator(2 + k, 3 * i + j) = to_deviator(2 + k, 3 * j + i) = 0.5;
  }
  const Vector deviator = to_deviator * Vector(Matrix(Z.transpose()).reshaped());
  const Matrix spread = to_deviator * covariance * to_deviator.transpose();
  return spread.allFinite() && deviator.dot(Vector(numeric::PivotedCholesky(spread).solve(deviator))) <= kChiSquared5;
}

/// What is known of the symmetric part in the plane of two of its principal directions.
class PrincipalPlane {
 public:
  PrincipalPlane(const Matrix& Z, const Matrix& covariance, const Vector& u, const Vector& w)
      : to_plane_(rows(u, w)), deviator_(in_plane(Z, u, w), to_plane_ * covariance * to_plane_.transpose()) {
    const Eigen::RowVectorXd mean = 0.5 * (to_plane_.row(0) + to_plane_.row(3));
    mean95_ = numeric::interval95(0.5 * (u.dot(Z * u) + w.dot(Z * w)), standard_error(mean, covariance));
  }

  [[nodiscard]] bool may_be_round() const { return deviator_.may_be_zero(); }
  [[nodiscard]] const Interval& mean95() const { return mean95_; }

  /// How far an axis may be turned in this plane [rad], as one direction of two in which it may be.
  [[nodiscard]] double half_angle95() const {
    if (may_be_round()) return 0.5 * std::numbers::pi;
    const auto [low, high] = deviator_.orientation95(std::sqrt(kChiSquared2));
    return std::max(-low, high);  // around 0, as the first direction has the larger eigenvalue
  }

 private:
  static Matrix rows(const Vector& u, const Vector& w) {
    Matrix all(4, u.size() * u.size());
    all << bilinear(u, u), bilinear(u, w), bilinear(w, u), bilinear(w, w);
    return all;
  }
  static Matrix in_plane(const Matrix& Z, const Vector& u, const Vector& w) {
    const Matrix S = impedance::symmetric_part(Z);
    return (Matrix(2, 2) << u.dot(S * u), 0.0, 0.0, w.dot(S * w)).finished();
  }

  Matrix to_plane_;
  Deviator deviator_;
  Interval mean95_;
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
  const Interval mean = numeric::interval95(0.5 * (Z(0, 0) + Z(1, 1)),
                                            standard_error(Eigen::RowVector4d(0.5, 0.0, 0.0, 0.5), covariance));
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

EllipsoidFinding ellipsoid_finding(const Matrix& Z, const Matrix& covariance) {
  EllipsoidFinding finding;
  finding.symmetric = impedance::symmetric_part(Z);
  const auto [values, vectors] = numeric::symmetric_eigen(finding.symmetric);
  std::array<Eigen::RowVectorXd, 3> gradient;
  for (Index k = 0; k < 3; ++k) {
    const auto place = static_cast<std::size_t>(k);
    Vector v = vectors.col(2 - k);
    Index largest = 0;
    v.cwiseAbs().maxCoeff(&largest);
    if (v[largest] < 0.0) v = -v;
    gradient[place] = bilinear(v, v);
    PrincipalDirection& one = finding.principal[place];
    one.value = values[2 - k];
    one.value95 = numeric::interval95(one.value, standard_error(gradient[place], covariance));
    one.direction = v;
    one.half_angle95 = 0.0;
  }
  // What λ₁ and λ₃ may be: themselves, or the mean with what may be equal to them.
  std::vector<std::pair<double, Eigen::RowVectorXd>> largest = {{finding.principal[0].value, gradient[0]}},
                                                     smallest = {{finding.principal[2].value, gradient[2]}};
  const auto mean = [&](std::size_t i, std::size_t j) {
    return std::pair<double, Eigen::RowVectorXd>(0.5 * (finding.principal[i].value + finding.principal[j].value),
                                                 0.5 * (gradient[i] + gradient[j]));
  };
  const bool sphere = may_be_sphere(Z, covariance);
  for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>(0, 1), {1, 2}, {0, 2}}) {
    PrincipalDirection &larger = finding.principal[i], &smaller = finding.principal[j];
    const PrincipalPlane plane(Z, covariance, larger.direction, smaller.direction);
    const bool round = sphere || plane.may_be_round();
    const double angle = round ? 0.5 * std::numbers::pi : plane.half_angle95();
    for (PrincipalDirection* one : {&larger, &smaller}) {
      one->half_angle95 = std::isnan(angle) ? angle : std::max(one->half_angle95, angle);
    }
    if (!round) continue;
    if (i == 0) largest.push_back(mean(i, j));
    if (j == 2) smallest.push_back(mean(i, j));
    smaller.value95.second = std::max(smaller.value95.second, plane.mean95().second);
    larger.value95.first = std::min(larger.value95.first, plane.mean95().first);
  }
  if (sphere) {
    const Eigen::RowVectorXd of_trace = (gradient[0] + gradient[1] + gradient[2]) / 3.0;
    const Interval mean95 = numeric::interval95(finding.symmetric.trace() / 3.0, standard_error(of_trace, covariance));
    finding.principal[0].value95.first = std::min(finding.principal[0].value95.first, mean95.first);
    finding.principal[2].value95.second = std::max(finding.principal[2].value95.second, mean95.second);
  }
  const double first = finding.principal[0].value, second = finding.principal[1].value,
               third = finding.principal[2].value;
  finding.closed = finding.principal[2].value95.first > 0.0;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  finding.volume = finding.shape = kNaN;
  finding.volume95 = finding.shape95 = {kNaN, kNaN};
  if (!(third > 0.0)) return finding;
  finding.volume = 4.0 / 3.0 * std::numbers::pi * first * second * third;
  finding.shape = first / third;
  const Eigen::RowVectorXd by_volume =
      finding.volume * (gradient[0] / first + gradient[1] / second + gradient[2] / third);
  finding.volume95 = numeric::positive_interval95(finding.volume, standard_error(by_volume, covariance));
  const auto shape95 = [&](const auto& large, const auto& small) {
    const double shape = large.first / small.first;
    const Eigen::RowVectorXd by_shape = shape * (large.second / large.first - small.second / small.first);
    return numeric::positive_interval95(shape, standard_error(by_shape, covariance));
  };
  finding.shape95 = shape95(largest.front(), smallest.front());
  for (const auto& large : largest) {
    for (const auto& small : smallest) {
      finding.shape95.first = std::min(finding.shape95.first, shape95(large, small).first);
    }
  }
  finding.shape95.first = sphere ? 1.0 : std::max(finding.shape95.first, 1.0);
  return finding;
}

CirculationFinding circulation_finding(const Matrix& Z, const Matrix& covariance) {
  CirculationFinding finding;
  finding.vector = impedance::antisymmetric_vector(Z);
  finding.size = finding.vector.norm();
  const auto to_vector = impedance::antisymmetric_vector_gradient();
  const Matrix spread = to_vector * covariance * to_vector.transpose();
  for (Index k = 0; k < 3; ++k) {
    finding.vector95[static_cast<std::size_t>(k)] =
        numeric::interval95(finding.vector[k], standard_error(to_vector.row(k).eval(), covariance));
  }
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  finding.size95 = {kNaN, kNaN};
  if (spread.allFinite() && finding.size > 0.0) {
    const Vector a = finding.vector;
    finding.significant = a.dot(numeric::PivotedCholesky(spread).solve(a)) > kChiSquared3;
    const double along = std::sqrt(std::max(0.0, a.dot(spread * a))) / finding.size;
    const double widest = std::sqrt(std::max(0.0, numeric::symmetric_eigenvalues(spread).maxCoeff()));
    finding.size95 = {finding.significant ? std::max(0.0, finding.size - numeric::kNormal95 * along) : 0.0,
                      finding.size + numeric::kNormal95 * (finding.significant ? along : widest)};
  }
  const Vector values = numeric::symmetric_eigenvalues(impedance::symmetric_part(Z));
  finding.percent = values[0] > 0.0 ? 100.0 * finding.size / std::cbrt(values.prod()) : kNaN;
  return finding;
}

Result<Findings> analyse_ellipses(const Identification& identification) {
  if (identification.axes != 2) {
    return bad_data(identification.axes == 1 ? "a result with one axis has no ellipses"
                                             : "a result with three axes has ellipsoids, not ellipses",
                    "use a result with two axes");
  }
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

Result<SpatialFindings> analyse_ellipsoids(const Identification& identification) {
  if (identification.axes != 3)
    return bad_data("only a result with three axes has ellipsoids", "measure with --axes 3");
  const auto block = [&](Index part) { return Matrix(identification.covariance.block<9, 9>(9 * part, 9 * part)); };
  const impedance::Model& model = identification.model;
  SpatialFindings findings;
  findings.ellipsoids = {ellipsoid_finding(model.M, block(0)), ellipsoid_finding(model.B, block(1)),
                         ellipsoid_finding(model.K, block(2))};
  findings.antisymmetry = {circulation_finding(model.M, block(0)), circulation_finding(model.K, block(2))};
  return findings;
}

Result<void> add_ellipses(Measurement& measured) {
  const Identification& id = measured.identification;
  if (id.axes == 3) {
    measured.spatial = MBK_TRY(analyse_ellipsoids(id));
  } else {
    measured.findings = MBK_TRY(analyse_ellipses(id));
  }
  return {};
}

}  // namespace mbk::analyse
