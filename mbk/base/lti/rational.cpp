#include "mbk/base/lti/rational.h"

#include <cassert>
#include <utility>

#include "mbk/base/lti/half_planes.h"
#include "mbk/base/lti/on_axis.h"

namespace mbk::lti {

RationalFunction::RationalFunction(Polynomial numerator) : numerator_(std::move(numerator)) {}

RationalFunction::RationalFunction(const Polynomial& numerator, const Polynomial& denominator) {
  const Polynomial common = gcd(numerator, denominator);
  const Polynomial below = divide(denominator, common).quotient;
  numerator_ = divide(numerator, common).quotient * Polynomial{1 / below.leading()};
  denominator_ = monic(below);
}

Result<RationalFunction> RationalFunction::of(const Polynomial& numerator, const Polynomial& denominator) {
  if (denominator.is_zero()) return bad_usage("the denominator of a rational function is zero");
  return RationalFunction(numerator, denominator);
}

Result<RationalFunction> RationalFunction::from_decimals(std::span<const double> numerator,
                                                         std::span<const double> denominator) {
  const auto above = MBK_TRY(Polynomial::from_decimals(numerator));
  const auto below = MBK_TRY(Polynomial::from_decimals(denominator));
  return of(above, below);
}

std::complex<double> RationalFunction::operator()(std::complex<double> s) const {
  return evaluate(numerator_, s) / evaluate(denominator_, s);
}

RationalFunction operator+(const RationalFunction& a, const RationalFunction& b) {
  return {a.numerator_ * b.denominator_ + b.numerator_ * a.denominator_, a.denominator_ * b.denominator_};
}

RationalFunction operator-(const RationalFunction& a, const RationalFunction& b) {
  return {a.numerator_ * b.denominator_ - b.numerator_ * a.denominator_, a.denominator_ * b.denominator_};
}

RationalFunction operator*(const RationalFunction& a, const RationalFunction& b) {
  return {a.numerator_ * b.numerator_, a.denominator_ * b.denominator_};
}

RationalFunction operator/(const RationalFunction& a, const RationalFunction& b) {
  assert(!b.is_zero());
  return {a.numerator_ * b.denominator_, a.denominator_ * b.numerator_};
}

RationalMatrix RationalMatrix::scalar(Index size, const Rational& value) {
  RationalMatrix matrix(size);
  for (Index i = 0; i < size; ++i) matrix(i, i) = RationalFunction(Polynomial{value});
  return matrix;
}

Result<RationalMatrix> RationalMatrix::impedance(const Matrix& M, const Matrix& B, const Matrix& K) {
  const Index n = M.rows();
  for (const Matrix* matrix : {&M, &B, &K}) {
    if (matrix->rows() != n || matrix->cols() != n)
      return bad_usage("M, B and K are not square matrices of the same size");
  }
  RationalMatrix Z(n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const double numerator[] = {K(i, j), B(i, j), M(i, j)}, denominator[] = {0.0, 1.0};
      auto entry = MBK_TRY(RationalFunction::from_decimals(numerator, denominator));
      Z(i, j) = std::move(entry);
    }
  }
  return Z;
}

Eigen::MatrixXcd RationalMatrix::operator()(RadPerSec frequency) const {
  Eigen::MatrixXcd value(size_, size_);
  for (Index i = 0; i < size_; ++i) {
    for (Index j = 0; j < size_; ++j) value(i, j) = (*this)(i, j)({0.0, frequency.value});
  }
  return value;
}

RationalMatrix operator+(const RationalMatrix& a, const RationalMatrix& b) {
  assert(a.size_ == b.size_);
  RationalMatrix sum(a.size_);
  for (std::size_t i = 0; i < sum.entries_.size(); ++i) sum.entries_[i] = a.entries_[i] + b.entries_[i];
  return sum;
}

RationalMatrix operator-(const RationalMatrix& a, const RationalMatrix& b) {
  assert(a.size_ == b.size_);
  RationalMatrix difference(a.size_);
  for (std::size_t i = 0; i < difference.entries_.size(); ++i) difference.entries_[i] = a.entries_[i] - b.entries_[i];
  return difference;
}

RationalMatrix operator*(const RationalMatrix& a, const RationalMatrix& b) {
  assert(a.size_ == b.size_);
  RationalMatrix product(a.size_);
  for (Index i = 0; i < a.size_; ++i) {
    for (Index j = 0; j < a.size_; ++j) {
      for (Index k = 0; k < a.size_; ++k) product(i, j) = product(i, j) + a(i, k) * b(k, j);
    }
  }
  return product;
}

Result<RationalMatrix> inverse(const RationalMatrix& matrix) {
  // Gauss and Jordan: what turns a into the identity turns the identity into the inverse
  const Index n = matrix.size();
  RationalMatrix a = matrix, result = RationalMatrix::scalar(n, 1);
  for (Index k = 0; k < n; ++k) {
    Index pivot = k;
    while (pivot < n && a(pivot, k).is_zero()) ++pivot;
    if (pivot == n) {
      return fail(ErrorKind::not_usable, "the matrix has no inverse: its determinant is zero at every frequency");
    }
    for (Index j = 0; j < n; ++j) {
      std::swap(a(k, j), a(pivot, j));
      std::swap(result(k, j), result(pivot, j));
    }
    const RationalFunction head = a(k, k);
    for (Index j = 0; j < n; ++j) {
      a(k, j) = a(k, j) / head;
      result(k, j) = result(k, j) / head;
    }
    for (Index i = 0; i < n; ++i) {
      if (i == k || a(i, k).is_zero()) continue;
      const RationalFunction factor = a(i, k);
      for (Index j = 0; j < n; ++j) {
        a(i, j) = a(i, j) - factor * a(k, j);
        result(i, j) = result(i, j) - factor * result(k, j);
      }
    }
  }
  return result;
}

Polynomial common_denominator(const RationalMatrix& matrix) {
  Polynomial common{1};
  for (Index i = 0; i < matrix.size(); ++i) {
    for (Index j = 0; j < matrix.size(); ++j) {
      const Polynomial& denominator = matrix(i, j).denominator();
      common = common * divide(denominator, gcd(common, denominator)).quotient;
    }
  }
  return common;
}

std::vector<std::complex<double>> poles(const RationalMatrix& matrix) {
  return complex_roots(common_denominator(matrix));
}

}  // namespace mbk::lti
