#pragma once

#include <functional>
#include <vector>

#include "mbk/base/lti/polynomial.h"

namespace mbk::teleop {

using lti::Polynomial;
using lti::Rational;

/// p(x, k) = c₀(k) + c₁(k) x + … + cₙ(k) xⁿ: a polynomial of x whose coefficients are polynomials of one parameter k.
class ParametricPolynomial {
 public:
  ParametricPolynomial() = default;  ///< zero
  explicit ParametricPolynomial(std::vector<Polynomial> ascending);
  /// The same for every k.
  [[nodiscard]] static ParametricPolynomial of(const Polynomial& p);

  [[nodiscard]] int degree() const { return static_cast<int>(coefficients_.size()) - 1; }  ///< in x; −1 for zero
  [[nodiscard]] bool is_zero() const { return coefficients_.empty(); }
  [[nodiscard]] const std::vector<Polynomial>& coefficients() const { return coefficients_; }
  [[nodiscard]] const Polynomial& leading() const { return coefficients_.back(); }  ///< not of zero

  /// p(x, k) at this k, as a polynomial of x.
  [[nodiscard]] Polynomial at(const Rational& k) const;
  /// ∂p/∂x
  [[nodiscard]] ParametricPolynomial derivative() const;

  friend ParametricPolynomial operator+(const ParametricPolynomial& a, const ParametricPolynomial& b);
  friend ParametricPolynomial operator-(const ParametricPolynomial& a, const ParametricPolynomial& b);
  friend ParametricPolynomial operator*(const ParametricPolynomial& a, const ParametricPolynomial& b);
  friend bool operator==(const ParametricPolynomial&, const ParametricPolynomial&) = default;

 private:
  void trim();
  std::vector<Polynomial> coefficients_;  // the last one is not zero
};

/// The content of p, its greatest common divisor over the coefficients, and p without it, with whole coefficients.
/// p must not be zero.
struct ContentAndPart {
  Polynomial content;  ///< monic
  ParametricPolynomial part;
};
[[nodiscard]] ContentAndPart split_content(const ParametricPolynomial& p);

/// Result of eliminating x from a = 0 and b = 0 (subresultants, Brown 1978). Neither may be zero.
struct Elimination {
  ParametricPolynomial common;  ///< their greatest common divisor over the fractions of k, without content
  Polynomial resultant;         ///< of k; zero if and only if `common` depends on x. Up to its sign
};
/// @param progress  receives the completed fraction, from 0 to 1, estimated from degrees and digits
[[nodiscard]] Elimination eliminate(const ParametricPolynomial& a, const ParametricPolynomial& b,
                                    const std::function<void(double)>& progress = {});

/// Relative cost of an elimination of two polynomials of these sizes: the number of steps n and the degree D
/// of the coefficients make n steps of n − i coefficients of degree i D and with i D digits.
[[nodiscard]] double elimination_cost(const ParametricPolynomial& a, const ParametricPolynomial& b);

/// a/b. b must divide a over the fractions of k and have no content; then the quotient has no fractions (Gauss's
/// lemma).
[[nodiscard]] ParametricPolynomial quotient(const ParametricPolynomial& a, const ParametricPolynomial& b);

/// E and O of p(jω) = E(X) + jω O(X), X = ω².
struct AxisParts {
  ParametricPolynomial even, odd;
};
[[nodiscard]] AxisParts axis_parts(const ParametricPolynomial& p);

}  // namespace mbk::teleop
