#include "mbk/identify/checks.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/impedance/ellipse.h"
#include "mbk/numeric/statistics.h"

namespace mbk::identify {
namespace {

/// Thresholds of the warnings, each with its reason.
constexpr double kLargestCondition = 1e3;      // two digits of a 16-bit sensor are left
constexpr double kSmallestMotionRatio = 0.05;  // across the line of motion the limb moved a twentieth as far
constexpr double kVafDrop = 10.0;              // points between in-sample and held-back
constexpr double kPoorVaf = 70.0;              // relaxed arms give 92 % and more, ankles under tonic contraction 87
constexpr double kShortestDuration = 12.0;     // s; a dozen reaches of the residual's correlation
constexpr double kCutIntoBand = 0.5;           // a filter below half of the excited band hides the inertia
constexpr double kDecimationChange = 0.05;

/// Smallest eigenvalue of a symmetric part, and its standard error by the delta method, dλ = vᵀ dZ v.
struct SmallestEigenvalue {
  double value, standard_error;
};

SmallestEigenvalue smallest_eigenvalue(const Matrix& Z, const Matrix& covariance) {
  const Index n = Z.rows();
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(impedance::symmetric_part(Z));
  const Vector v = solver.eigenvectors().col(0);
  Vector gradient(n * n);
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) gradient[j * n + i] = v[j] * v[i];
  }
  return {solver.eigenvalues()[0], std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)))};
}

}  // namespace

Excitation measure_excitation(const Matrix& Z, const Matrix& Y, const impedance::Model& model, int rank) {
  const Index n = model.axes();
  Excitation result;
  result.rank = rank;
  const Matrix centred = Z.leftCols(3 * n).rowwise() - Z.leftCols(3 * n).colwise().mean();
  const Matrix cov = centred.transpose() * centred / static_cast<double>(std::max<Index>(Z.rows() - 1, 1));

  const Eigen::SelfAdjointEigenSolver<Matrix> motion(cov.block(2 * n, 2 * n, n, n));
  result.motion = std::sqrt(std::max(0.0, motion.eigenvalues()[n - 1]));
  result.motion_ratio = result.motion > 0.0 ? std::sqrt(std::max(0.0, motion.eigenvalues()[0])) / result.motion : 0.0;

  Vector scale = cov.diagonal().cwiseSqrt();
  scale = (scale.array() > 0.0).select(scale.cwiseInverse(), 0.0);
  const Eigen::SelfAdjointEigenSolver<Matrix> all(scale.asDiagonal() * cov * scale.asDiagonal());
  const double smallest = all.eigenvalues()[0], largest = all.eigenvalues()[3 * n - 1];
  result.condition = smallest > 0.0 ? std::sqrt(largest / smallest) : std::numeric_limits<double>::infinity();

  // What of ẍ velocity and position cannot imitate: the Schur complement of their covariance.
  const Eigen::CompleteOrthogonalDecomposition<Matrix> others(cov.bottomRightCorner(2 * n, 2 * n));
  const Matrix own =
      cov.topLeftCorner(n, n) - cov.topRightCorner(n, 2 * n) * others.solve(Matrix(cov.bottomLeftCorner(2 * n, n)));
  result.inertia_share = std::numeric_limits<double>::infinity();
  for (Index j = 0; j < n; ++j) {
    const double force = numeric::variance(Y.col(j));
    const double inertial = model.M.row(j) * own * model.M.row(j).transpose();
    result.inertia_share = std::min(result.inertia_share, force > 0.0 ? std::max(0.0, inertial) / force : 0.0);
  }
  return result;
}

void add_warnings(Identification& identification) {
  const Index n = identification.axes;
  const impedance::Model& model = identification.model;
  const Excitation& excitation = identification.excitation;
  const Units units = units_of(identification.motion);
  const bool one_axis = n == 1;
  const auto warn = [&](WarningCode code, std::string message, std::string remedy) {
    identification.warnings.push_back({code, std::move(message), std::move(remedy)});
  };

  if (excitation.rank < 3 * n + 1) {
    warn(WarningCode::poorly_conditioned,
         fmt::format("position, velocity and acceleration cannot be told apart (rank {} of {})", excitation.rank,
                     3 * n + 1),
         "perturb at several frequencies and in both directions");
    identification.usable = false;
  } else if (excitation.condition > kLargestCondition) {
    warn(WarningCode::poorly_conditioned,
         fmt::format("the regressors are nearly dependent (condition {:.2g})", excitation.condition),
         "perturb at several frequencies and in both directions");
  }
  if (n == 2 && excitation.motion_ratio < kSmallestMotionRatio) {
    warn(WarningCode::motion_on_one_line,
         fmt::format("the hand moved along one line: across it only {:.1f} % as far", 100.0 * excitation.motion_ratio),
         "perturb both axes independently, or measure the one axis with --axes 1");
  }

  const auto block = [&](Index part) {
    return identification.covariance.block(part * n * n, part * n * n, n * n, n * n);
  };
  const SmallestEigenvalue inertia = smallest_eigenvalue(model.M, block(0));
  const SmallestEigenvalue stiffness = smallest_eigenvalue(model.K, block(2));
  const SmallestEigenvalue damping = smallest_eigenvalue(model.B, block(1));
  const auto stated = [&](const SmallestEigenvalue& value, const char* unit) {
    return fmt::format("{:.3g} ± {:.2g} {}{}", value.value, numeric::kNormal95 * value.standard_error, unit,
                       one_axis ? "" : " in its weakest direction");
  };
  if (!(inertia.value > 0.0)) {
    warn(WarningCode::inertia_not_positive,
         fmt::format("the inertia is {}: no limb has that", stated(inertia, units.inertia)),
         "raise the filter's --cutoff so that the inertia can be seen, and perturb at higher frequencies");
    identification.usable = false;
  }
  if (!(stiffness.value > 0.0)) {
    warn(WarningCode::stiffness_not_positive, fmt::format("the stiffness is {}", stated(stiffness, units.stiffness)),
         "perturb at lower frequencies and for longer; check the sign of the force (what the limb exerts on the "
         "machine)");
    identification.usable = false;
  }
  if (identification.structure != Structure::mass_spring && !(damping.value > 0.0)) {
    warn(WarningCode::damping_not_positive,
         fmt::format("the damping is {}: the limb feeds in energy, or force and position are not simultaneous",
                     stated(damping, units.damping)),
         "check for delays between the channels; a voluntary or reflex response also does this");
  }
  // Of pooled trials, the one whose filter leaves least of its band.
  const auto passed = [](const Preparation& how) {
    return how.cutoff ? std::min(how.band_high, *how.cutoff).value : how.band_high.value;
  };
  const Preparation& how = *std::min_element(identification.preparations.begin(), identification.preparations.end(),
                                             [&](const Preparation& a, const Preparation& b) {
                                               return passed(a) * b.band_high.value < passed(b) * a.band_high.value;
                                             });
  const double top = passed(how);
  if (top < kCutIntoBand * how.band_high.value) {
    warn(WarningCode::band_too_narrow,
         fmt::format("the {:.3g} Hz filter cuts into the excited band, which reaches {:.3g} Hz; what is left may not "
                     "show the inertia",
                     top, how.band_high.value),
         "leave --cutoff to the default, or raise it");
  } else if (inertia.value > 0.0 && inertia.value < numeric::kNormal95 * inertia.standard_error) {
    warn(WarningCode::band_too_narrow,
         fmt::format("in the band up to {:.3g} Hz the inertia cannot be told from zero: {}", top,
                     stated(inertia, units.inertia)),
         "perturb at higher frequencies");
  }

  const Fit& fit = identification.fit;
  if (!fit.held_back) {
    warn(WarningCode::no_held_back_data, "no data were held back, so the fit is judged on the data that made it",
         "record more, or set --split");
  } else if ((fit.vaf_in_sample - fit.vaf).maxCoeff() > kVafDrop) {
    warn(WarningCode::held_back_fit_poor,
         fmt::format("the model explains {:.1f} % of the force that made it, and only {:.1f} % of the force held back",
                     fit.vaf_in_sample.minCoeff(), fit.vaf.minCoeff()),
         "the limb changed during the recording, or there is too little data: look at the parts with --from and --to");
  }
  // Written so that NaN, the VAF of a force that never changes, is poor.
  if (!(fit.vaf.array() >= kPoorVaf).all()) {
    const bool defined = fit.vaf.array().isFinite().all();
    warn(WarningCode::fit_poor,
         defined ? fmt::format("inertia, damping and stiffness explain only {:.1f} % of the {}", fit.vaf.minCoeff(),
                               one_axis ? "reaction" : "force in one axis")
                 : fmt::format("the {} never changes, so that nothing of it can be explained",
                               one_axis ? "reaction" : "force in one axis"),
         defined ? "the limb may have acted or reflexes may be strong; do not read M, B and K as a passive limb's"
                 : "check the force sensor and its channel");
    if (!(fit.vaf.array() > 0.0).all()) identification.usable = false;
  }
  if (excitation.duration < kShortestDuration) {
    warn(WarningCode::too_little_data,
         fmt::format("{:.1f} s of data stand behind the parameters, too few for the standard errors to be trusted",
                     excitation.duration),
         fmt::format("record at least {:g} s, or pool several trials with --pool", kShortestDuration));
  }
  if (identification.decimation && identification.decimation->largest_change > kDecimationChange) {
    warn(WarningCode::decimation_changes_model,
         fmt::format("at {:g} Hz the model differs by {:.1f} %", identification.decimation->rate_hz,
                     100.0 * identification.decimation->largest_change),
         "the signals hold something above 50 Hz; lower --cutoff");
  }
}

}  // namespace mbk::identify
