#pragma once

#include <complex>
#include <span>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/lti/polynomial.h"

namespace mbk::lti {

/// n(s)/d(s), exactly, in lowest terms with d monic; so equal functions compare equal.
class RationalFunction {
 public:
  RationalFunction() = default;                     ///< zero
  explicit RationalFunction(Polynomial numerator);  ///< over 1

  /// @fails  usage: the denominator is zero.
  [[nodiscard]] static Result<RationalFunction> of(const Polynomial& numerator, const Polynomial& denominator);

  /// Coefficients in ascending order of s, each as its shortest decimal.
  /// @fails  data: one is not finite. usage: the denominator is zero.
  [[nodiscard]] static Result<RationalFunction> from_decimals(std::span<const double> numerator,
                                                              std::span<const double> denominator);

  [[nodiscard]] const Polynomial& numerator() const { return numerator_; }
  [[nodiscard]] const Polynomial& denominator() const { return denominator_; }
  [[nodiscard]] bool is_zero() const { return numerator_.is_zero(); }
  [[nodiscard]] bool is_proper() const { return numerator_.degree() <= denominator_.degree(); }

  /// Value at s in double; not finite at a pole.
  [[nodiscard]] std::complex<double> operator()(std::complex<double> s) const;

  friend RationalFunction operator+(const RationalFunction& a, const RationalFunction& b);
  friend RationalFunction operator-(const RationalFunction& a, const RationalFunction& b);
  friend RationalFunction operator*(const RationalFunction& a, const RationalFunction& b);
  friend RationalFunction operator/(const RationalFunction& a, const RationalFunction& b);  ///< b must not be zero
  friend bool operator==(const RationalFunction&, const RationalFunction&) = default;

 private:
  RationalFunction(const Polynomial& numerator, const Polynomial& denominator);
  Polynomial numerator_, denominator_{1};
};

/// A square matrix of rational functions of s: an impedance, an admittance, a two-port.
class RationalMatrix {
 public:
  explicit RationalMatrix(Index size) : size_(size), entries_(static_cast<std::size_t>(size * size)) {}  ///< zeros
  explicit RationalMatrix(RationalFunction entry) : size_(1), entries_{std::move(entry)} {}

  /// value·I
  [[nodiscard]] static RationalMatrix scalar(Index size, const Rational& value);

  /// Z(s) = M s + B + K/s, entries as their shortest decimals.   @param M, B, K  n×n
  /// @fails  usage: shapes differ. data: an entry is not finite.
  [[nodiscard]] static Result<RationalMatrix> impedance(const Matrix& M, const Matrix& B, const Matrix& K);

  [[nodiscard]] Index size() const { return size_; }
  [[nodiscard]] RationalFunction& operator()(Index row, Index column) { return entries_[at(row, column)]; }
  [[nodiscard]] const RationalFunction& operator()(Index row, Index column) const { return entries_[at(row, column)]; }

  /// Value at s = jω in double; not finite at a pole.
  [[nodiscard]] Eigen::MatrixXcd operator()(RadPerSec frequency) const;

  // both of one size
  friend RationalMatrix operator+(const RationalMatrix& a, const RationalMatrix& b);
  friend RationalMatrix operator-(const RationalMatrix& a, const RationalMatrix& b);
  friend RationalMatrix operator*(const RationalMatrix& a, const RationalMatrix& b);
  friend bool operator==(const RationalMatrix&, const RationalMatrix&) = default;

 private:
  [[nodiscard]] std::size_t at(Index row, Index column) const { return static_cast<std::size_t>(row * size_ + column); }
  Index size_;
  std::vector<RationalFunction> entries_;  // row by row
};

/// @fails  not usable: the determinant is zero for every s.
[[nodiscard]] Result<RationalMatrix> inverse(const RationalMatrix& matrix);

/// The monic polynomial of lowest degree that is a multiple of every denominator. Its roots are the finite poles, each
/// as often as the highest order that it has in an entry.
[[nodiscard]] Polynomial common_denominator(const RationalMatrix& matrix);

/// The different finite poles in double, the largest real part first.
[[nodiscard]] std::vector<std::complex<double>> poles(const RationalMatrix& matrix);

}  // namespace mbk::lti
