#pragma once

#include <complex>
#include <vector>

#include "mbk/base/lti/polynomial.h"

namespace mbk::lti {

/// Different roots of a real polynomial by the sign of their real part.
struct HalfPlaneCount {
  int left = 0, axis = 0, right = 0;
};

/// Exact, by the Cauchy index of the parts of p(jω) = E(ω) + j O(ω), which counts left − right (Hurwitz 1895,
/// Gantmacher 1959 XV); roots on the axis are real roots of gcd(E, O). p must not be zero.
[[nodiscard]] HalfPlaneCount count_half_planes(const Polynomial& p);

/// gcd(E, O) of p(jω) = E(ω) + j O(ω): its real roots are the ω with p(jω) = 0. p must not be zero.
[[nodiscard]] Polynomial axis_roots(const Polynomial& p);

/// The different roots in double, by the eigenvalues of the companion matrix and Newton's steps; the largest real part
/// comes first. NaN where the scaled coefficients are beyond the range of a double. p must not be zero.
[[nodiscard]] std::vector<std::complex<double>> complex_roots(const Polynomial& p);

}  // namespace mbk::lti
