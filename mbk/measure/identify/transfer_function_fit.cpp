#include "mbk/measure/identify/transfer_function_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include "mbk/base/core/nan.h"
#include "mbk/base/dsp/autoregression.h"
#include "mbk/base/dsp/difference_equation.h"
#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/numeric/golden_section.h"
#include "mbk/base/numeric/polynomial_roots.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/identify/explained_by_past.h"
#include "mbk/measure/identify/input_hold.h"
#include "mbk/measure/identify/prediction_error.h"
#include "mbk/measure/identify/srivc.h"

namespace mbk::identify {
namespace {

/// As the samples of an even clock are that many samples later; before the record its first value.
Vector whole_samples_later(const Vector& signal, Index samples) {
  const Index late = std::min(samples, signal.size());
  Vector values(signal.size());
  values.head(late).setConstant(signal[0]);
  values.tail(signal.size() - late) = signal.head(signal.size() - late);
  return values;
}

/// As it was `delay` before each of these times, by straight lines; before the record its first value.
Vector along_straight_lines(const Vector& signal, const Vector& recorded, const Vector& times, double delay) {
  Vector values(times.size());
  Index left = 0;
  constexpr double kRounding = 1e-9;  // of an interval
  for (Index i = 0; i < times.size(); ++i) {
    const double t = times[i] - delay;
    while (left + 1 < recorded.size() - 1 && recorded[left + 1] <= t) ++left;
    double weight = std::clamp((t - recorded[left]) / (recorded[left + 1] - recorded[left]), 0.0, 1.0);
    if (weight < kRounding || weight > 1.0 - kRounding) weight = std::round(weight);
    values[i] = (1.0 - weight) * signal[left] + weight * signal[left + 1];
  }
  return values;
}

/// The samples that count, with the input as it was `delay` before. One that is held jumps within the interval then:
/// the sample before holds for the part of one by which the delay is more than whole samples.
SignalPair delayed(const SignalPair& pair, double delay, InputHold hold) {
  const Index n = pair.samples();
  SignalPair shifted = pair;
  shifted.first = 0;
  shifted.time = pair.time.tail(n);
  shifted.output = pair.output.tail(n);
  const bool held = hold == InputHold::zero;
  Index late = 0;
  if (held) shifted.held = 1.0;
  if (held && delay > 0.0) {
    constexpr double kRounding = 1e-9;
    const double samples = delay / *pair.step, part = samples - std::floor(samples + kRounding);
    late = static_cast<Index>(std::ceil(samples - kRounding));
    if (part > kRounding) shifted.held = part;
  }
  const auto moved = [&](const Vector& signal) -> Vector {
    if (signal.size() == 0) return signal;
    if (delay == 0.0) return signal.tail(n);
    if (held) return whole_samples_later(signal, late).tail(n);
    return along_straight_lines(signal, pair.time, shifted.time, delay);
  };
  shifted.input = moved(pair.input);
  shifted.reference = moved(pair.reference);
  return shifted;
}

std::vector<SignalPair> delayed(const std::vector<SignalPair>& pairs, double delay, InputHold hold) {
  std::vector<SignalPair> all;
  for (const SignalPair& pair : pairs) all.push_back(delayed(pair, delay, hold));
  return all;
}

/// P(χ² > q) by the cube root of Wilson & Hilferty (1931).
double chi_squared_beyond(double q, double degrees_of_freedom) {
  const double spread = 2.0 / (9.0 * degrees_of_freedom);
  return numeric::normal_probability(-(std::cbrt(q / degrees_of_freedom) - (1.0 - spread)) / std::sqrt(spread));
}

/// Of a signal, in all experiments together; empty where they are too short.
dsp::Spectrum spectrum_of(const std::vector<SignalPair>& pairs, Vector SignalPair::*signal, Hertz rate) {
  Index longest = 0, total = 0;
  for (const SignalPair& pair : pairs) {
    longest = std::max(longest, pair.samples());
    total += pair.samples();
  }
  constexpr double kSegments = 8.0, kOfOne = 2.0;
  const Hertz resolution(rate.value * std::max(kSegments / static_cast<double>(total),
                                               pairs.size() > 1 ? kOfOne / static_cast<double>(longest) : 0.0));
  dsp::Spectrum sum;
  for (const SignalPair& pair : pairs) {
    if (2 * pair.samples() < longest) continue;
    const auto one = dsp::welch((pair.*signal).tail(pair.samples()), rate, resolution);
    if (!one) continue;
    if (sum.density.size() == 0) {
      sum = {one->frequency, Vector::Zero(one->density.size())};
    }
    if (one->density.size() == sum.density.size()) sum.density += static_cast<double>(pair.samples()) * one->density;
  }
  return sum;
}

/// Below which that share of the power lies; 0 where there is none.
Hertz power_below(const dsp::Spectrum& spectrum, Hertz rate, double share) {
  if (!(spectrum.density.size() > 0 && spectrum.density.sum() > 0.0)) return Hertz(0.0);
  return dsp::power_quantile(spectrum, share, Hertz(0.5 * rate.value));
}

/// What every method gives.
struct Fit {
  Vector denominator, numerator;  ///< as in TransferFunction, without the 1
  bool converged = false;
  Matrix covariance, white_covariance;  ///< of [denominator; numerator]
  std::optional<double> delay_variance;
  double delay_correction = 0;
  double variance = 0, fit = 0;
  Vector noise_denominator, noise_numerator;
  std::vector<Vector> residuals, innovations;
  std::vector<SearchStart> starts;
  Index samples = 0;
};

Fit fit_of(ContinuousFit&& made) {
  Fit fit{.denominator = std::move(made.a),
          .numerator = std::move(made.b),
          .converged = made.converged,
          .covariance = std::move(made.covariance),
          .white_covariance = std::move(made.white_covariance),
          .delay_variance = made.delay_variance,
          .delay_correction = made.delay_correction,
          .variance = made.variance,
          .fit = made.fit,
          .noise_denominator = std::move(made.noise),
          .noise_numerator = Vector::Ones(1),
          .residuals = std::move(made.residuals),
          .starts = std::move(made.starts),
          .samples = made.samples};
  const Index order = fit.noise_denominator.size() - 1;
  for (const Vector& e : fit.residuals) {
    const Vector innovation = dsp::difference_equation(fit.noise_denominator, Vector::Ones(1), e);
    fit.innovations.push_back(innovation.tail(e.size() - order));
  }
  return fit;
}

Fit fit_of(PredictionErrorFit&& made) {
  return {.denominator = std::move(made.f),
          .numerator = std::move(made.b),
          .converged = made.converged,
          .covariance = std::move(made.covariance),
          .white_covariance = std::move(made.white_covariance),
          .variance = made.variance,
          .fit = made.fit,
          .noise_denominator = std::move(made.noise_denominator),
          .noise_numerator = std::move(made.noise_numerator),
          .residuals = std::move(made.residuals),
          .innovations = std::move(made.innovations),
          .starts = std::move(made.starts),
          .samples = made.samples};
}

class Identifier {
 public:
  Identifier(const std::vector<SignalPair>& experiments, const std::vector<SignalPair>& held_out,
             const TransferFunctionOptions& options)
      : experiments_(experiments),
        held_out_(held_out),
        options_(options),
        delay_(options.delay),
        hold_(discrete() ? InputHold::first : options.hold.value_or(input_hold(experiments))) {}

  Result<TransferFunctionIdentification> run();

 private:
  [[nodiscard]] bool discrete() const { return is_discrete(options_.method); }
  [[nodiscard]] ContinuousFitOptions continuous_options(Index poles, Index zeros) const;
  [[nodiscard]] PredictionErrorOptions discrete_options(Index poles, Index zeros) const;
  [[nodiscard]] Result<Fit> fit(Index poles, Index zeros, double delay) const;
  Result<Fit> choose_delay(Index poles, Index zeros);
  Result<Fit> sharpened(Index poles, Index zeros, double delay);
  [[nodiscard]] OrderChoice criteria(const Fit& fit, Index poles, Index zeros) const;
  Result<Fit> choose_order();
  [[nodiscard]] tl::unexpected<Error> nothing_settled(const std::vector<SearchStart>& starts,
                                                      const std::string& model) const;
  void describe(const Fit& fit);
  void describe_roots(const Fit& fit);
  void test(const Fit& fit);
  [[nodiscard]] Vector simulation_error(const SignalPair& pair) const;
  [[nodiscard]] Result<void> check_clock() const;
  [[nodiscard]] Result<void> check_hold() const;
  void simulate(const Fit& fit);
  void warn();
  [[nodiscard]] double median_step() const;
  [[nodiscard]] Index delay_grid(Index samples) const;
  [[nodiscard]] bool delay_at_limit() const;

  const std::vector<SignalPair>& experiments_;
  const std::vector<SignalPair>& held_out_;
  const TransferFunctionOptions& options_;
  double delay_;
  InputHold hold_;
  TransferFunctionIdentification found_;
};

double Identifier::median_step() const {
  std::vector<double> steps;
  for (const SignalPair& pair : experiments_) {
    for (Index i = 1; i < pair.time.size(); ++i) steps.push_back(pair.time[i] - pair.time[i - 1]);
  }
  return numeric::upper_median(std::move(steps));
}

/// Whether the search would have gone on to longer delays.
bool Identifier::delay_at_limit() const {
  constexpr double kNear = 0.05;  // of a sample
  const double step = median_step();
  const double longest = discrete() ? step * std::floor(options_.max_delay / step + 1e-9) : options_.max_delay;
  return options_.find_delay && delay_ >= longest - kNear * step;
}

ContinuousFitOptions Identifier::continuous_options(Index poles, Index zeros) const {
  ContinuousFitOptions options;
  options.poles = poles;
  options.zeros = zeros;
  options.start_poles = options_.start_poles;
  options.free_start = options_.free_start;
  options.hac_lag_s = options_.hac_lag_s;
  options.threads = options_.threads;
  options.delay_found = options_.find_delay;
  options.reference_instruments = options_.method == TransferFunctionMethod::closed_loop;
  options.max_noise_order = options_.method == TransferFunctionMethod::rivc ? options_.max_noise_order : 0;
  return options;
}

PredictionErrorOptions Identifier::discrete_options(Index poles, Index zeros) const {
  PredictionErrorOptions options;
  options.poles = poles;
  options.zeros = zeros;
  options.start_poles = options_.start_poles;
  options.free_start = options_.free_start;
  options.noise_model = options_.method == TransferFunctionMethod::box_jenkins;
  options.max_noise_order = options_.max_noise_order;
  options.hac_lag_s = options_.hac_lag_s;
  options.threads = options_.threads;
  return options;
}

Result<Fit> Identifier::fit(Index poles, Index zeros, double delay) const {
  const std::vector<SignalPair> moved = delayed(experiments_, delay, hold_);
  const auto made = [](auto&& result) -> Result<Fit> {
    if (!result) return tl::unexpected(result.error());
    return fit_of(std::move(*result));
  };
  if (discrete()) return made(fit_prediction_error(moved, discrete_options(poles, zeros)));
  return made(fit_continuous(moved, continuous_options(poles, zeros)));
}

/// By how many samples the delays are apart that are tried first: the output tells those from each other that are a
/// part of the period of its fastest motion apart.
Index Identifier::delay_grid(Index samples) const {
  constexpr Index kMin = 25, kMax = 125;  // delays that are tried
  constexpr double kShare = 0.95, kParts = 8.0;
  const auto within = [&](Index count) { return std::max<Index>(1, (samples + count - 1) / count); };
  const Hertz rate(1.0 / median_step());
  const Hertz top = power_below(spectrum_of(experiments_, &SignalPair::output, rate), rate, kShare);
  if (!(top.value > 0.0)) return within(kMax);
  return std::clamp(static_cast<Index>(rate.value / (kParts * top.value)), within(kMax), within(kMin));
}

Result<Fit> Identifier::choose_delay(Index poles, Index zeros) {
  const double step = median_step();
  if (!options_.find_delay) return fit(poles, zeros, delay_);
  const auto left = [](const Result<Fit>& made) {
    return made->converged ? made->variance : std::numeric_limits<double>::infinity();
  };
  const auto samples = static_cast<Index>(std::floor(options_.max_delay / step + 1e-9));
  const Index every = discrete() ? 1 : delay_grid(samples);
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  const auto look = [&](double delay) -> Result<double> {
    const auto made = fit(poles, zeros, delay);
    if (!made) return tl::unexpected(made.error());
    const double variance = left(made);
    if (variance < least) {
      least = variance;
      best = delay;
    }
    return variance;
  };
  for (Index k = 0; k <= samples; k += every) {
    MBK_TRY(look(static_cast<double>(k) * step));
  }
  if (discrete()) {
    delay_ = best;
    return fit(poles, zeros, delay_);
  }
  constexpr double kNear = 0.01;  // of a sample
  const double whole = best, reach = static_cast<double>(every) * step;
  std::optional<Error> failure;
  numeric::golden_section(
      std::max(whole - reach, 0.0), std::min(whole + reach, options_.max_delay),
      [&](double delay) {
        const auto variance = look(delay);
        if (!variance && !failure) failure = variance.error();
        return variance.value_or(std::numeric_limits<double>::infinity());
      },
      std::less<>{}, [&](double low, double high) { return !failure && high - low > kNear * step; });
  if (failure) return tl::unexpected(*failure);
  return sharpened(poles, zeros, best);
}

/// Gauss–Newton steps of the delay alone, all other coefficients at their best, until it is a small part of its
/// standard error off; a step that does not leave less is not taken.
Result<Fit> Identifier::sharpened(Index poles, Index zeros, double delay) {
  constexpr int kMax = 6;
  constexpr double kSmall = 0.02;
  delay_ = delay;
  auto best = fit(poles, zeros, delay_);
  for (int k = 0; k < kMax && best && best->converged && best->delay_variance; ++k) {
    if (std::abs(best->delay_correction) <= kSmall * std::sqrt(*best->delay_variance)) break;
    const double next = std::clamp(delay_ + best->delay_correction, 0.0, options_.max_delay);
    auto made = fit(poles, zeros, next);
    if (!made || !made->converged || !(made->variance < best->variance)) break;
    best = std::move(made);
    delay_ = next;
  }
  return best;
}

OrderChoice Identifier::criteria(const Fit& fit, Index poles, Index zeros) const {
  OrderChoice choice{.poles = poles, .zeros = zeros, .usable = fit.converged, .fit = fit.fit};
  choice.yic = choice.aic = choice.bic = kNaN;
  if (!std::isfinite(fit.variance) || fit.denominator.size() == 0) return choice;
  Vector theta(fit.denominator.size() + fit.numerator.size());
  theta << fit.denominator, fit.numerator;
  double squares = 0.0, output = 0.0;
  for (const Vector& e : fit.residuals) squares += e.squaredNorm();
  for (const SignalPair& pair : experiments_) {
    const auto y = pair.output.tail(pair.samples());
    output += (y.array() - y.mean()).square().sum();
  }
  const auto count = static_cast<double>(fit.samples);
  const auto parameters = static_cast<double>(theta.size());
  const double spread =
      (fit.white_covariance.diagonal().array() / theta.array().square()).sum() / parameters;  // σ² p_jj/θ_j²
  choice.yic = std::log(squares / output) + std::log(spread);
  choice.aic = count * std::log(fit.variance) + 2.0 * parameters;
  choice.bic = count * std::log(fit.variance) + parameters * std::log(count);
  return choice;
}

/// Where most starts end on unstable models, the system itself may be one, held by a loop. That loop is stable.
tl::unexpected<Error> Identifier::nothing_settled(const std::vector<SearchStart>& starts,
                                                  const std::string& model) const {
  std::vector<double> growth;
  for (const SearchStart& start : starts) {
    if (!start.stable && start.growth > 0.0) growth.push_back(start.growth);
  }
  const auto unstable = std::ranges::count(starts, false, &SearchStart::stable);
  const std::string none = fmt::format("no stable model with {} was found: ", model);
  std::string text =
      none + (unstable == std::ssize(starts)
                  ? fmt::format("all {} starts converged to an unstable model", unstable)
                  : fmt::format("of {} starts, {} converged to an unstable model and {} did not converge",
                                starts.size(), unstable, std::ssize(starts) - unstable));
  const char* const otherwise =
      "use fewer poles, swap input and output, or give a start near the slowest pole with --start-pole";
  if (2 * unstable < std::ssize(starts)) return fail(ErrorKind::not_usable, text, otherwise);
  constexpr double kAgree = 1.5;
  if (!growth.empty() && std::ranges::max(growth) <= kAgree * std::ranges::min(growth)) {
    text += fmt::format(" (the unstable response grows e-fold in {:.2g} s)",
                        1.0 / numeric::upper_median(std::move(growth)));
  }
  const bool loop = options_.method == TransferFunctionMethod::closed_loop;
  return fail(ErrorKind::not_usable, text,
              fmt::format("if the system is unstable without its control loop, identify the closed loop, which is "
                          "stable: --input {0} --output OUTPUT and --input {0} --output INPUT; the system is the "
                          "first over the second; otherwise {1}{2}",
                          loop ? "REFERENCE" : "WHAT-DRIVES-THE-LOOP",
                          loop ? "" : "use --method clsrivc in a closed loop, ", otherwise));
}

Result<Fit> Identifier::choose_order() {
  std::vector<std::pair<Index, Index>> orders = options_.orders;
  const bool several = !orders.empty();
  if (!several) orders.emplace_back(options_.poles, options_.zeros);
  std::vector<Fit> fits;
  std::vector<double> delays;
  for (const auto& [poles, zeros] : orders) {
    auto made = MBK_TRY(choose_delay(poles, zeros));
    found_.orders.push_back(criteria(made, poles, zeros));
    fits.push_back(std::move(made));
    delays.push_back(delay_);
  }
  double least = std::numeric_limits<double>::infinity();
  for (const OrderChoice& one : found_.orders) {
    if (one.usable) least = std::min(least, 1.0 - one.fit);
  }
  constexpr double kMore = 1.02, kRounding = 1e-12;
  std::size_t chosen = fits.size();
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const OrderChoice& one = found_.orders[k];
    if (!one.usable || 1.0 - one.fit > kMore * least + kRounding) continue;
    if (chosen == fits.size() || one.yic < found_.orders[chosen].yic) chosen = k;
  }
  if (chosen == fits.size()) {
    return nothing_settled(
        fits.back().starts,
        several ? "these orders"
                : fmt::format("{} pole{} and {} zero{}", orders.front().first, orders.front().first == 1 ? "" : "s",
                              orders.front().second, orders.front().second == 1 ? "" : "s"));
  }
  found_.orders[chosen].chosen = true;
  delay_ = delays[chosen];
  return std::move(fits[chosen]);
}

void Identifier::describe(const Fit& fit) {
  found_.method = options_.method;
  found_.model.numerator = fit.numerator;
  found_.model.denominator.resize(fit.denominator.size() + 1);
  if (discrete()) {
    found_.model.denominator << 1.0, fit.denominator;
    found_.model.sample_time = median_step();
  } else {
    found_.model.denominator << fit.denominator, 1.0;
  }
  found_.model.delay = delay_;
  if (options_.find_delay) found_.max_delay = options_.max_delay;
  found_.delay_found = options_.find_delay && !delay_at_limit();
  if (fit.delay_variance && found_.delay_found)
    found_.delay_standard_error = std::sqrt(std::max(*fit.delay_variance, 0.0));
  if (!discrete()) found_.hold = hold_;
  found_.hold_found = !discrete() && !options_.hold;
  found_.covariance = fit.covariance;
  found_.hac_lag_s = options_.hac_lag_s;
  found_.fit = fit.fit;
  found_.noise_standard_deviation = std::sqrt(fit.variance);
  if (fit.noise_denominator.size() > 1) found_.noise_denominator = fit.noise_denominator;
  if (fit.noise_numerator.size() > 1) found_.noise_numerator = fit.noise_numerator;
  const OrderChoice& chosen = *std::ranges::find(found_.orders, true, &OrderChoice::chosen);
  found_.yic = chosen.yic;
  found_.aic = chosen.aic;
  found_.bic = chosen.bic;
  if (found_.orders.size() == 1) found_.orders.clear();
  found_.starts = fit.starts;
  found_.samples = fit.samples;
  found_.experiments = std::ssize(experiments_);
  found_.even = std::ranges::all_of(experiments_, [](const SignalPair& pair) { return pair.step.has_value(); });
  found_.sample_time = median_step();
  describe_roots(fit);
  if (!found_.even) return;
  // Where 96 % of the input's power lies: beyond it, what is said rests on the form of the model.
  constexpr double kBelow = 0.02;
  const Hertz rate(1.0 / found_.sample_time);
  const dsp::Spectrum input = spectrum_of(experiments_, &SignalPair::input, rate);
  found_.band_low = power_below(input, rate, kBelow).value;
  found_.band_high = power_below(input, rate, 1.0 - kBelow).value;
  if (!(found_.band_high > 0.0)) return;
  for (auto* roots : {&found_.poles, &found_.zeros}) {
    for (Root& root : *roots) root.outside_band = root.frequency > found_.band_high;
  }
}

void Identifier::describe_roots(const Fit& fit) {
  const Vector &below = fit.denominator, &above = fit.numerator;
  const Index n = below.size(), q = above.size();
  const Matrix of_below = fit.covariance.topLeftCorner(n, n), of_above = fit.covariance.bottomRightCorner(q, q);
  Vector gradient(n + q);
  if (discrete()) {
    const double T = found_.model.sample_time, sum = 1.0 + below.sum();
    found_.poles = roots_with_intervals(found_.model.denominator.reverse(), of_below.reverse(), T);
    found_.zeros = roots_with_intervals(above.reverse(), of_above.reverse(), T);
    found_.gain = above.sum() / sum;
    gradient << Vector::Constant(n, -found_.gain / sum), Vector::Constant(q, 1.0 / sum);
  } else {
    found_.poles = roots_with_intervals(found_.model.denominator, of_below);
    found_.zeros = roots_with_intervals(above, of_above);
    found_.gain = above[0] / below[0];
    gradient << -found_.gain / below[0] * Vector::Unit(n, 0), Vector::Unit(q, 0) / below[0];
  }
  found_.gain_standard_error = std::sqrt(std::max(0.0, gradient.dot(fit.covariance * gradient)));
}

void Identifier::test(const Fit& fit) {
  std::vector<Vector> inputs;
  const std::vector<SignalPair> moved = delayed(experiments_, delay_, hold_);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    // In a loop the noise is in the input; what the reference makes of it is free of that.
    const bool loop = options_.method == TransferFunctionMethod::closed_loop;
    const Vector input = loop ? explained_by_past(moved[k].reference, moved[k].input) : moved[k].input;
    inputs.emplace_back(input.tail(fit.innovations[k].size()).array() - input.mean());
  }
  double slowest = 0.0;  // [s]
  for (const Root& pole : found_.poles) slowest = std::max(slowest, 1.0 / std::abs(pole.value.real()));
  constexpr double kMinLags = 25, kMaxLags = 400;
  const double most = static_cast<double>(std::ranges::min(inputs, {}, &Vector::size).size()) / 5.0;
  const double lags = std::min(std::clamp(3.0 * slowest / found_.sample_time, kMinLags, kMaxLags), most);
  found_.residuals = test_residuals(fit.innovations, inputs, std::max<Index>(1, static_cast<Index>(lags)));
  if (found_.residuals.independent()) return;
  found_.delay_found = false;  // the best of those that were tried is not good
  found_.delay_standard_error.reset();
}

/// Less what the best initial state and offset explain.
Vector Identifier::simulation_error(const SignalPair& pair) const {
  const TransferFunction& model = found_.model;
  const Index n = model.poles();
  if (discrete()) {
    const Vector response = dsp::difference_equation(model.numerator, model.denominator, pair.input);
    return without_discrete_free_motion(model.denominator.tail(n), pair.output - response);
  }
  const Vector a = model.denominator.head(n);
  return without_free_motion(a, pair, pair.output - simulate_continuous(a, model.numerator, pair));
}

void Identifier::simulate(const Fit& fit) {
  if (held_out_.empty()) {
    for (std::size_t k = 0; k < experiments_.size(); ++k) {
      const SignalPair& pair = experiments_[k];
      const Vector output = pair.output.tail(pair.samples());
      found_.simulated.push_back({pair.time.tail(pair.samples()), output, output - fit.residuals[k]});
    }
    return;
  }
  double squares = 0.0, output = 0.0;
  Index count = 0;
  for (const SignalPair& pair : delayed(held_out_, delay_, hold_)) {
    const Vector left = simulation_error(pair);
    squares += left.squaredNorm();
    found_.simulated.push_back({pair.time, pair.output, pair.output - left});
    output += (pair.output.array() - pair.output.mean()).square().sum();
    count += pair.output.size();
  }
  found_.held_out_fit = 1.0 - squares / output;
  found_.held_out_rmse = std::sqrt(squares / static_cast<double>(count));
}

void Identifier::warn() {
  auto& warnings = found_.warnings;
  const std::string delay = options_.find_delay ? "a longer delay (--max-delay)" : "a delay (--delay auto)";
  const bool in_loop = options_.method == TransferFunctionMethod::closed_loop;
  const std::string hold =
      discrete()
          ? ""
          : fmt::format(", or --hold {}", word_of(hold_ == InputHold::zero ? InputHold::first : InputHold::zero));
  const bool some_unstable = !std::ranges::all_of(found_.starts, &SearchStart::stable);
  const std::string loop =
      some_unstable
          ? "; if the system is unstable without its control loop, use the signal that drives the loop as --input"
          : "";
  constexpr double kPoor = 0.8;
  if (found_.held_out_fit && *found_.held_out_fit < kPoor) {
    warnings.push_back(
        {WarningCode::held_out_fit_poor,
         fmt::format("only {:.1f} % of the held-out output is explained", 100.0 * *found_.held_out_fit),
         fmt::format("use more poles (--orders), {}, or check whether the system changes{}", delay, loop)});
  } else if (found_.fit < kPoor) {
    warnings.push_back({WarningCode::fit_poor,
                        fmt::format("only {:.1f} % of the output is explained", 100.0 * found_.fit),
                        fmt::format("use more poles (--orders) and {}; the remainder may be noise{}", delay, loop)});
  }
  if (held_out_.empty()) {
    warnings.push_back({WarningCode::no_held_out_data, "no data were held out, so the fit is in sample",
                        "hold data out with --split or --held-out"});
  }
  if (!found_.residuals.white() && options_.hac_lag_s == 0.0) {
    warnings.push_back({WarningCode::residual_not_white,
                        "the residual is not white noise, but the intervals assume that it is, so they are too narrow",
                        "use --hac-lag 1, or model the noise with --method rivc"});
  }
  if (!found_.residuals.independent()) {
    warnings.push_back({WarningCode::input_explains_residual,
                        "the input still explains part of the residual, so the model is incomplete",
                        fmt::format("use more poles or zeros (--orders), {}{}{}", delay, hold,
                                    in_loop ? "" : "; in a closed loop, --method clsrivc")});
  }
  if (options_.find_delay && !found_.delay_found) {
    warnings.push_back(
        {WarningCode::delay_at_limit,
         delay_at_limit()
             ? fmt::format("the longest delay that was tried, {:.4g} s, fits best: the true one may be longer", delay_)
             : fmt::format("no delay up to {:.4g} s fits: with the best, {:.4g} s, the input still explains part of "
                           "the residual; the true delay may be longer",
                           options_.max_delay, delay_),
         fmt::format("search up to --max-delay {:.2g}, or set the delay with --delay", 2.0 * options_.max_delay)});
  }
  std::string outside;
  double highest = 0.0;
  for (const Root& pole : found_.poles) {
    if (!pole.outside_band) continue;
    outside += fmt::format("{}{:.4g} Hz", outside.empty() ? "" : ", ", pole.frequency);
    highest = std::max(highest, pole.frequency);
  }
  constexpr double kMax = 0.98;
  const Hertz rate(1.0 / found_.sample_time);
  const bool held_out_excites_them =
      !held_out_.empty() && !outside.empty() &&
      power_below(spectrum_of(held_out_, &SignalPair::input, rate), rate, kMax).value > highest;
  if (!outside.empty()) {
    warnings.push_back(
        {WarningCode::pole_outside_band,
         fmt::format(
             "poles at {} lie above {:.4g} Hz, below which 98 % of the power of the input lies: they are extrapolated",
             outside, found_.band_high),
         held_out_excites_them ? "omit --split: the held-out data excite the system there"
                               : "excite the system there, or do not use them"});
  }
  if (!found_.even) {
    warnings.push_back({WarningCode::uneven_clock,
                        "the samples are unevenly spaced; the model accounts for this, but the residual tests do not",
                        "interpret the residual tests with care: they count samples, not seconds"});
  }
}

/// In discrete time the delay must be a whole number of samples.
Result<void> Identifier::check_clock() const {
  if (!discrete()) return {};
  const auto step = MBK_TRY(common_step(experiments_, held_out_));
  const double samples = delay_ / step;
  constexpr double kWhole = 1e-3;
  if (options_.find_delay || std::abs(samples - std::round(samples)) <= kWhole) return {};
  return bad_usage(fmt::format("a delay of {:g} s is not a whole number of samples of {:.6g} ms", delay_, 1e3 * step),
                   fmt::format("give {:.6g} or {:.6g} s, or use --method srivc", std::floor(samples) * step,
                               std::ceil(samples) * step));
}

/// A step of a held input has no defined time between unevenly spaced samples.
Result<void> Identifier::check_hold() const {
  if (discrete() && options_.hold) {
    return bad_usage("a discrete-time model needs no assumption about the input between samples",
                     "omit --hold, or use --method srivc");
  }
  const bool even = std::ranges::all_of(experiments_, [](const SignalPair& pair) { return pair.step.has_value(); });
  const bool is_delayed = options_.find_delay || delay_ > 0.0;
  if (hold_ == InputHold::first || !is_delayed || even) return {};
  return bad_usage("a delay with a zero-order hold needs uniform sampling",
                   "use --hold first, or resample with --resample");
}

Result<TransferFunctionIdentification> Identifier::run() {
  if (!(options_.delay >= 0.0) || !std::isfinite(options_.delay)) {
    return bad_usage(fmt::format("a delay of {} s is not possible", options_.delay), "give 0 or more seconds");
  }
  MBK_TRY(check_clock());
  MBK_TRY(check_hold());
  auto fit = MBK_TRY(choose_order());
  describe(fit);
  test(fit);
  simulate(fit);
  warn();
  return std::move(found_);
}

}  // namespace

std::vector<Root> roots_with_intervals(const Vector& ascending, const Matrix& covariance, double sample_time) {
  std::vector<Root> all;
  const bool discrete = sample_time > 0.0;
  const Index degree = ascending.size() - 1, known = covariance.rows();
  Vector derivative(std::max<Index>(degree, 1));
  derivative.setZero();
  for (Index k = 1; k <= degree; ++k) derivative[k - 1] = static_cast<double>(k) * ascending[k];
  for (const std::complex<double>& r : numeric::polynomial_roots(ascending)) {
    if (r.imag() < 0.0 || (discrete && r == 0.0)) continue;  // 0 only delays
    const std::complex<double> p = discrete ? std::log(r) / sample_time : r;
    Root root{.value = p, .frequency = std::abs(p) / (2.0 * std::numbers::pi), .pair = r.imag() > 0.0};
    root.damping = -p.real() / std::abs(p);
    const std::complex<double> slope = numeric::polynomial_at(derivative, r) * (discrete ? sample_time * r : 1.0);
    Vector modulus(known), damping(known);
    std::complex<double> power = 1.0;
    for (Index k = 0; k < known; ++k, power *= r) {
      const std::complex<double> dp = -power / slope;
      modulus[k] = (std::conj(p) * dp).real() / std::abs(p);
      damping[k] = -(dp.real() + root.damping * modulus[k]) / std::abs(p);
    }
    root.frequency_standard_error =
        std::sqrt(std::max(0.0, modulus.dot(covariance * modulus))) / (2.0 * std::numbers::pi);
    if (root.pair) root.damping_standard_error = std::sqrt(std::max(0.0, damping.dot(covariance * damping)));
    all.push_back(root);
  }
  if (discrete) std::ranges::stable_sort(all, {}, &Root::frequency);
  return all;
}

namespace {

/// Σ u[t − k] e[t] for k = 0 … lags over the standard deviation that it has without a relation. Both pass first what
/// makes e white (its autoregressive model): then that is σ_e √Σu², whatever the colour of u (Box & Jenkins 1970,
/// §11.1).
Vector cross_correlation(const std::vector<Vector>& residuals, const std::vector<Vector>& inputs, Index lags) {
  constexpr Index kAutoregressionOrder = 50, kSamplesEach = 20;
  const Index shortest = std::ranges::min(residuals, {}, &Vector::size).size();
  const Vector whitening = dsp::autoregression(residuals, std::min(kAutoregressionOrder, shortest / kSamplesEach));
  const Index order = whitening.size() - 1;
  Vector cross = Vector::Zero(lags + 1);
  double of_residual = 0.0, of_input = 0.0, samples = 0.0;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    const Index n = residuals[k].size() - order;
    const auto whitened = [&](const Vector& signal) -> Vector {
      return dsp::difference_equation(whitening, Vector::Ones(1), signal).tail(n);
    };
    const Vector e = whitened(residuals[k]), u = whitened(inputs[k]);
    for (Index lag = 0; lag <= std::min(lags, n - 1); ++lag) cross[lag] += u.head(n - lag).dot(e.tail(n - lag));
    of_residual += e.squaredNorm();
    of_input += u.squaredNorm();
    samples += static_cast<double>(n);
  }
  return cross / std::sqrt(std::max(of_residual * of_input / samples, std::numeric_limits<double>::min()));
}

}  // namespace

ResidualTests test_residuals(const std::vector<Vector>& residuals, const std::vector<Vector>& inputs, Index lags) {
  ResidualTests tests;
  tests.lags = lags;
  Vector own = Vector::Zero(lags + 1), pairs = own;
  for (const Vector& e : residuals) {
    const Index n = e.size();
    for (Index lag = 0; lag <= std::min(lags, n - 1); ++lag) {
      own[lag] += e.head(n - lag).dot(e.tail(n - lag));
      pairs[lag] += static_cast<double>(n - lag);
    }
  }
  const double n = pairs[0];
  const double limit = numeric::kNormal99;
  double sum = 0.0;
  Index outside = 0;
  for (Index lag = 1; lag <= lags; ++lag) {
    const double r = own[lag] / own[0];
    sum += r * r / std::max(pairs[lag], 1.0);
    outside += std::abs(r) * std::sqrt(n) > limit ? 1 : 0;
  }
  tests.autocorrelation_outside = static_cast<double>(outside) / static_cast<double>(lags);
  tests.whiteness_p = chi_squared_beyond(n * (n + 2.0) * sum, static_cast<double>(lags));
  const Vector cross = cross_correlation(residuals, inputs, lags);
  outside = 0;
  double largest = 0.0;
  for (Index lag = 0; lag <= lags; ++lag) {
    const double z = std::abs(cross[lag]);
    outside += z > limit ? 1 : 0;
    largest = std::max(largest, z);
  }
  tests.cross_correlation_outside = static_cast<double>(outside) / static_cast<double>(lags + 1);
  tests.cross_p = std::min(1.0, 2.0 * static_cast<double>(lags + 1) * numeric::normal_probability(-largest));
  return tests;
}

Result<TransferFunctionIdentification> identify_transfer_function(const std::vector<SignalPair>& experiments,
                                                                  const std::vector<SignalPair>& held_out,
                                                                  const TransferFunctionOptions& options) {
  return Identifier(experiments, held_out, options).run();
}

}  // namespace mbk::identify
