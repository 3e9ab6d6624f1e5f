#include "mbk/measure/calibration/spring_constant.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::calibration {
namespace {

using numeric::RowRange;

constexpr double kSeen = 4.0;  // standard errors by which a hook's deflection must stand out
constexpr double kStraightPart = 1.0 / 3.0;
constexpr double kMinFit = 0.9;  // R² below which a line says nothing

/// A stretch with s growing with the tension.
struct Stretch {
  Vector s, tension;
  Index lags = 0;
};

/// V of Newey and West, widened, for the regressors Z and the residual.
Matrix covariance(const numeric::LinearFit& fit, const Matrix& Z, const Vector& residual,
                  const std::vector<RowRange>& ranges, Index lags) {
  const double share = std::min(1.0, static_cast<double>(lags) / static_cast<double>(Z.rows()));
  const double widening = numeric::newey_west_widening(share);
  return widening * widening * numeric::newey_west_covariance(fit, Z, residual, ranges, lags);
}

/// T = k s + c through the samples with s ≥ `from`. Runs of such samples are what correlation stays within.
Result<SpringLine> line_through(const Stretch& stretch, double from) {
  std::vector<Index> rows;
  std::vector<RowRange> ranges;
  for (Index i = 0; i < stretch.s.size(); ++i) {
    if (stretch.s[i] < from) continue;
    const auto at = static_cast<Index>(rows.size());
    if (rows.empty() || rows.back() != i - 1) ranges.push_back({at, at});
    ranges.back().end = at + 1;
    rows.push_back(i);
  }
  const Vector s = stretch.s(rows), T = stretch.tension(rows);
  if (s.size() < 3) return bad_data("the straight part has fewer than 3 samples");
  const double middle = s.mean();
  Matrix Z(s.size(), 2);
  Z << (s.array() - middle).matrix(), Vector::Ones(s.size());
  const auto fit = MBK_TRY(numeric::fit_least_squares(Z, T));
  const Vector residual = T - Z * fit.coefficients;
  const Matrix V = covariance(fit, Z, residual, ranges, std::min(stretch.lags, s.size() / 4));
  SpringLine line;
  const double k = fit.coefficients(0, 0), c = fit.coefficients(1, 0);
  line.stiffness = k;
  line.stiffness_error = std::sqrt(V(0, 0));
  line.rest = middle - c / k;
  const Eigen::Vector2d by(c / (k * k), -1.0 / k);  // of the rest position by k and c
  line.rest_error = std::sqrt(by.dot(V * by));
  line.r_squared = 1.0 - residual.squaredNorm() / (T.array() - T.mean()).matrix().squaredNorm();
  line.rmse = numeric::root_mean_square(residual);
  line.tension_from = (Z * fit.coefficients).minCoeff();
  line.tension_to = (Z * fit.coefficients).maxCoeff();
  line.samples = s.size();
  return line;
}

constexpr Index kHookParameters = 4;  // s₀, 1/k, s_h, ln F_h
using HookParameters = Eigen::Matrix<double, kHookParameters, 1>;

HookFit hooks_of(const HookParameters& p) {
  HookFit fit;
  fit.rest = p[0];
  fit.stiffness = 1.0 / p[1];
  fit.deflection = p[2];
  fit.force = std::exp(p[3]);
  return fit;
}

/// ds/dT, of which the hooks' part goes on unchanged below T = 0.
double compliance(const HookFit& fit, double T) {
  return 1.0 / fit.stiffness + fit.deflection / fit.force * std::exp(-std::max(T, 0.0) / fit.force);
}

/// T(s) and its derivatives by the parameters: ∂T/∂p = −(∂s/∂p)/(∂s/∂T).
void model(const HookParameters& p, const Vector& s, Vector& T, Matrix& jacobian) {
  const HookFit fit = hooks_of(p);
  T.resize(s.size());
  jacobian.resize(s.size(), kHookParameters);
  for (Index i = 0; i < s.size(); ++i) {
    T[i] = hook_tension(fit, s[i]);
    const double ratio = T[i] / fit.force, decay = std::exp(-std::max(ratio, 0.0));
    const double by_deflection = ratio > 0.0 ? 1.0 - decay : ratio;
    jacobian.row(i) << 1.0, T[i], by_deflection, -fit.deflection * ratio * decay;
    jacobian.row(i) *= -1.0 / compliance(fit, T[i]);
  }
}

/// The best of a grid over F_h: for each, s = s₀ + T/k + s_h (1 − exp(−T/F_h)) is linear in the rest.
std::optional<HookParameters> first_guess(const Stretch& stretch, double largest_tension) {
  constexpr int kGrid = 24;
  constexpr double kFirst = 0.01, kLast = 0.5;  // of the largest tension
  std::optional<HookParameters> best;
  double least = std::numeric_limits<double>::infinity();
  for (int g = 0; g < kGrid; ++g) {
    const double force = largest_tension * kFirst * std::pow(kLast / kFirst, static_cast<double>(g) / (kGrid - 1));
    Matrix Z(stretch.s.size(), 3);
    Z << Vector::Ones(stretch.s.size()), stretch.tension,
        (1.0 - (-stretch.tension.array().max(0.0) / force).exp()).matrix();
    const auto fit = numeric::fit_least_squares(Z, stretch.s);
    if (!fit || fit->rank < Z.cols()) continue;
    const Vector c = fit->coefficients;
    const double error = (stretch.s - Z * c).squaredNorm();
    if (error >= least || !(c[1] > 0.0) || !(c[2] > 0.0)) continue;
    least = error;
    best = HookParameters(c[0], c[1], c[2], std::log(force));
  }
  return best;
}

/// Levenberg–Marquardt on T(s). Nothing where the fit leaves sense (no hook, F_h beyond the data) or does not settle.
std::optional<HookFit> fit_hooks(const Stretch& stretch) {
  constexpr int kMaxSteps = 200;
  constexpr double kSettled = 1e-12;
  const double largest_tension = stretch.tension.maxCoeff();
  auto start = first_guess(stretch, largest_tension);
  if (!start) return std::nullopt;
  HookParameters p = *start;
  Vector T;
  Matrix jacobian;
  model(p, stretch.s, T, jacobian);
  double error = (stretch.tension - T).squaredNorm(), damping = 1e-3;
  bool settled = false;
  for (int step = 0; step < kMaxSteps && !settled; ++step) {
    const Eigen::Matrix4d normal = jacobian.transpose() * jacobian;
    const HookParameters gradient = jacobian.transpose() * (stretch.tension - T);
    Eigen::Matrix4d damped = normal;
    damped.diagonal() *= 1.0 + damping;
    const HookParameters move = damped.ldlt().solve(gradient);
    const HookParameters trial = p + move;
    const bool sensible = trial.allFinite() && trial[1] > 0.0 && trial[2] > 0.0 && std::exp(trial[3]) < largest_tension;
    Vector trial_T;
    Matrix trial_jacobian;
    double trial_error = std::numeric_limits<double>::infinity();
    if (sensible) {
      model(trial, stretch.s, trial_T, trial_jacobian);
      trial_error = (stretch.tension - trial_T).squaredNorm();
    }
    settled = std::abs(error - trial_error) <= kSettled * error || damping > 1e12;
    if (trial_error <= error) {
      p = trial;
      T = trial_T;
      jacobian = trial_jacobian;
      error = trial_error;
      damping *= 0.2;
    } else {
      damping *= 5.0;
    }
  }
  const Vector residual = stretch.tension - T;
  const auto linear = numeric::fit_least_squares(jacobian, residual);
  if (!linear || linear->rank < kHookParameters) return std::nullopt;
  const Matrix V = covariance(*linear, jacobian, residual, {{0, residual.size()}}, stretch.lags);
  HookFit fit = hooks_of(p);
  fit.stiffness_error = std::sqrt(V(1, 1)) * fit.stiffness * fit.stiffness;
  fit.deflection_error = std::sqrt(V(2, 2));
  fit.rmse = numeric::root_mean_square(residual);
  return fit;
}

Result<void> check(const Vector& time, const Vector& position, const Vector& reaction, const StretchOptions& options) {
  constexpr Index kMin = 20;
  if (time.size() != position.size() || time.size() != reaction.size()) {
    return bad_data(fmt::format("{} times, {} positions and {} forces differ in number", time.size(), position.size(),
                                reaction.size()));
  }
  if (time.size() < kMin) {
    return bad_data(fmt::format("{} samples are fewer than {}", time.size(), kMin), "record a longer stretch");
  }
  for (const auto& [name, values] :
       {std::pair<const char*, const Vector&>{"time", time}, {"position", position}, {"reaction", reaction}}) {
    if (const Index bad = first_non_finite(values); bad >= 0) {
      return bad_data(fmt::format("the {} is not a number at sample {}", name, bad + 1), "cut the recording there");
    }
  }
  for (Index i = 1; i < time.size(); ++i) {
    if (!(time[i] > time[i - 1])) {
      return bad_data(fmt::format("time does not increase at sample {}", i + 1), "correct the time, or give --rate");
    }
  }
  if (!(position.maxCoeff() > position.minCoeff())) {
    return bad_data("the position does not change", "stretch the spring while recording");
  }
  if (!(options.hac_lag_s >= 0.0 && std::isfinite(options.hac_lag_s))) {
    return bad_usage(fmt::format("the noise correlation time of {:g} s is not 0 or more", options.hac_lag_s));
  }
  if (!(options.hook_share > 0.0 && options.hook_share < 1.0)) {
    return bad_usage(fmt::format("the allowed share of the hooks, {:g}, is not between 0 and 1", options.hook_share));
  }
  return {};
}

}  // namespace

double hook_tension(const HookFit& fit, double s) {
  constexpr int kMaxSteps = 100;
  const double reach = s - fit.rest;
  if (reach <= 0.0) return reach / compliance(fit, 0.0);
  double T = 0.0;  // s(T) bends downwards, so that Newton's steps from 0 never pass the root
  for (int step = 0; step < kMaxSteps; ++step) {
    const double miss = reach - T / fit.stiffness + fit.deflection * std::expm1(-T / fit.force);
    const double move = miss / compliance(fit, T);
    T += move;
    if (std::abs(move) <= 1e-15 * std::abs(T)) break;
  }
  return T;
}

Result<SpringConstant> fit_spring_constant(const Vector& time, const Vector& position, const Vector& reaction,
                                           const StretchOptions& options) {
  MBK_TRY(check(time, position, reaction, options));
  // T = |F| on the side of the stretch: the spring pulls one way for most of it.
  const double side = reaction.mean() > 0.0 ? -1.0 : 1.0;
  Stretch stretch{side * position, -side * reaction, 0};
  const double interval = (time[time.size() - 1] - time[0]) / static_cast<double>(time.size() - 1);
  stretch.lags = std::min(static_cast<Index>(std::llround(options.hac_lag_s / interval)), time.size() / 4);
  SpringConstant constant;
  constant.hac_lag_s = static_cast<double>(stretch.lags) * interval;
  const auto whole = MBK_TRY(line_through(stretch, stretch.s.minCoeff()));
  constant.whole = whole;
  if (!(whole.stiffness > 0.0)) {
    return fail(ErrorKind::not_usable, "the force acts in the direction of the stretch, but a spring pulls back",
                "reverse the sign of the force, as in --channels x=2,F=-3");
  }
  if (!(whole.r_squared >= kMinFit)) {
    return fail(
        ErrorKind::not_usable,
        fmt::format("a line explains only {:.0f} % of the variance of the tension, but at least {:.0f} % for a spring",
                    100.0 * whole.r_squared, 100.0 * kMinFit),
        "name the channels of position and force, and stretch slowly and further");
  }
  const auto hooks = fit_hooks(stretch);
  if (!hooks || !(hooks->deflection > kSeen * hooks->deflection_error) || !(hooks->rmse < whole.rmse)) {
    constant.whole.rest *= side;
    constant.straight = constant.whole;
    constant.rule =
        fmt::format("the whole range: no yielding of hooks exceeds the noise by {:g} standard errors", kSeen);
    return constant;
  }
  constant.hooks = hooks;
  const double tension =
      hooks->force *
      std::log(std::max(1.0, hooks->deflection * hooks->stiffness / (hooks->force * options.hook_share)));
  const double from =
      hooks->rest + tension / hooks->stiffness - hooks->deflection * std::expm1(-tension / hooks->force);
  constant.rule = fmt::format("above {:.2f} N, where the hooks add less than {:g} % to the compliance", tension,
                              100.0 * options.hook_share);
  const double end = stretch.s.maxCoeff(), begin = std::max(stretch.s.minCoeff(), hooks->rest);
  if (!(end - from >= kStraightPart * (end - begin))) {
    return fail(ErrorKind::not_usable,
                fmt::format("the hooks yield up to {:.2f} N, but the stretch ends at {:.2f} N: only {:.1f} of {:.1f} "
                            "mm are straight, and a third is needed",
                            tension, constant.whole.tension_to, kMillimetres * std::max(0.0, end - from),
                            kMillimetres * (end - begin)),
                "stretch the spring further");
  }
  const auto straight = MBK_TRY(line_through(stretch, from));
  constant.straight = straight;
  for (SpringLine* line : {&constant.straight, &constant.whole}) line->rest *= side;
  constant.hooks->rest *= side;
  return constant;
}

Result<SpringConstant> spring_constant_of(const Recording& recording, const StretchOptions& options) {
  const std::string file = recording.sources.empty() ? std::string() : recording.sources.front().label();
  const Channel* const position = recording.find("position");
  const Channel* const reaction = recording.find("reaction");
  if (position == nullptr || reaction == nullptr) {
    return bad_data(fmt::format("channel {} of one axis is missing", position == nullptr ? "position" : "reaction"),
                    "name the columns, as in --channels time=1,x=2:mm,F=3", file);
  }
  if (position->unit == "rad" || reaction->unit == "N.m") {
    return bad_data("it contains an angle or a moment, but a spring needs a position and a force",
                    "state the units, as in --channels time=1,x=2:mm,F=3:N", file);
  }
  auto constant = fit_spring_constant(recording.time, position->values, reaction->values, options);
  if (!constant) return tl::unexpected(constant.error().in(file));
  constant->sources = recording.sources;
  return constant;
}

}  // namespace mbk::calibration
