#include "mbk/measure/identify/impedance_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "mbk/base/numeric/block_bootstrap.h"
#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/instrumental_variables.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/long_run_covariances.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/identify/fit_checks.h"
#include "mbk/measure/identify/instruments.h"
#include "mbk/measure/identify/missing_dynamics.h"
#include "mbk/measure/identify/regression.h"
#include "mbk/model/trial/filtered_band.h"

namespace mbk::identify {
namespace {

double largest_relative_change(const impedance::Model& a, const impedance::Model& b) {
  double largest = 0.0;
  for (const auto& [x, y] : {std::pair{&a.M, &b.M}, std::pair{&a.B, &b.B}, std::pair{&a.K, &b.K}}) {
    const double scale = x->cwiseAbs().maxCoeff();
    if (scale > 0.0) largest = std::max(largest, (*y - *x).cwiseAbs().maxCoeff() / scale);
  }
  return largest;
}

/// Coefficients by either method, with what their uncertainty is made of: φ − φ₀ ≈ A Σ_t Sᵀ(e_t ⊗ r_t).
struct Estimate {
  Matrix coefficients;  ///< p×n
  Matrix structure;     ///< S
  Matrix bread;         ///< A, k×k
  int rank = 0;
  Matrix residuals = {};  ///< Y − Z θ of every row, where they were asked for
};

bool is_tied(const Estimate& estimate) {
  const Matrix& S = estimate.structure;
  return S.rows() != S.cols() || !S.isIdentity(0.0);
}

/// What is fitted, and from which rows.
class Fitter {
 public:
  Fitter(const std::vector<PreparedTrial>& trials, const Options& options)
      : trials_(trials), options_(options), r_(stack(trials)) {
    put_on_disk(r_);
  }

  Result<void> prepare();
  Result<void> find_instruments();
  Result<void> find(Method method);
  /// @param method one that was found
  Result<Identification> identify(Method method);
  [[nodiscard]] Disagreement compare() const;

 private:
  [[nodiscard]] Result<Estimate> estimate(Method method, const std::vector<RowRange>& ranges, Index step = 1) const;
  [[nodiscard]] const Matrix& instruments(Method method) const {
    return method == Method::least_squares ? r_.Z : instruments_->columns(r_);
  }
  [[nodiscard]] bool is_full(const Estimate& estimate) const { return estimate.rank == r_.Z.cols(); }
  [[nodiscard]] impedance::Model model_from(const Estimate& estimate) const;
  [[nodiscard]] Result<Replicates> resample(Method method) const;
  [[nodiscard]] Matrix covariance_of_robot(Method method, const Estimate& estimate) const;
  /// Ω of the scores of a method that was found or, where both were, those of both in one pass.
  [[nodiscard]] const Matrix& long_run(Method method);
  /// Y − Z θ of every row by a method that was found.
  [[nodiscard]] const Matrix& residuals(Method method);
  /// @param estimate  whose residuals are there
  [[nodiscard]] Matrix scores(Method method, const Estimate& estimate, const RowRange& range) const;
  /// The same as products of instruments and residuals, where no coefficients are tied.
  void add_scores(Method method, const RowRange& range, numeric::ScoreProducts& products) const;
  /// What the instruments explain of the residual of a method of full rank, axis by axis; of all such in one pass.
  [[nodiscard]] const Vector& coherent_fraction(Method method);
  void describe(Identification& result) const;

  [[nodiscard]] Result<void> choose_handle_mass();
  /// @param fraction  what the instruments explain of the residual, axis by axis
  [[nodiscard]] UnmodelledResponse response_in(const Matrix& residual, const Vector& fraction) const;
  [[nodiscard]] Index rows_by_cutoff() const;
  void widen_by_curvature(const Vector& curvature, Identification& result);
  [[nodiscard]] const TestedAssumptions& assumptions_tested(Method method, const Estimate& estimate);

  const std::vector<PreparedTrial>& trials_;
  const Options& options_;
  Regression r_;
  Matrix S_;
  std::vector<RowRange> ranges_;  ///< behind the parameters
  Index samples_ = 0, lags_ = 0;
  double widening_ = 1.0, handle_mass_ = 0.0;
  HandleMassSource handle_mass_from_ = HandleMassSource::none;
  bool all_ = false;
  std::optional<Instruments> instruments_;
  std::array<std::optional<Estimate>, 2> estimates_;  ///< by method
  std::array<std::optional<Estimate>, 2> judged_;     ///< from the identification data alone, where these differ
  std::array<Matrix, 2> omegas_;                      ///< long-run covariances of their scores
  Matrix omega_of_both_;                              ///< of [instrumental variables | least squares]
  std::array<Vector, 2> coherent_;                    ///< fractions of their residuals
  std::optional<Spread> spread_;                      ///< of the rows behind the parameters
  std::array<Vector, 2> errors_;                      ///< standard errors of their coefficients, stacked
  std::optional<TestedAssumptions> assumptions_;      ///< of the data, by whichever method comes first
};

Result<void> check_options(const std::vector<PreparedTrial>& trials, const Options& options) {
  if (trials.empty()) return bad_usage("no trial was given");
  if (!(options.hac_lag_s >= 0.0 && std::isfinite(options.hac_lag_s))) {
    return bad_usage(fmt::format("the noise correlation time of {:g} s is not 0 or more", options.hac_lag_s));
  }
  if (options.handle_mass && !std::isfinite(*options.handle_mass)) {
    return bad_usage(fmt::format("the handle mass of {:g} kg is not 0 or more", *options.handle_mass));
  }
  const PreparedTrial& first = trials.front();
  for (const PreparedTrial& trial : trials) {
    if (trial.axes != first.axes || trial.motion != first.motion) {
      return bad_data("its axes or units differ from those of the first file, so they cannot be pooled",
                      "measure it separately", trial.sources.empty() ? "" : trial.sources.front().label());
    }
    if (std::abs(trial.sample_time - first.sample_time) > 1e-6 * first.sample_time) {
      return bad_data(fmt::format("trials sampled at {:g} Hz and {:g} Hz cannot be pooled", first.recording_rate,
                                  trial.recording_rate),
                      "resample them to one rate with --resample HZ");
    }
  }
  return {};
}

Result<void> Fitter::choose_handle_mass() {
  if (options_.handle_mass) {
    handle_mass_ = *options_.handle_mass;
    handle_mass_from_ = handle_mass_ == 0.0 ? HandleMassSource::none : HandleMassSource::option;
    return {};
  }
  if (trials_.front().preparation.mode == Mode::reference) return {};
  constexpr double kSame = 1e-9;  // of what was written with twelve digits
  const std::optional<double>& first = trials_.front().recorded_handle_mass;
  for (const PreparedTrial& trial : trials_) {
    const std::optional<double>& mass = trial.recorded_handle_mass;
    const std::string file = trial.sources.empty() ? "" : trial.sources.front().label();
    if (mass && !(*mass >= 0.0 && std::isfinite(*mass))) {
      return bad_data("its 'handle_mass_kg' is not a mass", "give it with --handle-mass KG", file);
    }
    if (mass.has_value() != first.has_value() || (mass && std::abs(*mass - *first) > kSame)) {
      return bad_data(fmt::format("its handle mass ({}) differs from that of the first file ({})",
                                  mass ? fmt::format("{:g} kg", *mass) : "not recorded",
                                  first ? fmt::format("{:g} kg", *first) : "not recorded"),
                      "give one mass for all with --handle-mass KG, or measure it separately", file);
    }
  }
  handle_mass_ = first.value_or(0.0);
  if (handle_mass_ > 0.0) handle_mass_from_ = HandleMassSource::recording;
  return {};
}

Result<void> Fitter::prepare() {
  if (r_.identification.empty()) return bad_data("no data are left for identification", "move --split to a later time");
  MBK_TRY(choose_handle_mass());
  S_ = structure_matrix(options_.structure, r_.axes());
  const Preparation& how = trials_.front().preparation;
  const bool pulses_by_default = how.mode == Mode::default_mode && how.protocol == Protocol::underdamped;
  const ParametersFrom from =
      options_.parameters_from.value_or(pulses_by_default ? ParametersFrom::all : ParametersFrom::identification);
  all_ = from == ParametersFrom::all;
  ranges_ = all_ ? joined(r_.identification, r_.validation) : joined(r_.identification, {});
  centre_reference(r_, ranges_);
  for (const RowRange& range : ranges_) samples_ += range.size();
  const double data_s = static_cast<double>(samples_) * r_.sample_time;
  if (options_.hac_lag_s > std::max(data_s, Options{}.hac_lag_s)) {
    return bad_usage(fmt::format("--hac-lag {:g} s is longer than the {:.3g} s of data", options_.hac_lag_s, data_s),
                     "choose a shorter one; the noise correlation time is rarely as long as 1 s");
  }
  lags_ = static_cast<Index>(std::llround(options_.hac_lag_s / r_.sample_time));
  const double coefficients = static_cast<double>(r_.Z.cols());
  double independent = static_cast<double>(samples_);
  if (how.cutoff) independent = std::min(independent, 2.0 * how.cutoff->value * data_s);
  widening_ = numeric::newey_west_widening(static_cast<double>(lags_) / static_cast<double>(samples_)) *
              numeric::fitted_widening(independent, coefficients);
  return {};
}

Result<Estimate> Fitter::estimate(Method method, const std::vector<RowRange>& ranges, Index step) const {
  const SelectedRows Z(r_.Z, ranges, step), Y(r_.Y, ranges, step);
  if (method == Method::least_squares) {
    auto fit = MBK_TRY(numeric::fit_least_squares(*Z, *Y, S_));
    return Estimate{std::move(fit.coefficients), std::move(fit.structure), std::move(fit.inverse_gram), fit.rank};
  }
  const bool every_row = Y->rows() == samples_;
  auto fit = MBK_TRY(every_row ? numeric::fit_instrumental_variables(instruments_->gram, r_.Z.cols(), samples_, S_)
                               : numeric::fit_instrumental_variables(
                                     *Z, *SelectedRows(instruments_->columns(r_), ranges, step), *Y, S_));
  return Estimate{std::move(fit.coefficients), std::move(fit.structure), std::move(fit.inverse), fit.rank};
}

/// The coefficients of smallest norm explain the force too where the rank is short, but they are not the limb's.
impedance::Model Fitter::model_from(const Estimate& estimate) const {
  const Index n = r_.axes();
  const Vector undefined = Vector::Constant(3 * n * n + n, std::numeric_limits<double>::quiet_NaN());
  return is_full(estimate) ? model_of(estimate.coefficients, r_.centre, handle_mass_)
                           : impedance::unstacked(undefined, n);
}

Matrix Fitter::scores(Method method, const Estimate& estimate, const RowRange& range) const {
  return numeric::regression_scores(instruments(method), estimate.residuals, estimate.structure, range);
}

void Fitter::add_scores(Method method, const RowRange& range, numeric::ScoreProducts& products) const {
  const Matrix &R = instruments(method), &residuals = estimates_[static_cast<std::size_t>(method)]->residuals;
  for (Index axis = 0; axis < residuals.cols(); ++axis) {
    for (Index i = 0; i < R.cols(); ++i) {
      products.left.push_back(R.col(i).data() + range.begin);
      products.right.push_back(residuals.col(axis).data() + range.begin);
    }
  }
}

const Matrix& Fitter::residuals(Method method) {
  Estimate& one = *estimates_[static_cast<std::size_t>(method)];
  if (one.residuals.size() == 0) {
    one.residuals = numeric::residuals_of({r_.Z}, r_.Y, one.coefficients);
    put_on_disk(one.residuals);
  }
  return one.residuals;
}

/// What the coefficients of the robot, on which the force rests, leave open of φ: D V Dᵀ with D = ∂φ/∂θ, found by the
/// same regression from ∂(−F_h)/∂θ, since φ is linear in the force.
Matrix Fitter::covariance_of_robot(Method method, const Estimate& estimate) const {
  const Index p = r_.robot_covariance.rows(), n = r_.axes();
  Matrix D = Matrix::Zero(estimate.bread.rows(), p);
  for (const RowRange& range : ranges_) {
    const Matrix R = instruments(method).middleRows(range.begin, range.size());
    for (Index k = 0; k < p; ++k) {
      Matrix change(range.size(), n);
      for (Index axis = 0; axis < n; ++axis) {
        change.col(axis) = -r_.force_sensitivity.col(axis * p + k).segment(range.begin, range.size());
      }
      D.col(k) +=
          numeric::regression_scores(R, change, estimate.structure, {0, range.size()}).colwise().sum().transpose();
    }
  }
  D = estimate.bread * D;
  return D * r_.robot_covariance * D.transpose();
}

/// What both methods have in common.
void Fitter::describe(Identification& result) const {
  const PreparedTrial& first = trials_.front();
  result.axes = first.axes;
  result.motion = first.motion;
  result.structure = options_.structure;
  result.handle_mass = handle_mass_;
  result.handle_mass_from = handle_mass_from_;
  result.parameters_from = all_ ? ParametersFrom::all : ParametersFrom::identification;
  result.parameters = parameter_names(first.axes);
  result.samples = samples_;
  result.hac_lag_s = static_cast<double>(lags_) * r_.sample_time;
  for (const PreparedTrial& trial : trials_) {
    result.preparations.push_back(trial.preparation);
    result.conditions.push_back(trial.conditions);
    result.sources.insert(result.sources.end(), trial.sources.begin(), trial.sources.end());
    result.durations.insert(result.durations.end(), trial.sources.size(), trial.recording_duration);
    result.rates.insert(result.rates.end(), trial.sources.size(), trial.recording_rate);
    result.notes.insert(result.notes.end(), trial.notes.begin(), trial.notes.end());
    result.warnings.insert(result.warnings.end(), trial.warnings.begin(), trial.warnings.end());
  }
}

Result<void> Fitter::find_instruments() {
  if (instruments_) return {};
  instruments_ = MBK_TRY(make_instruments(r_, trials_.front().reference_quantity, {ranges_, lags_, rows_by_cutoff()}));
  return {};
}

Result<void> Fitter::find(Method method) {
  if (method == Method::instrumental_variables) {
    MBK_TRY(find_instruments());
  }
  const auto at = static_cast<std::size_t>(method);
  auto fit = estimate(method, r_.identification);
  if (!fit) return tl::unexpected(fit.error());
  if (all_ && !r_.validation.empty()) {
    judged_[at] = std::move(*fit);
    fit = estimate(method, ranges_);
    if (!fit) return tl::unexpected(fit.error());
  }
  estimates_[at] = std::move(*fit);
  return {};
}

const Matrix& Fitter::long_run(Method method) {
  constexpr auto kLs = Method::least_squares, kIv = Method::instrumental_variables;
  Matrix& requested = omegas_[static_cast<std::size_t>(method)];
  if (requested.size() > 0) return requested;
  const auto &ls = estimates_[0], &iv = estimates_[1];
  if (!ls || !iv || !is_full(*ls) || !is_full(*iv)) {
    const Estimate& one = *estimates_[static_cast<std::size_t>(method)];
    (void)residuals(method);
    requested = numeric::long_run_covariance(one.bread.rows(), ranges_, lags_,
                                             [&](const RowRange& range) { return scores(method, one, range); });
    return requested;
  }
  const Index k = iv->bread.rows();
  for (const Method one : {kLs, kIv}) (void)residuals(one);
  if (is_tied(*ls)) {
    omega_of_both_ = numeric::long_run_covariance(2 * k, ranges_, lags_, [&](const RowRange& range) {
      Matrix both(range.size(), 2 * k);
      both << scores(kIv, *iv, range), scores(kLs, *ls, range);
      return both;
    });
  } else {
    const auto products_of = [&](const RowRange& range) {
      numeric::ScoreProducts products;
      for (const Method one : {kIv, kLs}) add_scores(one, range, products);
      return products;
    };
    omega_of_both_ = numeric::long_run_covariances(1, 2 * k, ranges_, lags_, products_of).front();
  }
  omegas_[static_cast<std::size_t>(kIv)] = omega_of_both_.topLeftCorner(k, k);
  omegas_[static_cast<std::size_t>(kLs)] = omega_of_both_.bottomRightCorner(k, k);
  return requested;
}

/// Of the rows, the first of so many holds all that the filters of every trial leave.
Index Fitter::rows_by_cutoff() const {
  Index shortest = samples_;
  for (const RowRange& range : ranges_) shortest = std::min(shortest, range.size());
  Index step = shortest;
  for (const PreparedTrial& trial : trials_) {
    const auto& cutoff = trial.preparation.cutoff;
    step = std::min(step, cutoff ? enough_of(Hertz(1.0 / trial.sample_time), *cutoff, shortest) : Index{1});
  }
  return std::max<Index>(1, step);
}

const Vector& Fitter::coherent_fraction(Method method) {
  Vector& requested = coherent_[static_cast<std::size_t>(method)];
  if (requested.size() > 0) return requested;
  std::vector<std::size_t> full;
  for (std::size_t at = 0; at < estimates_.size(); ++at) {
    if (estimates_[at] && is_full(*estimates_[at])) full.push_back(at);
  }
  const Index n = r_.axes();
  std::vector<numeric::MatrixPart> all;
  for (const std::size_t k : full) all.emplace_back(residuals(static_cast<Method>(k)));
  const Vector fractions = coherent_residual_fraction(r_, *instruments_, all, ranges_, rows_by_cutoff());
  for (std::size_t k = 0; k < full.size(); ++k) coherent_[full[k]] = fractions.segment(static_cast<Index>(k) * n, n);
  return requested;
}

Result<Identification> Fitter::identify(Method method) {
  const Index n = r_.axes();
  const auto at = static_cast<std::size_t>(method);
  const Estimate* const fit = &*estimates_[at];
  const Estimate* const check = judged_[at] ? &*judged_[at] : fit;

  Identification result;
  describe(result);
  result.method = method;
  result.model = model_from(*fit);
  result.judged = model_from(*check);
  result.fit = check == fit ? judge_residuals(r_, residuals(method)) : judge(r_, check->coefficients);
  const auto count = static_cast<Index>(result.parameters.size());
  result.covariance.setConstant(count, count, std::numeric_limits<double>::quiet_NaN());
  if (is_full(*fit)) {
    const Matrix V = fit->bread * long_run(method) * fit->bread.transpose();
    result.covariance = model_covariance(fit->structure, widening_ * widening_ * V, result.model, r_.centre);
    errors_[at] = widening_ * (fit->structure * V * fit->structure.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
    if (r_.robot_covariance.size() > 0) {
      const Matrix of_robot =
          model_covariance(fit->structure, covariance_of_robot(method, *fit), result.model, r_.centre);
      result.covariance += of_robot;
      result.standard_error_of_robot = impedance::unstacked(of_robot.diagonal().cwiseMax(0.0).cwiseSqrt(), n);
    }
  }
  result.standard_error = impedance::unstacked(result.covariance.diagonal().cwiseSqrt(), n);
  if (method == Method::instrumental_variables) {
    result.instrument = InstrumentCheck{instruments_->from, instruments_->strength, Vector::Constant(n, std::nan(""))};
  }
  if (instruments_ && is_full(*fit)) {
    const Vector& fraction = coherent_fraction(method);
    if (result.instrument) result.instrument->coherent_residual = fraction;
    result.response = response_in(residuals(method), fraction);
  }
  if (is_full(*fit)) {
    const TestedAssumptions& tested = assumptions_tested(method, *fit);
    result.assumptions = tested.found;
    widen_by_curvature(tested.curvature, result);
  }
  if (options_.bootstrap > 0 && is_full(*fit)) {
    auto replicates = MBK_TRY(resample(method));
    result.replicates = std::move(replicates);
  }
  if (!spread_) spread_ = spread_of(*SelectedRows(r_.Z, ranges_), *SelectedRows(r_.Y, ranges_));
  result.excitation = measure_excitation(*spread_, result.model, fit->rank);
  result.excitation.duration = static_cast<double>(samples_) * r_.sample_time;

  if (options_.decimate_check) {
    // At least every other one: the rows may be decimated already.
    const auto step = std::max<Index>(2, static_cast<Index>(std::llround(1.0 / (100.0 * r_.sample_time))));
    const auto coarse = MBK_TRY(estimate(method, ranges_, step));
    DecimationCheck decimation;
    decimation.rate_hz = 1.0 / (static_cast<double>(step) * r_.sample_time);
    decimation.model = model_of(coarse.coefficients, r_.centre, handle_mass_);
    decimation.largest_change = largest_relative_change(result.model, decimation.model);
    result.decimation = decimation;
  }
  add_warnings(result);
  return result;
}

Result<Replicates> Fitter::resample(Method method) const {
  const Index n = r_.axes(), p = r_.Z.cols();
  numeric::BlockBootstrapOptions how;
  how.block_rows = std::max<Index>(1, std::llround(options_.block_s / r_.sample_time));
  how.replicates = options_.bootstrap;
  how.seed = options_.seed;
  how.threads = options_.threads;
  const auto drawn = MBK_TRY(numeric::block_bootstrap(r_.Z, instruments(method), r_.Y, S_, ranges_, how));
  Replicates result{Matrix(3 * n * n + n, drawn.coefficients.cols()), options_.block_s, drawn.blocks, how.seed};
  for (Index k = 0; k < drawn.coefficients.cols(); ++k) {
    const Matrix coefficients = Vector(S_ * drawn.coefficients.col(k)).reshaped(p, n);
    result.models.col(k) = impedance::stacked(model_of(coefficients, r_.centre, handle_mass_));
  }
  return result;
}

/// Where stiffness depends on posture x₀ is off by K⁻¹ times the mean force of that curvature: its interval holds both.
void Fitter::widen_by_curvature(const Vector& curvature, Identification& result) {
  if (curvature.size() == 0) return;
  const Index n = r_.axes();
  const Matrix compliance = numeric::inverse(result.model.K);
  result.covariance.diagonal().tail(n) += compliance.cwiseAbs2() * curvature.cwiseAbs2();
  result.standard_error.x0 = result.covariance.diagonal().tail(n).cwiseSqrt();
}

UnmodelledResponse Fitter::response_in(const Matrix& residual, const Vector& fraction) const {
  const Index n = r_.axes();
  const SelectedRows left(residual, ranges_), force(r_.Y, ranges_);
  Vector at_rest = Vector::Zero(n);
  double weight = 0.0;
  for (const PreparedTrial& trial : trials_) {
    if (trial.force_variance_at_rest.size() != n) continue;
    at_rest += trial.force_variance_at_rest;
    weight += 1.0;
  }
  UnmodelledResponse result;
  result.coherent.resize(n);
  if (weight > 0.0) result.induced.resize(n);
  for (Index j = 0; j < n; ++j) {
    const double all = numeric::variance(force->col(j)), unexplained = numeric::variance(left->col(j));
    result.coherent[j] = all > 0.0 ? fraction[j] * unexplained / all : std::nan("");
    if (weight > 0.0)
      result.induced[j] = all > 0.0 ? std::max(0.0, unexplained - at_rest[j] / weight) / all : std::nan("");
  }
  return result;
}

const TestedAssumptions& Fitter::assumptions_tested(Method method, const Estimate& estimate) {
  if (!assumptions_) {
    const Matrix errors = errors_[static_cast<std::size_t>(method)].reshaped(estimate.coefficients.rows(), r_.axes());
    assumptions_ =
        test_assumptions(r_, estimate.coefficients, errors, passed_band(trials_.front().preparation), ranges_);
  }
  return *assumptions_;
}

Disagreement Fitter::compare() const {
  const auto &ls = estimates_[0], &iv = estimates_[1];
  Disagreement result;
  if (!ls || !iv || !is_full(*ls) || !is_full(*iv)) return result;
  const Index n = r_.axes(), p = 3 * n + 1;
  const Index k = iv->bread.rows();
  Matrix bread(k, 2 * k);
  bread << iv->bread, -ls->bread;
  const Matrix V = bread * omega_of_both_ * bread.transpose();
  const Vector variance = (iv->structure * V * iv->structure.transpose()).diagonal();
  const std::vector<std::string> names = parameter_names(static_cast<int>(n));
  double largest = -std::numeric_limits<double>::infinity();
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < 3 * n; ++i) {
      const double difference = iv->coefficients(i, j) - ls->coefficients(i, j);
      const double error = widening_ * std::sqrt(std::max(0.0, variance[j * p + i]));
      const double beyond = (std::abs(difference) - errors_[0][j * p + i]) / error;
      if (!(error > 0.0) || !(beyond > largest)) continue;
      largest = beyond;
      const Index part = i / n, column = i % n;
      result.parameter = names[static_cast<std::size_t>(part * n * n + j * n + column)];
      result.difference = difference;
      result.standard_error = error;
      result.least_squares = ls->coefficients(i, j) - (part == 0 && column == j ? handle_mass_ : 0.0);
    }
  }
  // Bonferroni: 1 % over 3n² parameters.
  constexpr std::array kQuantiles = {2.935, 3.341, 3.560};  // two-sided, normal, of 0.01/3, 0.01/12 and 0.01/27
  result.significant = largest > kQuantiles[static_cast<std::size_t>(n - 1)];
  return result;
}

}  // namespace

std::vector<std::string> parameter_names(int axes) {
  if (axes == 1) return {"m", "b", "k", "x0"};
  std::vector<std::string> names;
  for (const char matrix : {'m', 'b', 'k'}) {
    for (int row = 0; row < axes; ++row) {
      for (int column = 0; column < axes; ++column) {
        names.push_back(fmt::format("{}_{}{}", matrix, "xyz"[row], "xyz"[column]));
      }
    }
  }
  for (int axis = 0; axis < axes; ++axis) names.push_back(fmt::format("{}0", "xyz"[axis]));
  return names;
}

Result<Identification> identify_impedance(const std::vector<PreparedTrial>& trials, const Options& options) {
  MBK_TRY(check_options(trials, options));
  Fitter fitter(trials, options);
  MBK_TRY(fitter.prepare());
  const Method method = options.method.value_or(Method::least_squares);
  MBK_TRY(fitter.find(method));
  return fitter.identify(method);
}

Result<Comparison> compare_methods(const std::vector<PreparedTrial>& trials, const Options& options) {
  MBK_TRY(check_options(trials, options));
  Fitter fitter(trials, options);
  MBK_TRY(fitter.prepare());
  MBK_TRY(fitter.find_instruments());
  for (const Method method : {Method::least_squares, Method::instrumental_variables}) {
    MBK_TRY(fitter.find(method));
  }
  auto ls = MBK_TRY(fitter.identify(Method::least_squares));
  auto iv = MBK_TRY(fitter.identify(Method::instrumental_variables));
  Comparison both{std::move(ls), std::move(iv), fitter.compare()};
  warn_of_closed_loop(both.instrumental_variables, both.disagreement, both.least_squares);
  return both;
}

}  // namespace mbk::identify
