#include "mbk/base/lti/hermitian.h"

#include <utility>

namespace mbk::lti {
namespace {

/// The determinant of the rows and columns that are listed, along the first row.
ComplexPolynomial determinant(const ComplexPolynomialMatrix& A, const std::vector<Index>& rows,
                              const std::vector<Index>& columns) {
  if (rows.empty()) return {Polynomial{1}, {}};
  const std::vector<Index> below(rows.begin() + 1, rows.end());
  ComplexPolynomial sum;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    std::vector<Index> others = columns;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const ComplexPolynomial term = A(rows.front(), columns[k]) * determinant(A, below, others);
    sum = k % 2 == 0 ? sum + term : sum - term;
  }
  return sum;
}

/// p without its common factors with `positive`, which has no real root: its sign stays.
Polynomial without_factors(Polynomial p, const Polynomial& positive) {
  if (p.is_zero()) return p;
  for (;;) {
    const Polynomial common = gcd(p, positive);
    if (common.degree() <= 0) return p;
    p = divide(p, common).quotient;
  }
}

}  // namespace

ComplexPolynomialMatrix operator*(const ComplexPolynomialMatrix& a, const ComplexPolynomialMatrix& b) {
  ComplexPolynomialMatrix product(a.size_);
  for (Index i = 0; i < a.size_; ++i) {
    for (Index j = 0; j < a.size_; ++j) {
      for (Index k = 0; k < a.size_; ++k) product(i, j) = product(i, j) + a(i, k) * b(k, j);
    }
  }
  return product;
}

ComplexPolynomialMatrix numerators_on_axis(const RationalMatrix& Z, const Polynomial& denominator) {
  ComplexPolynomialMatrix N(Z.size());
  for (Index i = 0; i < Z.size(); ++i) {
    for (Index j = 0; j < Z.size(); ++j) {
      N(i, j) = on_axis(Z(i, j).numerator() * divide(denominator, Z(i, j).denominator()).quotient);
    }
  }
  return N;
}

ComplexPolynomialMatrix adjoint(const ComplexPolynomialMatrix& A) {
  ComplexPolynomialMatrix result(A.size());
  for (Index i = 0; i < A.size(); ++i) {
    for (Index j = 0; j < A.size(); ++j) result(i, j) = conjugate(A(j, i));
  }
  return result;
}

Polynomial squared_modulus(const Polynomial& d) {
  const ComplexPolynomial value = on_axis(d);
  return value.re * value.re + value.im * value.im;
}

ComplexPolynomialMatrix scaled_hermitian_part(const RationalMatrix& Z, const Polynomial& denominator) {
  const ComplexPolynomialMatrix N = numerators_on_axis(Z, denominator);
  const ComplexPolynomial d = on_axis(denominator);
  ComplexPolynomialMatrix A(Z.size());
  for (Index i = 0; i < Z.size(); ++i) {
    for (Index j = 0; j < Z.size(); ++j) A(i, j) = N(i, j) * conjugate(d) + conjugate(N(j, i)) * d;
  }
  return A;
}

std::vector<ComplexPolynomial> principal_minors(const ComplexPolynomialMatrix& A) {
  std::vector<ComplexPolynomial> minors;
  for (unsigned subset = 1; subset < 1u << static_cast<unsigned>(A.size()); ++subset) {
    std::vector<Index> kept;
    for (Index i = 0; i < A.size(); ++i) {
      if ((subset >> static_cast<unsigned>(i)) & 1u) kept.push_back(i);
    }
    minors.push_back(determinant(A, kept, kept));
  }
  return minors;
}

std::vector<PositiveInterval> indefinite_intervals(const ComplexPolynomialMatrix& A, const Polynomial& denominator) {
  // |d(jω)|² without its real roots, which are those of what Re d and Im d share
  const ComplexPolynomial d = on_axis(denominator);
  const Polynomial shared = gcd(d.re, d.im);
  const Polynomial re = divide(d.re, shared).quotient, im = divide(d.im, shared).quotient;
  const Polynomial positive = in_square(re * re + im * im);
  std::vector<Polynomial> minors;
  for (const ComplexPolynomial& minor : principal_minors(A)) {
    minors.push_back(without_factors(in_square(minor.re), positive));
  }
  return negative_intervals(minors);
}

}  // namespace mbk::lti
