#pragma once

#include <optional>
#include <vector>

#include "mbk/base/lti/polynomial.h"

// Remainders of polynomials over the rationals are taken here with whole coefficients: no fraction is reduced on the
// way.
namespace mbk::lti {

using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<>, boost::multiprecision::et_off>;
using IntegerPolynomial = std::vector<Integer>;  // ascending, the last one not zero

/// The multiple of p by a positive number whose coefficients are whole and have no common divisor.
[[nodiscard]] IntegerPolynomial primitive(const Polynomial& p);

/// The greatest common divisor over the rationals, primitive, its leading coefficient positive: from its remainders
/// modulo primes, put together until it divides both (Brown 1971). Neither may be empty.
[[nodiscard]] IntegerPolynomial greatest_common_divisor(const IntegerPolynomial& a, const IntegerPolynomial& b);

/// a/b where b divides a with whole coefficients; nothing where it does not. b must not be empty.
[[nodiscard]] std::optional<IntegerPolynomial> exact_quotient(IntegerPolynomial a, const IntegerPolynomial& b);

[[nodiscard]] IntegerPolynomial derivative(const IntegerPolynomial& p);

/// −1, 0 or 1.
[[nodiscard]] int sign_at(const IntegerPolynomial& p, const Rational& x);

/// f₀ = a, f₁ = b, f_{k+1} = −remainder of f_{k−1} by f_k, each up to a positive factor, to the last that is not zero:
/// the greatest common divisor. The factors are those of subresultants (Brown 1978), by which the length of the
/// coefficients grows linearly. The degree of a is not lower than that of b.
[[nodiscard]] std::vector<IntegerPolynomial> signed_remainders(const Polynomial& a, const Polynomial& b);

}  // namespace mbk::lti
