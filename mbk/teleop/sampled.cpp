#include "mbk/teleop/sampled.h"

#include <cmath>
#include <limits>
#include <utility>

#include "mbk/teleop/llewellyn.h"

namespace mbk::teleop {
namespace {

Rational value(const Teleoperator& teleoperator, std::string_view name) {
  const auto found = teleoperator.values.find(name);
  return found == teleoperator.values.end() ? Rational(0) : found->second;
}

StabilityOutcome on_grid(StabilityCondition condition, const std::vector<RadPerSec>& omega,
                         const std::vector<double>& values, const std::vector<double>& shown) {
  StabilityOutcome outcome{condition, {}};
  bool open = false;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const bool violated = values[i] < 0.0;
    if (violated && !open) outcome.violated.push_back({omega[i], omega[i], omega[i], shown[i], ""});
    if (violated) {
      ViolatedBand& band = outcome.violated.back();
      band.high = omega[i];
      if (shown[i] < band.value) {
        band.worst = omega[i];
        band.value = shown[i];
      }
    }
    open = violated;
  }
  return outcome;
}

}  // namespace

Result<void> check_poles(const Teleoperator& teleoperator) {
  const Rational sent =
      value(teleoperator, "channels.force_to_master") * value(teleoperator, "channels.force_to_slave");
  const Rational local =
      (1 + value(teleoperator, "master.local_force_gain")) * (1 + value(teleoperator, "slave.local_force_gain"));
  if (abs(sent) < abs(local)) return {};
  return fail(ErrorKind::not_usable, "with |C2 C3| ≥ |(1 + C5)(1 + C6)| a true delay adds infinitely many poles",
              "reduce a force gain, or write pade = 2 in [delay] to decide the Padé approximation");
}

std::vector<RadPerSec> frequencies(const FrequencyGrid& grid) {
  std::vector<RadPerSec> omega;
  for (int i = 0; i < grid.points; ++i) {
    omega.emplace_back(grid.low.value * std::pow(grid.high.value / grid.low.value, double(i) / (grid.points - 1)));
  }
  return omega;
}

Result<AbsoluteStability> llewellyn_on_grid(const Teleoperator& teleoperator, const FrequencyGrid& grid, Port port,
                                            const Rational& a, double sample_time) {
  MBK_TRY(check_poles(teleoperator));
  const auto at_once = MBK_TRY(teleoperator.without_delay().with_shortage(port, Polynomial{a}).at(0));
  const AbsoluteStability poles = llewellyn(at_once);

  const std::vector<RadPerSec> omega = frequencies(grid);
  std::vector<double> r11, r22, product, squares, third;
  for (const RadPerSec frequency : omega) {
    Eigen::Matrix2cd z = immittance(teleoperator.with_exact_delay(frequency, sample_time), Form::z);
    const Index i = port == Port::one ? 0 : 1;
    z(i, i) -= lti::to_double(a);
    const ConditionValues values = condition_values(z);
    const std::complex<double> p = z(0, 1) * z(1, 0);
    r11.push_back(values.r11);
    r22.push_back(values.r22);
    third.push_back(values.third);
    product.push_back(2.0 * values.r11 * values.r22 - p.real());
    // where the one before holds this has the sign of 2 r₁₁ r₂₂ − Re p − |p|
    squares.push_back(product.back() < 0.0 ? 0.0 : product.back() - std::abs(p));
  }
  AbsoluteStability result;
  result.form = word_of(Form::z);
  result.conditions = {poles.conditions[0],
                       poles.conditions[1],
                       on_grid(StabilityCondition::resistance_1, omega, r11, r11),
                       on_grid(StabilityCondition::resistance_2, omega, r22, r22),
                       on_grid(StabilityCondition::product, omega, product, third),
                       on_grid(StabilityCondition::squares, omega, squares, third)};
  bool holds = true;
  for (const StabilityOutcome& outcome : result.conditions) holds = holds && outcome.violated.empty();
  result.verdict = holds ? StabilityVerdict::stable : StabilityVerdict::unstable;
  return result;
}

Result<LargestShortage> largest_shortage_on_grid(const Teleoperator& teleoperator, const FrequencyGrid& grid,
                                                 Port port) {
  MBK_TRY(check_poles(teleoperator));
  LargestShortage result;
  result.port = static_cast<int>(port);
  result.at_least = std::numeric_limits<double>::infinity();
  result.exists = true;
  const Index i = port == Port::one ? 0 : 1;
  for (const RadPerSec frequency : frequencies(grid)) {
    const Eigen::Matrix2cd z = immittance(teleoperator.with_exact_delay(frequency), Form::z);
    const std::complex<double> p = z(0, 1) * z(1, 0);
    const double other = z(1 - i, 1 - i).real(), excess = p.real() + std::abs(p);
    if (other < 0.0 || (other == 0.0 && excess > 0.0)) result.exists = false;
    result.at_least = std::min(result.at_least, z(i, i).real() - (excess > 0.0 ? excess / (2.0 * other) : 0.0));
  }
  result.at_most = result.at_least;
  return result;
}

}  // namespace mbk::teleop
