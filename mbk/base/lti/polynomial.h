#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <initializer_list>
#include <span>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::lti {

/// An exact fraction of integers of any length.
using Rational =
    boost::multiprecision::number<boost::multiprecision::cpp_rational_backend, boost::multiprecision::et_off>;

/// The fraction that is written as the shortest decimal which reads back as `value`: 0.1 is 1/10.
/// @fails  data: `value` is not finite.
[[nodiscard]] Result<Rational> exact(double value);

/// The double nearest to `value`.
[[nodiscard]] double to_double(const Rational& value);

/// The fraction with the smallest denominator in [low, high] (Stern 1858, Brocot 1861).
[[nodiscard]] Rational simplest_between(const Rational& low, const Rational& high);

/// p(x) = c₀ + c₁ x + … + cₙ xⁿ, exactly. Coefficients are in ascending order everywhere.
class Polynomial {
 public:
  Polynomial() = default;  ///< zero
  Polynomial(std::initializer_list<Rational> ascending);
  explicit Polynomial(std::vector<Rational> ascending);

  /// Each coefficient as its shortest decimal, see exact().
  /// @fails  data: a coefficient is not finite.
  [[nodiscard]] static Result<Polynomial> from_decimals(std::span<const double> ascending);

  [[nodiscard]] int degree() const { return static_cast<int>(coefficients_.size()) - 1; }  ///< −1 for zero
  [[nodiscard]] bool is_zero() const { return coefficients_.empty(); }
  [[nodiscard]] const std::vector<Rational>& coefficients() const { return coefficients_; }  ///< degree() + 1 of them
  [[nodiscard]] Rational coefficient(int power) const;                                       ///< zero beyond the degree
  [[nodiscard]] const Rational& leading() const { return coefficients_.back(); }             ///< not of zero

  [[nodiscard]] Rational operator()(const Rational& x) const;
  [[nodiscard]] Polynomial derivative() const;

  Polynomial& operator+=(const Polynomial& other);
  Polynomial& operator-=(const Polynomial& other);
  friend Polynomial operator+(Polynomial a, const Polynomial& b) { return a += b; }
  friend Polynomial operator-(Polynomial a, const Polynomial& b) { return a -= b; }
  friend Polynomial operator-(const Polynomial& a) { return Polynomial() - a; }
  friend Polynomial operator*(const Polynomial& a, const Polynomial& b);
  friend bool operator==(const Polynomial&, const Polynomial&) = default;

 private:
  void trim();
  std::vector<Rational> coefficients_;  // the last one is not zero
};

/// a = quotient·b + remainder, the remainder of lower degree than b.
struct Division {
  Polynomial quotient, remainder;
};

/// b must not be zero.
[[nodiscard]] Division divide(const Polynomial& a, const Polynomial& b);

/// With leading coefficient 1; the zero polynomial stays.
[[nodiscard]] Polynomial monic(const Polynomial& p);

/// Greatest common divisor, monic; zero for two zeros.
[[nodiscard]] Polynomial gcd(const Polynomial& a, const Polynomial& b);

/// The monic polynomial that has each root of p once: p/gcd(p, p′). p must not be zero.
[[nodiscard]] Polynomial square_free(const Polynomial& p);

/// f₁, f₂, … monic, square-free and without common roots, with p = c f₁ f₂² f₃³ … (Yun 1976). p must not be zero.
[[nodiscard]] std::vector<Polynomial> square_free_factors(const Polynomial& p);

}  // namespace mbk::lti
