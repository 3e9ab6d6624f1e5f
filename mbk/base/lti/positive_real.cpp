#include "mbk/base/lti/positive_real.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mbk/base/core/units.h"
#include "mbk/base/lti/half_planes.h"
#include "mbk/base/lti/hermitian.h"

namespace mbk::lti {
namespace {

using enum PositiveRealCondition;

FrequencyBand single(double omega) {
  return {RadPerSec(omega), RadPerSec(omega), RadPerSec(omega)};
}

/// A is Hermitian and ⪰ 0 at the point where `sign` gives the sign of a polynomial.
template <class Sign>
bool is_positive_semidefinite(const ComplexPolynomialMatrix& A, const Sign& sign) {
  for (Index i = 0; i < A.size(); ++i) {
    for (Index j = 0; j <= i; ++j) {
      const ComplexPolynomial skew = A(i, j) - conjugate(A(j, i));
      if (sign(skew.re) != 0 || sign(skew.im) != 0) return false;
    }
  }
  const auto minors = principal_minors(A);
  return std::none_of(minors.begin(), minors.end(), [&](const auto& minor) { return sign(minor.re) < 0; });
}

bool is_positive_semidefinite(const ComplexPolynomialMatrix& constant) {
  return is_positive_semidefinite(constant, [](const Polynomial& p) { return p.coefficient(0).sign(); });
}

/// lim Z/s as s → ∞, where no entry grows faster than s.
ComplexPolynomialMatrix residue_at_infinity(const RationalMatrix& Z) {
  ComplexPolynomialMatrix residue(Z.size());
  for (Index i = 0; i < Z.size(); ++i) {
    for (Index j = 0; j < Z.size(); ++j) {
      residue(i, j).re = Polynomial{Z(i, j).numerator().coefficient(Z(i, j).denominator().degree() + 1)};
    }
  }
  return residue;
}

/// A positive multiple of the residue at a simple pole jω of Z = N/d: N(jω) d′(jω)*, to be taken at that ω.
ComplexPolynomialMatrix residue_on_axis(const RationalMatrix& Z, const Polynomial& denominator) {
  ComplexPolynomialMatrix residue = numerators_on_axis(Z, denominator);
  const ComplexPolynomial slope = conjugate(on_axis(denominator.derivative()));
  for (Index i = 0; i < Z.size(); ++i) {
    for (Index j = 0; j < Z.size(); ++j) residue(i, j) = residue(i, j) * slope;
  }
  return residue;
}

int order_at_infinity(const RationalMatrix& Z) {
  int order = 0;
  for (Index i = 0; i < Z.size(); ++i) {
    for (Index j = 0; j < Z.size(); ++j) {
      order = std::max(order, Z(i, j).numerator().degree() - Z(i, j).denominator().degree());
    }
  }
  return order;
}

std::vector<FrequencyBand> right_poles(const Polynomial& denominator) {
  std::vector<FrequencyBand> violated;
  const auto count = static_cast<std::size_t>(count_half_planes(denominator).right);
  if (count == 0) return violated;
  const auto roots = complex_roots(denominator);  // the largest real part first
  for (std::size_t i = 0; i < count; ++i) {
    if (roots[i].imag() >= 0.0) violated.push_back(single(roots[i].imag()));
  }
  // the count is exact, the places are not
  if (violated.empty()) violated.push_back({RadPerSec(0.0), RadPerSec(kInfinity), RadPerSec(0.0)});
  return violated;
}

/// Poles on the axis: those that are not simple, and those whose residue is not as it must be.
std::pair<std::vector<FrequencyBand>, std::vector<FrequencyBand>> axis_poles(const RationalMatrix& Z,
                                                                             const Polynomial& denominator) {
  std::pair<std::vector<FrequencyBand>, std::vector<FrequencyBand>> violated;
  auto& [multiple, residues] = violated;
  const Polynomial repeated = axis_roots(gcd(denominator, denominator.derivative()));
  const Polynomial axis = square_free(axis_roots(denominator));
  const ComplexPolynomialMatrix residue = residue_on_axis(Z, denominator);
  const auto judge = [&](const RootBracket& omega) {
    const auto sign = [&](const Polynomial& p) { return sign_at_root(p, axis, omega); };
    const FrequencyBand where = single(approximate(axis, omega));
    if (sign(repeated) == 0) {
      multiple.push_back(where);
    } else if (!is_positive_semidefinite(residue, sign)) {
      residues.push_back(where);
    }
  };
  if (denominator.coefficient(0).is_zero()) judge({0, 0});
  for (const RootBracket& omega : isolate_roots(axis, {Rational(0), {}})) judge(omega);

  const int order = order_at_infinity(Z);
  if (order > 1) multiple.push_back(single(kInfinity));
  if (order == 1 && !is_positive_semidefinite(residue_at_infinity(Z))) residues.push_back(single(kInfinity));
  return violated;
}

FrequencyBand band(const PositiveInterval& squared) {
  return {RadPerSec(std::sqrt(to_double(squared.low.low))),
          RadPerSec(squared.high ? std::sqrt(to_double(squared.high->high)) : kInfinity),
          RadPerSec(std::sqrt(to_double(squared.witness)))};
}

std::string statement(PositiveRealCondition condition) {
  switch (condition) {
    case no_right_poles:
      return "no pole with a positive real part";
    case simple_poles:
      return "poles on the imaginary axis, including 0 and infinity, are simple";
    case residues:
      return "residues of poles on the imaginary axis are Hermitian and positive semidefinite";
    case hermitian_part:
      return "Z(jω) + Z(jω)* is positive semidefinite";
  }
  return "";
}

}  // namespace

std::string ConditionOutcome::line() const {
  std::string text = statement(condition) + ": ";
  if (holds()) return text + "holds";
  text += "violated";
  const char* before = " ";
  for (const FrequencyBand& where : violated) {
    text += before;
    text += where.low == where.high ? fmt::format("at {:.6g}", where.low.value)
                                    : fmt::format("from {:.6g} to {:.6g}", where.low.value, where.high.value);
    before = ", ";
  }
  return text + " rad/s";
}

bool PositiveRealness::holds() const {
  return std::all_of(conditions.begin(), conditions.end(), [](const auto& outcome) { return outcome.holds(); });
}

Result<PositiveRealness> positive_real(const RationalMatrix& Z) {
  if (Z.size() < 1 || Z.size() > kMaxPorts) {
    return bad_usage(fmt::format("the matrix has {} rows, but must have 1 to {}", Z.size(), kMaxPorts));
  }
  const Polynomial denominator = common_denominator(Z);
  auto [multiple, wrong_residues] = axis_poles(Z, denominator);
  std::vector<FrequencyBand> indefinite;
  for (const PositiveInterval& piece : indefinite_intervals(scaled_hermitian_part(Z, denominator), denominator)) {
    indefinite.push_back(band(piece));
  }
  PositiveRealness result;
  result.conditions = {
      ConditionOutcome{no_right_poles, right_poles(denominator)}, ConditionOutcome{simple_poles, std::move(multiple)},
      ConditionOutcome{residues, std::move(wrong_residues)}, ConditionOutcome{hermitian_part, std::move(indefinite)}};
  return result;
}

}  // namespace mbk::lti
