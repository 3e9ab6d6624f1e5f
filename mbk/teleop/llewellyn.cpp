#include "mbk/teleop/llewellyn.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mbk/base/core/units.h"
#include "mbk/base/lti/half_planes.h"
#include "mbk/base/lti/on_axis.h"
#include "mbk/base/lti/real_roots.h"
#include "mbk/teleop/conditions.h"

namespace mbk::teleop {
namespace {

using lti::ComplexPolynomial;
using lti::Interval;
using lti::RationalFunction;
using lti::RationalMatrix;
using lti::RootBracket;

/// The four real functions of X = ω² that must not be negative.
struct Conditions {
  RationalFunction r11, r22, product, squares;
};

Conditions conditions_of(const RationalMatrix& m) {
  const ConditionsOnAxis axis = ConditionsOnAxis::of(m);
  const auto over = [](const Polynomial& n, const Polynomial& d) {
    return RationalFunction::of(n, d).value();  // d is a square, and not zero
  };
  return {over(axis.resistance[0], axis.modulus[0]), over(axis.resistance[1], axis.modulus[1]),
          over(axis.product(), axis.scale), over(axis.squares(), axis.scale * axis.scale)};
}

/// A polynomial with the sign of f where f is finite.
Polynomial with_sign_of(const RationalFunction& f) {
  const Polynomial& d = f.denominator();
  const bool positive = lti::distinct_roots(d, Interval{Rational(0), {}}) == 0;
  return positive ? f.numerator() : f.numerator() * d;
}

ViolatedBand at_pole(double omega, std::string detail) {
  return {RadPerSec(omega), RadPerSec(omega), RadPerSec(omega), 0.0, std::move(detail)};
}

constexpr std::array<std::pair<Index, Index>, 4> kEntries = {{{0, 0}, {0, 1}, {1, 0}, {1, 1}}};

std::string name_of(std::string_view form, std::pair<Index, Index> entry) {
  return fmt::format("{}{}{}", form, entry.first + 1, entry.second + 1);
}

std::vector<ViolatedBand> right_poles(const RationalMatrix& m, std::string_view form) {
  std::vector<ViolatedBand> violated;
  for (const auto& entry : kEntries) {
    const Polynomial& denominator = m(entry.first, entry.second).denominator();
    const int count = lti::count_half_planes(denominator).right;
    if (count == 0) continue;
    const auto roots = lti::complex_roots(denominator);  // the largest real part first
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      if (roots[i].imag() < 0.0) continue;
      const double imaginary = roots[i].imag();
      violated.push_back(
          at_pole(imaginary, fmt::format("{} has a pole at s = {:.6g}{}", name_of(form, entry), roots[i].real(),
                                         imaginary > 0.0 ? fmt::format(" ± {:.6g} j", imaginary) : "")));
    }
  }
  return violated;
}

/// Poles of m₁₁ and m₂₂ on the axis that no passive termination's driving point may have.
void judge_diagonal(const RationalMatrix& m, Index i, std::string_view form, std::vector<ViolatedBand>& violated) {
  const auto judged = lti::positive_real(RationalMatrix(m(i, i)));
  const auto note = [&](lti::PositiveRealCondition condition, const char* what) {
    for (const lti::FrequencyBand& where : (*judged)[condition].violated) {
      violated.push_back(at_pole(where.low.value, fmt::format("{} of {}", what, name_of(form, {i, i}))));
    }
  };
  note(lti::PositiveRealCondition::simple_poles, "a multiple pole");
  note(lti::PositiveRealCondition::residues, "a pole without a positive residue");
}

/// k₁₁ k₂₂ ≥ k₁₂ k₂₁ at every pole on the axis: m₁₁ m₂₂ − m₁₂ m₂₁ has no pole of third order there, and where it has
/// one of second order, (s − jω₀)² times it is not negative.
std::vector<ViolatedBand> joint_residues(const RationalMatrix& m) {
  const char* const detail = "k11 k22 < k12 k21";
  const RationalFunction delta = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
  std::vector<ViolatedBand> violated;
  const std::vector<Polynomial> factors = lti::square_free_factors(delta.denominator());
  for (std::size_t k = 1; k < factors.size(); ++k) {
    if (factors[k].degree() < 1) continue;
    const Polynomial axis = lti::square_free(lti::axis_roots(factors[k]));
    const ComplexPolynomial scaled =
        lti::on_axis(delta.numerator()) * lti::conjugate(lti::on_axis(delta.denominator().derivative().derivative()));
    const auto judge = [&](const RootBracket& omega) {
      if (k == 1 && lti::sign_at_root(scaled.re, axis, omega) >= 0) return;
      violated.push_back(at_pole(lti::approximate(axis, omega), detail));
    };
    if (axis.coefficient(0).is_zero()) judge({0, 0});
    for (const RootBracket& omega : lti::isolate_roots(axis, Interval{Rational(0), {}})) judge(omega);
  }
  const int order = delta.numerator().degree() - delta.denominator().degree();
  if (order > 2 || (order == 2 && delta.numerator().leading().sign() < 0)) {
    violated.push_back(at_pole(kInfinity, detail));
  }
  return violated;
}

/// The frequency in the band at which the condition is lowest, on a fine grid of it.
void find_worst(const RationalMatrix& m, StabilityCondition condition, ViolatedBand& band) {
  constexpr int kPoints = 400;
  constexpr double kReach = 100.0;  // how far beyond the other end an open band is looked at, by a factor
  const double high =
      std::isinf(band.high.value) ? kReach * std::max(band.low.value, band.worst.value) : band.high.value;
  const double low = band.low.value > 0.0 ? band.low.value : std::min(high, band.worst.value) / kReach;
  band.value = kInfinity;
  const auto look = [&](double omega) {
    const ConditionValues values = condition_values(m(RadPerSec(omega)));
    const double value = condition == StabilityCondition::resistance_1   ? values.r11
                         : condition == StabilityCondition::resistance_2 ? values.r22
                                                                         : values.third;
    if (value < band.value) {
      band.value = value;
      band.worst = RadPerSec(omega);
    }
  };
  look(band.worst.value);
  for (int i = 0; i < kPoints; ++i) look(low * std::pow(high / low, (i + 0.5) / kPoints));
}

StabilityOutcome judge_sign(const RationalMatrix& m, StabilityCondition condition, const RationalFunction& f) {
  StabilityOutcome outcome{condition, {}};
  for (const lti::PositiveInterval& piece : lti::negative_intervals(with_sign_of(f))) {
    const double low = std::sqrt(lti::to_double(piece.low.low));
    const double high = piece.high ? std::sqrt(lti::to_double(piece.high->high)) : kInfinity;
    const double inside = std::sqrt(lti::to_double(piece.witness));
    ViolatedBand band{RadPerSec(low), RadPerSec(high), RadPerSec(inside), 0.0, ""};
    find_worst(m, condition, band);
    outcome.violated.push_back(std::move(band));
  }
  return outcome;
}

}  // namespace

ConditionValues condition_values(const Eigen::MatrixXcd& immittance) {
  const double r11 = immittance(0, 0).real(), r22 = immittance(1, 1).real();
  const std::complex<double> p = immittance(0, 1) * immittance(1, 0);
  const double size = 2.0 * std::abs(r11 * r22) + std::abs(p.real()) + std::abs(p);
  return {r11, r22, (2.0 * r11 * r22 - p.real() - std::abs(p)) / size};
}

bool has_passive_poles(const RationalMatrix& m) {
  for (const auto& [i, j] : kEntries) {
    if (lti::count_half_planes(m(i, j).denominator()).right > 0) return false;
  }
  std::vector<ViolatedBand> violated = joint_residues(m);
  for (const Index i : {0, 1}) judge_diagonal(m, i, "", violated);
  return violated.empty();
}

bool is_absolutely_stable(const TwoPort& two_port) {
  if (!has_passive_poles(two_port.matrix)) return false;
  const ConditionsOnAxis axis = ConditionsOnAxis::of(two_port.matrix);
  return lti::is_nonnegative(axis.resistance[0]) && lti::is_nonnegative(axis.resistance[1]) &&
         lti::is_nonnegative(axis.product()) && lti::is_nonnegative(axis.squares());
}

AbsoluteStability llewellyn(const TwoPort& two_port) {
  using enum StabilityCondition;
  const RationalMatrix& m = two_port.matrix;
  const std::string_view form = word_of(two_port.form);
  AbsoluteStability result;
  result.form = form;

  StabilityOutcome axis{axis_poles, {}};
  for (const Index i : {0, 1}) judge_diagonal(m, i, form, axis.violated);
  const auto joint = joint_residues(m);
  axis.violated.insert(axis.violated.end(), joint.begin(), joint.end());

  const Conditions conditions = conditions_of(m);
  result.conditions = {StabilityOutcome{right_poles, teleop::right_poles(m, form)},
                       std::move(axis),
                       judge_sign(m, resistance_1, conditions.r11),
                       judge_sign(m, resistance_2, conditions.r22),
                       judge_sign(m, product, conditions.product),
                       judge_sign(m, squares, conditions.squares)};
  if (std::ranges::any_of(result.conditions, [](const auto& outcome) { return !outcome.violated.empty(); })) {
    result.verdict = StabilityVerdict::unstable;
    return result;
  }
  for (const RationalFunction* f : {&conditions.r11, &conditions.r22, &conditions.squares}) {
    if (f->is_zero()) {
      result.touches_everywhere = true;
      continue;
    }
    for (const RootBracket& X : lti::isolate_roots(f->numerator(), Interval{Rational(0), {}})) {
      result.touches.emplace_back(std::sqrt(lti::approximate(f->numerator(), X)));
    }
  }
  std::ranges::sort(result.touches);
  result.touches.erase(std::unique(result.touches.begin(), result.touches.end()), result.touches.end());
  result.verdict =
      result.touches_everywhere || !result.touches.empty() ? StabilityVerdict::marginal : StabilityVerdict::stable;
  return result;
}

}  // namespace mbk::teleop
