#pragma once

#include <vector>

#include "mbk/base/lti/polynomial.h"
#include "mbk/base/numeric/random.h"

namespace mbk::lti {

/// A fraction from −10 to 10 with a denominator up to 12.
inline Rational random_rational(numeric::Random& random) {
  const auto denominator = static_cast<int>(random.below(12)) + 1;
  return Rational(static_cast<int>(random.below(20 * static_cast<unsigned>(denominator) + 1)) - 10 * denominator,
                  denominator);
}

/// Exactly of this degree.
inline Polynomial random_polynomial(numeric::Random& random, int degree) {
  std::vector<Rational> coefficients;
  for (int i = 0; i < degree; ++i) coefficients.push_back(random_rational(random));
  coefficients.emplace_back(static_cast<int>(random.below(9)) + 1);
  return Polynomial(coefficients);
}

/// Monic.
inline Polynomial with_roots(const std::vector<Rational>& roots) {
  Polynomial p{1};
  for (const Rational& root : roots) p = p * Polynomial{-root, 1};
  return p;
}

}  // namespace mbk::lti
