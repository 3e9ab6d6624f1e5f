#include "mbk/measure/identify/fit_checks.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/base/core/significant.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/identify/reversed_force.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/trial/filtered_band.h"

namespace mbk::identify {
namespace {

/// Thresholds of the warnings, each with its reason.
constexpr double kLargestCondition = 100.0;  // what no model explains, 1 % of the force, weighs as much as a parameter
constexpr double kSmallestMotionRatio = 0.05;  // across the line of motion the limb moved a twentieth as far
constexpr double kVafDrop = 10.0;              // points between in-sample and held-out
constexpr double kPoorVaf = 70.0;              // relaxed arms give 92 % and more, ankles under tonic contraction 87
constexpr double kShortestDuration = 12.0;     // s; a dozen reaches of the residual's correlation
constexpr double kDecimationChange = 0.05;
/// Share of the force's variance that follows the perturbation and is no M, B, K: a response with a third of the
/// force's amplitude, and a part of it stands in M, B and K.
constexpr double kUnmodelled = 0.1;

/// Collects the warnings of one identification, subject by subject.
class Checker {
 public:
  explicit Checker(Identification& identification) : id_(identification) {}

  void check_excitation() {
    const Excitation& excitation = id_.excitation;
    const Index requested = 3 * axes() + 1;
    if (excitation.rank < requested) {
      warn(WarningCode::poorly_conditioned,
           fmt::format("position, velocity and acceleration cannot be distinguished (rank {} of {})", excitation.rank,
                       requested),
           "perturb at several frequencies and in both directions");
      id_.usable = false;
    } else if (excitation.condition > kLargestCondition) {
      warn(WarningCode::poorly_conditioned,
           fmt::format("the motion is too uniform to separate M, B and K (condition number {})",
                       significant(excitation.condition, 2)),
           "perturb at several frequencies and in both directions");
    }
    if (axes() == 2 && excitation.motion_ratio < kSmallestMotionRatio) {
      warn(WarningCode::motion_on_one_line,
           fmt::format("the hand moved along one line: perpendicular to it only {:.1f} % as far",
                       100.0 * excitation.motion_ratio),
           "perturb both axes independently, or measure one axis: --axes 1, with its columns in --channels");
    } else if (axes() == 3 && excitation.motion_ratio < kSmallestMotionRatio) {
      warn(WarningCode::motion_on_one_line,
           fmt::format("the hand moved in one plane or along one line: in one direction only {:.1f} % as far as in "
                       "another",
                       100.0 * excitation.motion_ratio),
           "perturb all three axes independently, or measure the plane of two axes: --axes 2");
    }
    if (excitation.duration < kShortestDuration) {
      warn(WarningCode::too_little_data,
           fmt::format("the parameters are estimated from only {:.1f} s of data, too few for reliable standard errors",
                       excitation.duration),
           fmt::format("record at least {:g} s, or pool several trials with --pool", kShortestDuration));
    }
  }

  /// Inertia and stiffness of a limb are positive; its damping too, unless it acts.
  void check_signs() {
    const Eigenvalues inertia = eigenvalues(id_.model.M, 0), damping = eigenvalues(id_.model.B, 1),
                      stiffness = eigenvalues(id_.model.K, 2);
    const bool damped = id_.structure != Structure::mass_spring;
    if (inertia.largest < 0.0 && stiffness.largest < 0.0 && (!damped || damping.largest < 0.0)) {
      const Warning reversed = reversed_force(static_cast<int>(axes()));
      warn(reversed.code, reversed.message, reversed.remedy);
      id_.usable = false;
      return;
    }
    if (!(inertia.smallest > 0.0)) {
      warn(WarningCode::inertia_not_positive,
           fmt::format("the inertia is {}, which is impossible for a limb", stated(inertia, units_.inertia)),
           "perturb at higher frequencies, for longer, or pool trials with --pool");
      id_.usable = false;
    }
    if (!(stiffness.smallest > 0.0)) {
      warn(WarningCode::stiffness_not_positive,
           fmt::format("the stiffness is {}, not positive", stated(stiffness, units_.stiffness)),
           "perturb at lower frequencies, for longer, or pool trials with --pool");
      id_.usable = false;
    }
    if (damped && !(damping.smallest > 0.0)) {
      warn(WarningCode::damping_not_positive,
           fmt::format("the damping is {}: the limb delivers energy, or force and position are not synchronised",
                       stated(damping, units_.damping)),
           "check with 'mbk passivity' whether the limb absorbed energy in the trial; if it did, synchronise "
           "force and position");
    }
  }

  void check_band() {
    // Of pooled trials, the one whose filter passes the smallest part of its band.
    const Preparation& how =
        *std::ranges::min_element(id_.preparations, [](const Preparation& a, const Preparation& b) {
          return passed_band(a) * b.band_high.value < passed_band(b) * a.band_high.value;
        });
    const double top = passed_band(how);
    const Eigenvalues inertia = eigenvalues(id_.model.M, 0);
    if (cuts_into_band(how)) {
      warn(WarningCode::band_too_narrow,
           fmt::format("the {:.3g} Hz filter cuts into the excited band, which reaches {:.3g} Hz; the rest may not "
                       "show the inertia",
                       top, how.band_high.value),
           "omit --cutoff or raise it (--mode reference uses its own filter)");
    } else if (inertia.smallest > 0.0 && inertia.smallest < numeric::kNormal95 * inertia.standard_error) {
      warn(WarningCode::band_too_narrow,
           fmt::format("in the band up to {:.3g} Hz the inertia is not significantly different from zero: {}", top,
                       stated(inertia, units_.inertia)),
           "perturb at higher frequencies");
    }
  }

  void check_fit() {
    const Fit& fit = id_.fit;
    const char* const what = axes() == 1 ? "reaction" : "force in one axis";
    if (!fit.held_out) {
      warn(WarningCode::no_held_out_data, "no data were held out, so the fit is evaluated on the data used for fitting",
           "record more, or set --split");
    } else if ((fit.vaf_in_sample - fit.vaf).maxCoeff() > kVafDrop) {
      warn(WarningCode::held_out_fit_poor,
           fmt::format(
               "the model explains {:.1f} % of the force in the fitted data, but only {:.1f} % in the held-out data",
               fit.vaf_in_sample.minCoeff(), fit.vaf.minCoeff()),
           "measure parts with --from and --to to see whether the limb changed during the recording, or record longer");
    }
    if (!fit.vaf.array().isFinite().all()) {
      warn(WarningCode::fit_poor, fmt::format("the {} is constant, so there is nothing to explain", what),
           "check the force sensor and its channel");
      id_.usable = false;
    } else if (const double least = std::min(fit.vaf.minCoeff(), fit.vaf_in_sample.minCoeff()); least < kPoorVaf) {
      warn(WarningCode::fit_poor,
           fmt::format("inertia, damping and stiffness explain {} the {}{}{}",
                       least < 0.0 ? std::string("none of") : fmt::format("only {:.1f} % of", least), what,
                       least < fit.vaf.minCoeff() ? " in the fitted data" : "",
                       least < 0.0 ? fmt::format(" (VAF {:.1f} %)", least) : std::string()),
           "look for voluntary activity or reflexes with 'mbk explore', and check with 'mbk passivity' whether the "
           "limb absorbed energy; do not interpret M, B and K as those of a passive limb");
      if (!(fit.vaf.minCoeff() > 0.0)) id_.usable = false;
    }
  }

  /// Pooled trials are of one limb in one condition.
  void check_conditions() {
    for (const auto& [name, part] : {std::pair{"participant", &TrialConditions::participant},
                                     {"condition", &TrialConditions::condition},
                                     {"posture", &TrialConditions::posture}}) {
      std::string first;
      for (const TrialConditions& one : id_.conditions) {
        const std::string& value = one.*part;
        if (first.empty()) first = value;
        if (value.empty() || value == first) continue;
        warn(WarningCode::mixed_conditions,
             fmt::format("the pooled recordings differ in {}: '{}' and '{}'; one model is fitted to all", name, first,
                         value),
             "pool only recordings of one participant, condition and posture");
        break;
      }
    }
  }

  /// Instruments are the motion caused by the reference. If the limb responds to each pulse after a delay, its response
  /// is caused by the reference, too, and is attributed to mechanics; the data cannot distinguish the two.
  void check_response() {
    const bool by_instruments = id_.method == Method::instrumental_variables;
    if (by_instruments && id_.instrument && !id_.instrument->strong()) {
      warn(WarningCode::weak_instruments,
           fmt::format("the reference explains too little of the motion: first-stage F is {:.3g}, but the intervals of "
                       "instrumental variables need more than {:g}",
                       id_.instrument->weakest(), kStrongInstruments),
           "perturb more or for longer, pool several trials with --pool, or use --method ls and read its warnings");
      id_.usable = false;
    }
    if (!id_.response || !(id_.response->largest() > kUnmodelled)) return;
    const double induced = largest_share(id_.response->induced);
    const bool pulses = induced > kUnmodelled;
    warn(WarningCode::unmodelled_response,
         fmt::format("{:.0f} % of the force follows the perturbation without being inertia, damping or stiffness: a "
                     "voluntary or reflex response of the limb, which biases M, B and K",
                     100.0 * id_.response->largest()),
         "ask the participant to give no response, or perturb less or less predictably; do not interpret M, B and K as "
         "those of a passive limb");
    if (!by_instruments || !pulses) return;
    warn(
        WarningCode::invalid_instruments,
        fmt::format(
            "the unexplained force is much larger during pulses than between them (excess variance {:.0f} % of that of "
            "the force): the limb responds to each pulse, and instrumental variables would count that response as M, B "
            "and K",
            100.0 * induced),
        "use --method ls and read its warnings, or perturb with a multisine");
    id_.usable = false;
  }

  /// Assumptions of the model that the data contradict.
  void check_assumptions() {
    for (const AssumptionTest& test : id_.assumptions) {
      if (!test.contradicted) continue;
      const double size = std::abs(test.size);
      switch (test.assumption) {
        case Assumption::simultaneous:
          warn(WarningCode::missing_dynamics,
               fmt::format(
                   "part of the force is not explained by inertia, damping and stiffness, as if it came {:.1f} ms too "
                   "{}: force and position are not synchronised, the grip yields, or the limb responds after a delay",
                   1e3 * size, test.size > 0.0 ? "late" : "early"),
               "measure the delay of the force sensor with a known mass ('mbk sensor delay') and correct it with "
               "--force-delay-ms; hold the handle more firmly; look for other dynamics with 'mbk explore'");
          break;
        case Assumption::linear_stiffness:
          warn(WarningCode::nonlinear_stiffness,
               fmt::format("the stiffness depends on the amplitude: at the amplitude of this motion the limb is {:.0f} "
                           "% {} than for small motion",
                           100.0 * size, test.size > 0.0 ? "stiffer" : "less stiff"),
               "perturb less, and report the amplitude with M, B and K; 'mbk explore' with trials of different phases "
               "shows the nonlinear part of the force");
          break;
        case Assumption::no_dry_friction:
          warn(WarningCode::dry_friction,
               fmt::format("{:.2g} {} of the force depend on the direction of motion but not on its speed: dry "
                           "friction, which biases damping and stiffness",
                           size, units_.force),
               "look for friction between limb and force sensor; perturb more or faster to reduce its share");
          break;
        case Assumption::constant_stiffness:
          warn(WarningCode::stiffness_changes,
               fmt::format("the stiffness changed during the recording by {:.0f} % (standard deviation), so M, B and K "
                           "are averages",
                           100.0 * size),
               "look at the change over time with 'mbk explore'; measure parts with --from and --to, and ask the "
               "participant to keep the same state");
          break;
        case Assumption::constant_damping:
          warn(WarningCode::damping_changes,
               fmt::format("the damping changed during the recording by {:.0f} % (standard deviation), so M, B and K "
                           "are averages",
                           100.0 * size),
               "look at the change over time with 'mbk explore'; measure parts with --from and --to, and ask the "
               "participant to keep the same state");
          break;
        case Assumption::no_memory:
          warn(WarningCode::memory,
               fmt::format("{:.0f} % of the force (root mean square) lags the position by 0.1 s to 1.5 s: the limb "
                           "relaxes or follows the motion slowly, so K depends on how fast it is moved",
                           100.0 * size),
               "interpret K as the stiffness at the perturbed frequencies, not as a static stiffness; ask the "
               "participant to give no response; 'mbk explore' shows the frequency response");
          break;
        case Assumption::alike_both_ways:
          warn(WarningCode::even_nonlinearity,
               fmt::format("{:.0f} % of the force (root mean square) is the same for opposite motions: stiffness, "
                           "damping or a reflex is stronger in one direction, and x0 is biased",
                           100.0 * size),
               "perturb less, and interpret M, B and K as averages of both directions; 'mbk explore' with trials of "
               "different phases shows the nonlinear part of the force");
          break;
        case Assumption::fits_at_lines:
          break;  // tested elsewhere, on the periods of the recording
        case Assumption::constant_rest:
          warn(WarningCode::force_drifts,
               fmt::format("the force drifts by {:.2g} {} from beginning to end: the equilibrium or the zero of the "
                           "force sensor shifted, so x0 is an average",
                           size, units_.force),
               "zero the force sensor before each trial; measure a shorter part with --from and --to");
          break;
        case Assumption::no_tremor:
          break;  // tested elsewhere, on the spectrum of the force
      }
    }
  }

  void check_decimation() {
    if (!id_.decimation || !(id_.decimation->largest_change > kDecimationChange)) return;
    warn(WarningCode::decimation_changes_model,
         fmt::format("at {:g} Hz the model differs by {:.1f} %", id_.decimation->rate_hz,
                     100.0 * id_.decimation->largest_change),
         fmt::format("remove signal content above {:g} Hz: omit --sg-window or raise it, or lower --cutoff",
                     0.5 * id_.decimation->rate_hz));
  }

 private:
  /// Of a symmetric part, with the standard error of the smallest by the delta method, dλ = vᵀ dZ v.
  struct Eigenvalues {
    double smallest, largest, standard_error;
  };

  [[nodiscard]] Index axes() const { return id_.axes; }

  void warn(WarningCode code, std::string message, std::string remedy) {
    id_.warnings.push_back({code, std::move(message), std::move(remedy)});
  }

  /// @param part 0, 1, 2 for M, B, K: position of the matrix in the covariance
  [[nodiscard]] Eigenvalues eigenvalues(const Matrix& Z, Index part) const {
    const Index n = axes();
    const auto [values, vectors] = numeric::symmetric_eigen(impedance::symmetric_part(Z));
    const Vector v = vectors.col(0);
    const Vector gradient = (v * v.transpose()).reshaped();
    const double variance = gradient.dot(id_.covariance.block(part * n * n, part * n * n, n * n, n * n) * gradient);
    return {values[0], values[n - 1], std::sqrt(std::max(0.0, variance))};
  }

  [[nodiscard]] std::string stated(const Eigenvalues& value, const char* unit) const {
    return fmt::format("{:.3g} ± {:.2g} {}{}", value.smallest, numeric::kNormal95 * value.standard_error, unit,
                       axes() == 1 ? "" : " in its weakest direction");
  }

  Identification& id_;
  Units units_ = units_of(id_.motion);
};

}  // namespace

Spread spread_of(const numeric::MatrixPart& Z, const numeric::MatrixPart& Y) {
  const auto motion = Z.leftCols(Z.cols() - 1);
  const Matrix centred = motion.rowwise() - motion.colwise().mean();
  Spread spread{numeric::gram_of({centred}) / static_cast<double>(std::max<Index>(Z.rows() - 1, 1)), Vector(Y.cols())};
  for (Index j = 0; j < Y.cols(); ++j) spread.force[j] = numeric::variance(Y.col(j));
  return spread;
}

Excitation measure_excitation(const Spread& spread, const impedance::Model& model, int rank) {
  const Index n = model.axes();
  const Matrix& cov = spread.motion;
  Excitation result;
  result.rank = rank;

  const Vector motion = numeric::symmetric_eigen(cov.block(2 * n, 2 * n, n, n)).values;
  result.motion = std::sqrt(std::max(0.0, motion[n - 1]));
  result.motion_ratio = result.motion > 0.0 ? std::sqrt(std::max(0.0, motion[0])) / result.motion : 0.0;

  Vector scale = cov.diagonal().cwiseSqrt();
  scale = (scale.array() > 0.0).select(scale.cwiseInverse(), 0.0);
  const Vector all = numeric::symmetric_eigen(scale.asDiagonal() * cov * scale.asDiagonal()).values;
  const double smallest = all[0], largest = all[3 * n - 1];
  result.condition = smallest > 0.0 ? std::sqrt(largest / smallest) : std::numeric_limits<double>::infinity();

  // Variance of ẍ not explained by velocity and position: the Schur complement of their covariance.
  const numeric::CompleteOrthogonal others(cov.bottomRightCorner(2 * n, 2 * n));
  const Matrix own =
      cov.topLeftCorner(n, n) - cov.topRightCorner(n, 2 * n) * others.solve(cov.bottomLeftCorner(2 * n, n));
  result.inertia_share = std::numeric_limits<double>::infinity();
  for (Index j = 0; j < n; ++j) {
    const double force = spread.force[j];
    const double inertial = model.M.row(j) * own * model.M.row(j).transpose();
    result.inertia_share = std::min(result.inertia_share, force > 0.0 ? std::max(0.0, inertial) / force : 0.0);
  }
  return result;
}

void add_warnings(Identification& identification) {
  Checker checker(identification);
  checker.check_excitation();
  if (identification.excitation.rank == 3 * identification.axes + 1) {  // otherwise there is no model
    checker.check_signs();
    checker.check_band();
  }
  checker.check_fit();
  checker.check_response();
  checker.check_assumptions();
  checker.check_conditions();
  checker.check_decimation();
}

void warn_of_closed_loop(const Identification& instrumental, const Disagreement& disagreement,
                         Identification& least_squares) {
  if (!instrumental.usable || !disagreement.significant) return;
  const char* const unit = unit_of_parameter(disagreement.parameter, least_squares.motion);
  least_squares.warnings.push_back(
      {WarningCode::closed_loop_bias,
       fmt::format("least squares is biased towards the negative robot impedance: {} is {:.3g} {}, but {:.3g} ± {:.2g} "
                   "{} more with instrumental variables",
                   disagreement.parameter, disagreement.least_squares, unit, disagreement.difference,
                   numeric::kNormal95 * disagreement.standard_error, unit),
       "use --method iv"});
}

}  // namespace mbk::identify
