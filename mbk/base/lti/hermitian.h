#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/lti/on_axis.h"
#include "mbk/base/lti/rational.h"
#include "mbk/base/lti/real_roots.h"

namespace mbk::lti {

/// A square matrix of complex polynomials of the real variable ω.
class ComplexPolynomialMatrix {
 public:
  explicit ComplexPolynomialMatrix(Index size) : size_(size), entries_(static_cast<std::size_t>(size * size)) {}

  [[nodiscard]] Index size() const { return size_; }
  [[nodiscard]] ComplexPolynomial& operator()(Index row, Index column) { return entries_[at(row, column)]; }
  [[nodiscard]] const ComplexPolynomial& operator()(Index row, Index column) const { return entries_[at(row, column)]; }

  friend ComplexPolynomialMatrix operator*(const ComplexPolynomialMatrix& a, const ComplexPolynomialMatrix& b);

 private:
  [[nodiscard]] std::size_t at(Index row, Index column) const { return static_cast<std::size_t>(row * size_ + column); }
  Index size_;
  std::vector<ComplexPolynomial> entries_;  // row by row
};

/// N(jω) of Z = N/d.   @param denominator  d(s), a multiple of every denominator
[[nodiscard]] ComplexPolynomialMatrix numerators_on_axis(const RationalMatrix& Z, const Polynomial& denominator);

/// The conjugate transpose.
[[nodiscard]] ComplexPolynomialMatrix adjoint(const ComplexPolynomialMatrix& A);

/// |d(jω)|² as a polynomial in ω.
[[nodiscard]] Polynomial squared_modulus(const Polynomial& d);

/// N(jω) d(jω)* + N(jω)* d(jω): the Hermitian matrix Z(jω) + Z(jω)* times |d(jω)|².
[[nodiscard]] ComplexPolynomialMatrix scaled_hermitian_part(const RationalMatrix& Z, const Polynomial& denominator);

/// Every principal minor, 2ⁿ − 1 of them. A Hermitian matrix is ⪰ 0 if and only if none of them is negative.
[[nodiscard]] std::vector<ComplexPolynomial> principal_minors(const ComplexPolynomialMatrix& A);

/// {ω > 0: A(ω) is not ⪰ 0}, in X = ω². A is Hermitian with A(−ω) = A(ω)ᵀ. `denominator` is a d(s) in whose powers A
/// was made polynomial: what minors share with |d(jω)|² is taken out of them.
[[nodiscard]] std::vector<PositiveInterval> indefinite_intervals(const ComplexPolynomialMatrix& A,
                                                                 const Polynomial& denominator);

}  // namespace mbk::lti
