#pragma once

#include <array>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/teleop/architectures.h"

namespace mbk::teleop {

/// Coefficients of an entry, that of the highest power first.
struct Entry {
  std::vector<double> numerator, denominator;
};

/// Row by row.
inline TwoPort two_port(Form form, const std::array<Entry, 4>& entries) {
  TwoPort result{form, lti::RationalMatrix(2)};
  for (const Index k : {0, 1, 2, 3}) {
    const Entry& entry = entries[static_cast<std::size_t>(k)];
    const std::vector<double> n(entry.numerator.rbegin(), entry.numerator.rend());
    const std::vector<double> d(entry.denominator.rbegin(), entry.denominator.rend());
    result.matrix(k / 2, k % 2) = lti::RationalFunction::from_decimals(n, d).value();
  }
  return result;
}

/// z₁₁ = 1 − 1.01 (s/50)/(s² + s/50 + 100)
inline TwoPort narrow_resonance() {
  return two_port(Form::z, {{{{1, -0.0002, 100}, {1, 0.02, 100}}, {{0}, {1}}, {{0}, {1}}, {{1}, {1}}}});
}

inline Teleoperator position_position(const Rational& b_m, const Rational& b_s, const Rational& d_m,
                                      const Rational& k_m, const Rational& d_s, const Rational& k_s) {
  Teleoperator result;
  result.values = {{"master.m", 0},   {"slave.m", 0},    {"master.b", b_m}, {"slave.b", b_s},
                   {"master.d", d_m}, {"master.k", k_m}, {"slave.d", d_s},  {"slave.k", k_s}};
  return result;
}

inline Teleoperator position_force(const Rational& gain) {
  Teleoperator result;
  result.architecture = Architecture::position_force;
  result.values = {{"master.m", {1, 2}},
                   {"slave.m", {4, 5}},
                   {"master.b", 2},
                   {"slave.b", 3},
                   {"slave.d", 40},
                   {"slave.k", 400},
                   {"channels.force_to_master", gain}};
  return result;
}

inline Rational small(numeric::Random& random) {
  return Rational(static_cast<int>(random.below(13)) - 6, static_cast<int>(random.below(4)) + 1);
}

/// A positive semidefinite A Aᵀ.
inline std::array<Rational, 4> random_semidefinite(numeric::Random& random) {
  const Rational a = small(random), b = small(random), c = small(random), d = small(random);
  return {a * a + b * b, a * c + b * d, a * c + b * d, c * c + d * d};
}

/// M s + B + K/s + R/(s + c) with semidefinite matrices, and a lossless gyrator.
inline TwoPort random_passive(numeric::Random& random) {
  const auto M = random_semidefinite(random), B = random_semidefinite(random), K = random_semidefinite(random),
             R = random_semidefinite(random);
  const Rational gyration = small(random), pole = static_cast<int>(random.below(9)) + 1;
  TwoPort result{Form::z, lti::RationalMatrix(2)};
  for (const Index k : {0, 1, 2, 3}) {
    const auto i = static_cast<std::size_t>(k);
    const Rational turned = k == 1 ? gyration : k == 2 ? Rational(-gyration) : Rational(0);
    const lti::RationalFunction spring = lti::RationalFunction::of({K[i]}, {0, 1}).value();
    const lti::RationalFunction relaxing = lti::RationalFunction::of({R[i]}, {pole, 1}).value();
    result.matrix(k / 2, k % 2) = lti::RationalFunction({B[i] + turned, M[i]}) + spring + relaxing;
  }
  return result;
}

/// As that with something off the diagonal that may be too much.
inline TwoPort random_near_passive(numeric::Random& random) {
  TwoPort result = random_passive(random);
  const Rational pole = static_cast<int>(random.below(9)) + 1;
  result.matrix(0, 1) = result.matrix(0, 1) + lti::RationalFunction::of({60 * small(random)}, {pole, 1}).value();
  for (const Index i : {0, 1}) result.matrix(i, i) = result.matrix(i, i) + lti::RationalFunction({Rational(4)});
  return result;
}

}  // namespace mbk::teleop
