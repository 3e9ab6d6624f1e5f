#include "mbk/measure/identify/robot_fit.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/significant.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/instrumental_variables.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/identify/base_parameters.h"
#include "mbk/measure/identify/regression.h"
#include "mbk/measure/identify/robot_consistency.h"
#include "mbk/measure/identify/stacked_dynamics.h"

namespace mbk::identify {
namespace {

/// The rows that judge: recordings that are there for it, or else what was held out of the others.
StackedDynamics judging_rows(const std::vector<PreparedDynamics>& trials,
                             const std::vector<PreparedDynamics>& held_out) {
  return held_out.empty() ? stack_rows(trials, Purpose::validation) : stack_rows(held_out, std::nullopt);
}

/// All joints under each other, each divided by its σ; the columns that are kept and, where wanted, τ̇.
Matrix stacked(const std::vector<Matrix>& of_joint, const std::vector<Index>& kept, const Matrix* torque_rate,
               const Vector& sigma) {
  const Index rows = of_joint.front().rows(), p = static_cast<Index>(kept.size());
  Matrix all(rows * sigma.size(), p + (torque_rate != nullptr ? 1 : 0));
  for (Index joint = 0; joint < sigma.size(); ++joint) {
    auto block = all.middleRows(joint * rows, rows);
    block.leftCols(p) = of_joint[static_cast<std::size_t>(joint)](Eigen::all, kept) / sigma[joint];
    if (torque_rate != nullptr) block.col(p) = torque_rate->col(joint) / sigma[joint];
  }
  return all;
}

/// "0.25·link_2.mass + …": contribution of the dropped columns to a kept one.
std::string holds(const numeric::IndependentColumns& columns, Index row, const std::vector<robot::Coefficient>& names) {
  constexpr double kNothing = 1e-9;
  std::string text;
  for (Index j = 0; j < columns.combination.cols(); ++j) {
    const double share = columns.combination(row, j);
    if (j == columns.kept[static_cast<std::size_t>(row)] || !(std::abs(share) > kNothing)) continue;
    text += fmt::format("{} {:.4g}·{}", share < 0.0 ? " −" : (text.empty() ? "+" : " +"), std::abs(share),
                        names[static_cast<std::size_t>(j)].name);
  }
  return text;
}

class RobotFitter {
 public:
  RobotFitter(const std::vector<PreparedDynamics>& trials, const std::vector<PreparedDynamics>& held_out,
              const robot::DynamicModel& model, const RobotFitOptions& options)
      : trials_(trials), held_out_(held_out), model_(model), options_(options) {}

  Result<RobotFit> fit();

 private:
  Result<void> prepare();
  void take_columns(const std::vector<Index>& free);
  Result<void> solve();
  void take_covariance();
  void judge(RobotIdentification& found) const;
  void describe(RobotIdentification& found) const;
  void check_inertia(RobotIdentification& found) const;
  [[nodiscard]] FreeFit free_fit() const;
  Result<void> make_consistent(RobotIdentification& found);
  [[nodiscard]] bool is_fixed(Index k) const { return std::ranges::find(options_.fixed, k) != options_.fixed.end(); }
  [[nodiscard]] bool by_instruments() const { return options_.method == RobotMethod::instrumental_variables; }
  /// Residuals of the rows, N×n.
  [[nodiscard]] Matrix residuals(const StackedDynamics& rows) const {
    Matrix e(rows.rows(), rows.torque.cols());
    for (Index joint = 0; joint < e.cols(); ++joint) {
      e.col(joint) = rows.torque.col(joint) - rows.W[static_cast<std::size_t>(joint)] * theta_ -
                     delay_correction_ * rows.torque_rate.col(joint);
    }
    return e;
  }

  const std::vector<PreparedDynamics>& trials_;
  const std::vector<PreparedDynamics>& held_out_;
  const robot::DynamicModel& model_;
  const RobotFitOptions& options_;
  StackedDynamics rows_;
  Index n_ = 0, p_ = 0, lags_ = 0;
  int structural_rank_ = 0;
  Vector sigma_, theta_;
  Matrix bread_, covariance_;  ///< of the columns that are kept, and of the delay's where it is estimated
  Matrix residuals_;
  double delay_correction_ = 0;
  double loss_by_chance_ = 0;                   ///< that the true robot stays below, by the free fit's covariance
  Vector fixed_;                                ///< p, the values that are known, 0 elsewhere
  std::vector<robot::Coefficient> free_names_;  ///< of those that are not
  numeric::IndependentColumns columns_;         ///< of those that are not
  std::vector<Index> kept_;                     ///< coefficients that are found
};

Result<void> RobotFitter::prepare() {
  if (trials_.empty()) return bad_data("no recording was given");
  const PreparedDynamics& first = trials_.front();
  n_ = first.torque.cols();
  p_ = first.regressors.front().cols();
  for (const Index k : options_.fixed) {
    if (k < 0 || k >= p_ || model_.parameters.size() != p_ || !std::isfinite(model_.parameters[k])) {
      return bad_usage("a fixed coefficient has no value", "state it in the robot's description");
    }
  }
  if (p_ == 0) return bad_usage("the robot has no coefficients to identify");
  for (const auto* list : {&trials_, &held_out_}) {
    for (const PreparedDynamics& trial : *list) {
      if (trial.torque.cols() != n_ || trial.regressors.front().cols() != p_) {
        return bad_data("the recordings are of different robots", "identify each robot separately");
      }
      constexpr double kSameClock = 1e-3;
      if (list == &trials_ && std::abs(trial.sample_time / first.sample_time - 1.0) > kSameClock) {
        return bad_data(fmt::format("the rows are {:.4g} s apart in one recording and {:.4g} s in another",
                                    first.sample_time, trial.sample_time),
                        "use the same --every and --cutoff for all, or resample to one rate with --resample");
      }
    }
  }
  if (!(options_.hac_lag_s >= 0.0 && std::isfinite(options_.hac_lag_s))) {
    return bad_usage(fmt::format("the noise correlation time of {:g} s is not 0 or more", options_.hac_lag_s));
  }
  rows_ = stack_rows(trials_, held_out_.empty() ? std::optional(Purpose::identification) : std::nullopt);
  if (rows_.rows() * n_ < 3 * p_) {
    return bad_data(fmt::format("{} rows cannot determine {} coefficients", rows_.rows(), p_), "record longer");
  }
  lags_ = static_cast<Index>(std::llround(options_.hac_lag_s / first.sample_time));
  sigma_ = Vector::Ones(n_);
  fixed_ = Vector::Zero(p_);
  std::vector<Index> all;
  for (Index k = 0; k < p_; ++k) {
    if (is_fixed(k)) {
      fixed_[k] = model_.parameters[k];
    } else {
      all.push_back(k);
    }
  }
  free_names_.clear();
  const std::vector<robot::Coefficient> names = model_.coefficients();
  for (const Index k : all) free_names_.push_back(names[static_cast<std::size_t>(k)]);
  take_columns(all);
  if (kept_.empty()) {
    return bad_data("no joint moved, so the dynamics of the robot were not excited", "move every joint");
  }
  return {};
}

/// Of the `free` coefficients those that the data identify, each one that any motion could.
void RobotFitter::take_columns(const std::vector<Index>& free) {
  constexpr double kApart = 1e-6, kNegligible = 1e-9;
  const numeric::IndependentColumns base = structural_columns(model_, options_.fixed);
  structural_rank_ = static_cast<int>(base.kept.size());
  std::vector<Index> candidates;
  for (const Index k : base.kept) candidates.push_back(free[static_cast<std::size_t>(k)]);
  const numeric::IndependentColumns excited =
      numeric::independent_columns(stacked(rows_.W, candidates, nullptr, sigma_), kApart, kNegligible);
  columns_ = {{}, excited.combination * base.combination};
  kept_.clear();
  for (const Index k : excited.kept) {
    columns_.kept.push_back(base.kept[static_cast<std::size_t>(k)]);
    kept_.push_back(candidates[static_cast<std::size_t>(k)]);
  }
}

Result<void> RobotFitter::solve() {
  const Matrix* rate = options_.delay ? &rows_.torque_rate : nullptr;
  const int passes = options_.method == RobotMethod::least_squares ? 1 : 6;
  for (int pass = 0; pass < passes; ++pass) {
    const Matrix Z = stacked(rows_.W, kept_, rate, sigma_);
    Matrix Y(Z.rows(), 1);
    for (Index joint = 0; joint < n_; ++joint) {
      Y.block(joint * rows_.rows(), 0, rows_.rows(), 1) =
          (rows_.torque.col(joint) - rows_.W[static_cast<std::size_t>(joint)] * fixed_) / sigma_[joint];
    }
    Vector free;
    if (by_instruments()) {
      auto fit = MBK_TRY(numeric::fit_instrumental_variables(Z, stacked(rows_.R, kept_, rate, sigma_), Y));
      if (fit.rank < Z.cols()) {
        return bad_data("the instruments do not identify the coefficients",
                        "use --method wls, or another --motion-cutoff");
      }
      free = fit.free;
      bread_ = fit.inverse;
    } else {
      auto fit = MBK_TRY(numeric::fit_least_squares(Z, Y));
      free = fit.free;
      bread_ = fit.inverse_gram;
    }
    theta_ = fixed_;
    for (std::size_t k = 0; k < kept_.size(); ++k) theta_[kept_[k]] = free[static_cast<Index>(k)];
    delay_correction_ = options_.delay ? free[free.size() - 1] : 0.0;
    residuals_ = residuals(rows_);
    if (pass + 1 == passes) break;
    const Vector spread = residuals_.colwise().norm() / std::sqrt(static_cast<double>(rows_.rows()));
    // A joint that the model explains to rounding must not drown the others.
    const double least = 1e-9 * rows_.torque.cwiseAbs().maxCoeff();
    const Vector next = spread.cwiseMax(std::max(least, 1e-6 * spread.maxCoeff()));
    if (!(next.minCoeff() > 0.0)) break;
    const bool settled = ((next - sigma_).cwiseAbs().array() < 1e-4 * next.array()).all();
    sigma_ = next;
    if (settled && pass > 0) break;
  }
  return {};
}

void RobotFitter::take_covariance() {
  const Matrix* rate = options_.delay ? &rows_.torque_rate : nullptr;
  const Index k = bread_.rows();
  const std::vector<Matrix>& of_scores = by_instruments() ? rows_.R : rows_.W;
  const Matrix omega = numeric::long_run_covariance(k, rows_.ranges, lags_, [&](const RowRange& range) {
    Matrix scores = Matrix::Zero(range.size(), k);
    for (Index joint = 0; joint < n_; ++joint) {
      const Vector e = residuals_.col(joint).segment(range.begin, range.size()) / (sigma_[joint] * sigma_[joint]);
      const Matrix& W = of_scores[static_cast<std::size_t>(joint)];
      for (std::size_t c = 0; c < kept_.size(); ++c) {
        scores.col(static_cast<Index>(c)) += W.col(kept_[c]).segment(range.begin, range.size()).cwiseProduct(e);
      }
      if (rate != nullptr) {
        scores.col(k - 1) += rate->col(joint).segment(range.begin, range.size()).cwiseProduct(e);
      }
    }
    return scores;
  });
  const double widening =
      numeric::newey_west_widening(std::min(1.0, static_cast<double>(lags_) / static_cast<double>(rows_.rows())));
  covariance_ = widening * widening * (bread_ * omega * bread_.transpose());
}

void RobotFitter::judge(RobotIdentification& found) const {
  const StackedDynamics other = judging_rows(trials_, held_out_);
  found.held_out = other.rows() > 0;
  const StackedDynamics& judged = found.held_out ? other : rows_;
  const Matrix e = residuals(judged);
  for (Index joint = 0; joint < n_; ++joint) {
    TorqueFit fit;
    fit.vaf = numeric::variance_accounted_for(judged.torque.col(joint), e.col(joint));
    fit.rmse = numeric::root_mean_square(e.col(joint));
    fit.vaf_in_sample = numeric::variance_accounted_for(rows_.torque.col(joint), residuals_.col(joint));
    fit.rmse_in_sample = numeric::root_mean_square(residuals_.col(joint));
    if (!judged.S.empty()) {
      const Vector left = judged.torque.col(joint) - judged.S[static_cast<std::size_t>(joint)] * theta_;
      fit.vaf_smoothed = numeric::variance_accounted_for(judged.torque.col(joint), left);
    }
    found.fit.push_back(fit);
  }
}

void RobotFitter::describe(RobotIdentification& found) const {
  const std::vector<robot::Coefficient> names = model_.coefficients();
  found.coefficients.clear();
  for (Index k = 0; k < p_; ++k) {
    found.coefficients.push_back({names[static_cast<std::size_t>(k)], theta_[k], kNaN, false, is_fixed(k), ""});
  }
  found.model.covariance = Matrix::Zero(p_, p_);
  const auto kept = static_cast<Index>(kept_.size());
  for (Index k = 0; k < kept; ++k) {
    const Index at = kept_[static_cast<std::size_t>(k)];
    RobotCoefficient& one = found.coefficients[static_cast<std::size_t>(at)];
    const std::string together_with = holds(columns_, k, free_names_);
    if (found.consistent && !together_with.empty()) continue;  // its value is its own, and one of many
    one.standard_error = std::sqrt(std::max(0.0, covariance_(k, k)));
    one.identified = true;
    one.together_with = together_with;
  }
  found.model.covariance(kept_, kept_) = covariance_.topLeftCorner(kept, kept);
  found.rank = static_cast<int>(kept);
  found.structural_rank = structural_rank_;

  const Matrix Z = stacked(rows_.W, kept_, nullptr, sigma_);
  const Vector length = Z.colwise().norm();
  const Matrix scaled = Z * length.cwiseInverse().asDiagonal();
  const auto [eigenvalues, eigenvectors] = numeric::symmetric_eigen(scaled.transpose() * scaled);
  found.condition = std::sqrt(eigenvalues[kept - 1] / std::max(eigenvalues[0], 1e-300));
  for (Index k = 0; k < kept; ++k) {
    constexpr double kShare = 0.3;
    const double share = eigenvectors(k, 0);
    if (std::abs(share) >= kShare) {
      found.weakest.emplace_back(names[static_cast<std::size_t>(kept_[static_cast<std::size_t>(k)])].name, share);
    }
  }
}

void RobotFitter::check_inertia(RobotIdentification& found) const {
  constexpr int kPostures = 15;
  const robot::Mechanism& mechanism = *model_.mechanism;
  const Vector phi = theta_.head(static_cast<Index>(mechanism.coefficients().size()));
  std::vector<double> motors(static_cast<std::size_t>(n_), 0.0);
  if (model_.drive.motor_inertia) {
    for (Index joint = 0; joint < n_; ++joint) {
      motors[static_cast<std::size_t>(joint)] = theta_[phi.size() + joint * model_.drive.per_joint()];
    }
  }
  found.inertia.smallest = std::numeric_limits<double>::infinity();
  const int per_joint = n_ <= 2 ? kPostures : (n_ <= 4 ? 5 : 3);
  const std::vector<robot::JointVector> postures = mechanism.postures(per_joint);
  const auto inertia_at = [&](const robot::JointVector& q) {
    robot::JointMatrix I = mechanism.terms(q, robot::JointVector::Zero(n_), phi).inertia;
    for (Index joint = 0; joint < n_; ++joint) I(joint, joint) += motors[static_cast<std::size_t>(joint)];
    return Matrix(0.5 * (I + I.transpose()));
  };
  for (const robot::JointVector& q : postures) {
    const double smallest = numeric::symmetric_eigenvalues(inertia_at(q))[0];
    if (smallest >= found.inertia.smallest) continue;
    found.inertia.smallest = smallest;
    found.inertia.where.assign(q.data(), q.data() + q.size());
  }
  // What the hand feels distinguishes units.
  for (const robot::JointVector& q : postures) {
    const auto back = robot::hand_from_joints(mechanism, q);
    if (!back) continue;
    const Matrix at_hand = Matrix(*back) * inertia_at(q) * Matrix(*back).transpose();
    const double mass = at_hand.diagonal().minCoeff();
    if (!(found.inertia.mass_at_hand <= mass)) found.inertia.mass_at_hand = mass;
  }
}

/// What a robot that can exist explains less than the free one.
void compare(const std::vector<TorqueFit>& fit, std::vector<TorqueFit> of_free, ConsistentRobot& consistent) {
  int counted = 0;
  for (std::size_t joint = 0; joint < fit.size(); ++joint) {
    consistent.vaf_lost.push_back(of_free[joint].vaf - fit[joint].vaf);
    consistent.vaf_lost_in_sample.push_back(of_free[joint].vaf_in_sample - fit[joint].vaf_in_sample);
    if (!std::isfinite(consistent.vaf_lost.back())) continue;
    consistent.mean_vaf_lost += consistent.vaf_lost.back();
    ++counted;
  }
  consistent.mean_vaf_lost /= std::max(counted, 1);
  consistent.free_fit = std::move(of_free);
}

/// What the consistent fit begins with.
FreeFit RobotFitter::free_fit() const {
  FreeFit free{model_, options_.fixed, columns_, Vector(static_cast<Index>(kept_.size())), {}, Vector::Ones(p_)};
  if (free.model.parameters.size() != p_) free.model.parameters = Vector::Zero(p_);
  for (std::size_t k = 0; k < kept_.size(); ++k) free.base[static_cast<Index>(k)] = theta_[kept_[k]];
  const Vector of_torque = rows_.torque.colwise().norm().transpose().cwiseQuotient(sigma_);
  const Vector of_residual = residuals_.colwise().norm().transpose().cwiseQuotient(sigma_);
  // What is explained to rounding is known to a billionth of itself.
  const double unit =
      std::max(of_residual.norm(), 1e-9 * of_torque.norm()) / std::sqrt(static_cast<double>(rows_.rows() * n_));
  free.triangle =
      numeric::householder_triangle(stacked(by_instruments() ? rows_.R : rows_.W, kept_, nullptr, sigma_)) / unit;
  for (Index k = 0; k < p_; ++k) {
    double square = 0.0;
    for (Index joint = 0; joint < n_; ++joint) {
      square += rows_.W[static_cast<std::size_t>(joint)].col(k).squaredNorm() / (sigma_[joint] * sigma_[joint]);
    }
    if (square > 0.0) free.typical[k] = of_torque.norm() / std::sqrt(square);
  }
  return free;
}

/// Puts a robot that can exist in the place of the free one, and remembers what that was.
Result<void> RobotFitter::make_consistent(RobotIdentification& found) {
  const FreeFit free = free_fit();
  const auto nearest = MBK_TRY(nearest_robot(free));
  theta_ = nearest.parameters;
  residuals_ = residuals(rows_);
  ConsistentRobot made;
  std::vector<std::pair<double, std::string>> pressing;
  for (std::size_t k = 0; k < nearest.conditions.size(); ++k) {
    const robot::PhysicalCondition& condition = nearest.conditions[k];
    // Half a standard deviation of the residual, squared and halved: what one coefficient gains by chance.
    constexpr double kPresses = 0.125;
    const double pressure = nearest.solution.pressure[k];
    if (pressure > kPresses) pressing.emplace_back(-pressure, condition.name);
    if (!condition.pseudo_inertia) continue;
    const Eigen::Matrix4d J = nearest.solution.matrices[k];
    made.bodies.push_back({condition.name, robot::body_of(J), numeric::symmetric_eigenvalues(J)[0]});
  }
  std::ranges::sort(pressing);
  for (auto& [pressure, name] : pressing) made.pressing.push_back(std::move(name));
  Vector of_free(static_cast<Index>(free_names_.size()));
  for (Index k = 0, i = 0; k < p_; ++k) {
    if (!is_fixed(k)) of_free[i++] = theta_[k];
  }
  const Vector base = columns_.combination * of_free;
  for (Index k = 0; k < base.size(); ++k) {
    const robot::Coefficient& one = free_names_[static_cast<std::size_t>(columns_.kept[static_cast<std::size_t>(k)])];
    made.combinations.push_back({one.name, one.unit, holds(columns_, k, free_names_), base[k], free.base[k],
                                 std::sqrt(std::max(0.0, covariance_(k, k)))});
  }
  // The true robot is possible: the least loss is at most its own, ½ (θ − θ̂)ᵀRᵀR (θ − θ̂), a sum of squares of mean
  // ½ tr(R V Rᵀ) and variance ½ tr((R V Rᵀ)²).
  constexpr double kDeviations = 4.0;
  const Index kept = base.size();
  const Matrix spread = free.triangle * covariance_.topLeftCorner(kept, kept) * free.triangle.transpose();
  loss_by_chance_ = 0.5 * spread.trace() + kDeviations * std::sqrt(0.5 * spread.squaredNorm());
  made.loss = nearest.solution.value;
  made.gap = std::max(nearest.solution.last_change, 0.0);
  made.newton_steps = nearest.solution.steps;
  for (const std::string& link : nearest.replaced) {
    found.notes.push_back(
        fmt::format("the description states no physically consistent body for {}: a similar body, or a ball, is used "
                    "where the data do not decide",
                    link));
  }
  found.consistent = std::move(made);
  return {};
}

/// If the consistent robot fits much worse than the free fit, and noise does not explain the difference.
void warn_of_loss(RobotIdentification& found, double loss_by_chance) {
  constexpr double kMaxLoss = 0.5;  // [points of VAF]
  const ConsistentRobot& consistent = *found.consistent;
  std::size_t worst = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t joint = 0; joint < consistent.vaf_lost_in_sample.size(); ++joint) {
    const double lost = consistent.vaf_lost_in_sample[joint];  // held-out data add their own noise
    if (!(lost > most)) continue;
    most = lost;
    worst = joint;
  }
  if (!(most > kMaxLoss)) return;
  constexpr double kMaxByChance = 5.0;  // a wrong sign leaves a residual that looks like large noise
  if (!(consistent.loss > loss_by_chance) && most < kMaxByChance) {
    found.notes.push_back(fmt::format(
        "the consistent robot explains {:.3g} percentage points less of the torque of joint {} than the "
        "free fit: with this much noise the loss is not significant, because the free fit also explains noise",
        most, worst + 1));
    return;
  }
  constexpr std::size_t kNamed = 3;
  std::string which;
  for (std::size_t k = 0; k < std::min(kNamed, consistent.pressing.size()); ++k) {
    which += (which.empty() ? "; the most violated conditions are " : ", ") + consistent.pressing[k];
  }
  found.warnings.push_back(
      {WarningCode::consistent_fit_poor,
       fmt::format(
           "the consistent robot explains {:.3g} percentage points less of the torque of joint {} than the free fit{}",
           most, worst + 1, which),
       "check the sign and unit of each torque, the order of the joints and --fix; add missing drive terms, as in "
       "--terms motor_inertia,viscous,coulomb,offset"});
  found.usable = false;
}

/// Whether a model that explains the torque of a joint poorly is not usable: the mean of the torque would explain more,
/// or the residual is larger on held-out data. Neither is true if the joint hardly moves there or its torque is mostly
/// noise.
bool does_not_hold(const TorqueFit& fit) {
  constexpr double kAlike = 1.1, kLarger = 1.5;  // residual held out over that in sample
  const double growth = fit.rmse / std::max(fit.rmse_in_sample, 1e-300);
  return growth > kLarger || (fit.vaf < 0.0 && (growth > kAlike || fit.vaf_in_sample < 0.0));
}

void warn(RobotIdentification& found, double loss_by_chance) {
  std::vector<Warning>& warnings = found.warnings;
  if (!(found.inertia.smallest > 0.0)) {
    std::string where;
    for (const double q : found.inertia.where) where += fmt::format("{}{:.3g}", where.empty() ? "" : ", ", q);
    warnings.push_back(
        {WarningCode::inertia_not_positive,
         fmt::format("the inertia matrix is not positive definite with the joints at [{}] (smallest "
                     "eigenvalue {:.3g})",
                     where, found.inertia.smallest),
         std::string(found.model.drive.motor_inertia ? ""
                                                     : "for geared motors, add the inertia of their rotors with "
                                                       "--terms motor_inertia,viscous,coulomb,offset; ") +
             "find physically consistent bodies with --consistent; move faster and over more of the workspace; check "
             "order and signs of the torques"});
    found.usable = false;
  }
  constexpr double kHeaviest = 300.0, kLightest = 1e-3;  // [kg] of a robot that a person can hold
  if (found.model.mechanism->hand_axes() == 2 && found.inertia.smallest > 0.0 &&
      (found.inertia.mass_at_hand > kHeaviest || found.inertia.mass_at_hand < kLightest)) {
    const bool heavy = found.inertia.mass_at_hand > kHeaviest;
    warnings.push_back(
        {WarningCode::torque_unit,
         fmt::format("the robot would have an inertia of at least {:.3g} kg at its hand: its torques are probably not "
                     "in N·m but in {}",
                     found.inertia.mass_at_hand, heavy ? "N·mm" : "kN·m"),
         heavy ? "state the unit with --channels, as in tau1=14:N.mm,tau2=15:N.mm" : "check the unit of the torques"});
    found.usable = false;
  }
  if (found.rank < found.structural_rank) {
    std::string missing;
    for (const RobotCoefficient& one : found.coefficients) {
      if (!one.identified && !one.fixed) missing += (missing.empty() ? "" : ", ") + one.coefficient.name;
    }
    warnings.push_back({WarningCode::poorly_conditioned,
                        fmt::format("only {} of the {} identifiable combinations were excited; not identifiable: {}",
                                    found.rank, found.structural_rank, missing),
                        "add a recording in which every joint moves (several files in one fit)"});
  }
  constexpr double kLargestCondition = 300.0;
  if (found.condition > kLargestCondition) {
    std::string which;
    for (const auto& [name, share] : found.weakest) which += (which.empty() ? "" : ", ") + name;
    warnings.push_back({WarningCode::poorly_conditioned,
                        fmt::format("the motion hardly distinguishes {} (condition number {})", which,
                                    significant(found.condition, 3)),
                        "move more and more variedly, or omit terms with --terms"});
  }
  for (std::size_t joint = 0; joint < found.fit.size(); ++joint) {
    constexpr double kPoor = 80.0;
    const TorqueFit& fit = found.fit[joint];
    if (!(fit.vaf < kPoor)) continue;  // nor where there was no torque to explain
    std::string message = fmt::format("only {:.1f} % of the torque of joint {} is explained{}", fit.vaf, joint + 1,
                                      found.held_out ? " on held-out data" : "");
    std::string remedy =
        "add missing terms (--terms), estimate a delay (--motor-delay auto), lower --cutoff, or allow for noise of the "
        "motion (--method iv)";
    if (found.held_out && fit.vaf_in_sample >= kPoor) {
      message += fmt::format("; in the fitted data, {:.1f} %", fit.vaf_in_sample);
      remedy =
          "use fewer --terms, record longer and more varied motion, and keep load, temperature and gains of the robot "
          "constant";
    }
    warnings.push_back({found.held_out ? WarningCode::held_out_fit_poor : WarningCode::fit_poor, std::move(message),
                        std::move(remedy)});
    if (does_not_hold(fit)) found.usable = false;
  }
  if (found.consistent) warn_of_loss(found, loss_by_chance);
  for (const RobotCoefficient& one : found.coefficients) {
    const bool positive = one.coefficient.name.starts_with("viscous") || one.coefficient.name.starts_with("coulomb");
    if (!one.identified || !positive || one.value + numeric::kNormal95 * one.standard_error >= 0.0) continue;
    warnings.push_back({WarningCode::damping_not_positive,
                        fmt::format("{} is negative: friction would drive the joint", one.coefficient.name),
                        "check the sign of the torque, or estimate a delay with --motor-delay auto"});
  }
}

Result<RobotFit> RobotFitter::fit() {
  MBK_TRY(prepare());
  MBK_TRY(solve());
  take_covariance();
  RobotFit made;
  made.delay_correction = delay_correction_;
  RobotIdentification& found = made.identification;
  found.model = model_;
  found.model.parameters = theta_;
  found.method = options_.method;
  found.samples = rows_.rows();
  found.hac_lag_s = static_cast<double>(lags_) * trials_.front().sample_time;
  if (options_.delay) {
    found.delay_standard_error = std::sqrt(std::max(0.0, covariance_(covariance_.rows() - 1, covariance_.cols() - 1)));
  }
  if (by_instruments()) {
    found.instrument_motion = trials_.front().instrument_motion;
    found.motion_cutoff = trials_.front().motion_cutoff;
    found.smoothed_cutoff = (held_out_.empty() ? trials_ : held_out_).front().smoothed_cutoff;
  }
  for (const PreparedDynamics& trial : trials_) {
    found.preparations.push_back(trial.preparation);
    found.sources.insert(found.sources.end(), trial.sources.begin(), trial.sources.end());
    found.durations.push_back(trial.recording_duration);
    found.rates.push_back(trial.recording_rate);
    found.notes.insert(found.notes.end(), trial.notes.begin(), trial.notes.end());
    found.warnings.insert(found.warnings.end(), trial.warnings.begin(), trial.warnings.end());
  }
  for (const PreparedDynamics& trial : held_out_) {
    for (const SourceFile& source : trial.sources) found.held_out_files.push_back(source.label());
  }
  judge(found);
  if (options_.consistent) {
    std::vector<TorqueFit> of_free = std::move(found.fit);
    found.fit.clear();
    MBK_TRY(make_consistent(found));
    found.model.parameters = theta_;
    judge(found);
    compare(found.fit, std::move(of_free), *found.consistent);
  }
  describe(found);
  check_inertia(found);
  warn(found, loss_by_chance_);
  return made;
}

}  // namespace

Result<RobotFit> fit_robot(const std::vector<PreparedDynamics>& trials, const std::vector<PreparedDynamics>& held_out,
                           const robot::DynamicModel& model, const RobotFitOptions& options) {
  return RobotFitter(trials, held_out, model, options).fit();
}

}  // namespace mbk::identify
