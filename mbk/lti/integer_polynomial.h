#pragma once

#include <vector>

#include "mbk/lti/polynomial.h"

// Remainders of polynomials over the rationals are taken here with whole coefficients, divided by what they have in
// common after each step: their length then grows linearly along a sequence of remainders, and no fraction is reduced.
namespace mbk::lti {

using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<>, boost::multiprecision::et_off>;
using IntegerPolynomial = std::vector<Integer>;  // ascending, the last one not zero

/// The multiple of p by a positive number whose coefficients are whole and have no common divisor.
[[nodiscard]] IntegerPolynomial primitive(const Polynomial& p);

/// A positive multiple of the remainder of a divided by b, primitive.
[[nodiscard]] IntegerPolynomial primitive_remainder(IntegerPolynomial a, const IntegerPolynomial& b);

/// −1, 0 or 1.
[[nodiscard]] int sign_at(const IntegerPolynomial& p, const Rational& x);

/// f₀ = a, f₁ = b, f_{k+1} = −remainder of f_{k−1} by f_k, each up to a positive factor, to the last that is not zero:
/// the greatest common divisor.
[[nodiscard]] std::vector<IntegerPolynomial> signed_remainders(const Polynomial& a, const Polynomial& b);

}  // namespace mbk::lti
