// Errata of chapter 4 about the stability of coupled networks: theorems 4.1 and 4.2.
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <utility>

#include "mbk/base/core/units.h"
#include "mbk/teleop/architectures.h"
#include "mbk/teleop/largest_shortage.h"
#include "mbk/teleop/llewellyn.h"
#include "thesis/errata.h"

namespace mbk::thesis {
namespace {

using lti::Rational;

/// n over d of one entry, coefficients in ascending order.
lti::RationalFunction ratio(const lti::Polynomial& numerator, const lti::Polynomial& denominator) {
  return lti::RationalFunction::of(numerator, denominator).value_or(lti::RationalFunction());
}

teleop::TwoPort resistive(teleop::Form form, const std::array<Rational, 4>& entries) {
  teleop::TwoPort two_port{form, lti::RationalMatrix(2)};
  for (Index k = 0; k < 4; ++k) {
    two_port.matrix(k / 2, k % 2) = lti::RationalFunction(lti::Polynomial{entries[static_cast<std::size_t>(k)]});
  }
  return two_port;
}

/// Condition 3 as printed on a grid of the axis: the least of each.
teleop::ConditionValues min_on_a_grid(const teleop::TwoPort& two_port) {
  teleop::ConditionValues least{kInfinity, kInfinity, kInfinity};
  for (int i = 0; i <= 200; ++i) {
    const Eigen::MatrixXcd z = two_port.matrix(RadPerSec(1e-3 * std::pow(1e6, i / 200.0)));
    const double r11 = z(0, 0).real(), r22 = z(1, 1).real();
    const std::complex<double> p = z(0, 1) * z(1, 0);
    least = {std::min(least.r11, r11), std::min(least.r22, r22),
             std::min(least.third, 2.0 * r11 * r22 - p.real() - std::abs(p))};
  }
  return least;
}

std::string violated_text(const AbsoluteStability& stability) {
  std::string text;
  for (const StabilityOutcome& outcome : stability.conditions) {
    if (!outcome.violated.empty()) text += fmt::format("{}{}", text.empty() ? "" : "; ", mbk::text(outcome.condition));
  }
  return text.empty() ? "none" : text;
}

}  // namespace

Result<void> any_immittance(Workbench& /*bench*/, Draft& exhibit) {
  exhibit.commands = {"mbk teleop examples/teleop/position_position.toml      # the largest shortage it allows"};
  exhibit.related = {"erratum-17", "question-4", "erratum-5"};
  const Rational a = 1;
  const teleop::TwoPort z =
      resistive(teleop::Form::z, {Rational(1, 5), Rational(1, 10), Rational(1, 10), Rational(1, 5)});
  const auto y = teleop::convert(z, teleop::Form::y);
  const auto right = teleop::with_shortage(z, teleop::Port::two, a);
  if (!y) return tl::unexpected(y.error());
  if (!right) return tl::unexpected(right.error());
  teleop::TwoPort printed = *y;
  printed.matrix(1, 1) = printed.matrix(1, 1) - lti::RationalFunction(lti::Polynomial{a});
  ReproducedTable table = computed_table(
      "erratum-11", "form",
      {{"r₁₁", "", 2}, {"r₂₂ − a", "", 2}, {"third condition, scaled", "", 2}, {"criterion says", "", 0}});
  for (const auto& [name, network] : std::array<std::pair<const char*, const teleop::TwoPort*>, 2>{
           {{"y₂₂ − a, as the theorem allows", &printed}, {"z₂₂ − a", &*right}}}) {
    const teleop::ConditionValues values = teleop::condition_values(network->matrix(RadPerSec(1.0)));
    table.rows.push_back({name,
                          {cell(values.r11), cell(values.r22), cell(values.third),
                           words(teleop::is_absolutely_stable(*network) ? "stable" : "not stable")}});
  }
  ReproducedTable bound = computed_table("erratum-11 bound", "a",
                                         {{"Re z", "N·s/m", 2}, {"Re 1/z", "m/(N·s)", 2}, {"−a holds for 1/z", "", 0}});
  for (const double value : {0.1, 0.5, 2.0}) {
    bound.rows.push_back(
        {fmt::format("{:g}", value), {cell(-value), cell(-1.0 / value), words(yes(-1.0 / value >= -value))}});
  }
  teleop::Teleoperator teleoperator;
  const int b_m = 2, b_s = 3, d_m = 10, d_s = 20;
  teleoperator.values = {{"master.m", 0},   {"slave.m", 0},    {"master.b", b_m}, {"slave.b", b_s},
                         {"master.d", d_m}, {"master.k", 100}, {"slave.d", d_s},  {"slave.k", 200}};
  const LargestShortage largest = teleop::largest_shortage(teleoperator.equations(), teleop::Port::two);
  ReproducedTable allowed = computed_table(
      "erratum-11 allowed", "", {{"bisection between exact decisions", "N·s/m", 4}, {"closed form", "N·s/m", 4}});
  allowed.rows.push_back({"b_m = 2, b_s = 3, d_m = 10, d_s = 20 N·s/m",
                          {cell(largest.value()), cell(b_s + static_cast<double>(d_s * b_m) / (b_m + d_m))}});
  exhibit.tables = {std::move(table), std::move(bound), std::move(allowed)};
  return {};
}

Result<void> unnamed_poles(Workbench& /*bench*/, Draft& exhibit) {
  exhibit.commands = {"mbk teleop examples/teleop/narrow_resonance.toml      # each condition, decided exactly"};
  exhibit.related = {"erratum-11", "erratum-3"};
  using lti::Polynomial;
  const Polynomial one{1}, s{0, 1};
  teleop::TwoPort mass{teleop::Form::z, lti::RationalMatrix(2)}, right = mass, spring = mass;
  mass.matrix(0, 0) = lti::RationalFunction(Polynomial{0, -1});
  mass.matrix(1, 1) = lti::RationalFunction(one);
  right.matrix(0, 0) = right.matrix(1, 1) = lti::RationalFunction(Polynomial{5});
  right.matrix(0, 1) = ratio(one, Polynomial{-1, 1});
  right.matrix(1, 0) = lti::RationalFunction(Polynomial{Rational(1, 10)});
  spring.matrix(0, 0) = spring.matrix(1, 1) = ratio(one, s);
  spring.matrix(0, 1) = spring.matrix(1, 0) = ratio(Polynomial{2}, s);
  ReproducedTable table = computed_table("erratum-17", "z",
                                         {{"least r₁₁", "", 3},
                                          {"least r₂₂", "", 3},
                                          {"least third condition", "", 3},
                                          {"absolutely stable", "", 0},
                                          {"what fails", "", 0}});
  for (const auto& [name, network] : {std::pair{"[[−s, 0], [0, 1]]", &mass},
                                      {"[[5, 1/(s − 1)], [0.1, 5]]", &right},
                                      {"[[1, 2], [2, 1]]/s", &spring}}) {
    const teleop::ConditionValues least = min_on_a_grid(*network);
    const AbsoluteStability stability = teleop::llewellyn(*network);
    table.rows.push_back({name,
                          {cell(least.r11), cell(least.r22), cell(least.third), words(yes(stability.holds())),
                           words(violated_text(stability))}});
  }
  exhibit.tables = {std::move(table)};
  return {};
}

}  // namespace mbk::thesis
