#pragma once

#include <array>

#include "mbk/teleop/two_port.h"

namespace mbk::teleop {

/// Llewellyn's conditions for an immittance m on s = jω, as polynomials of X = ω² > 0 with integer coefficients.
/// `modulus`, `share` and `scale` are squares, which vanish only at poles on the axis, so that signs are those of
/// numerators.
struct ConditionsOnAxis {
  std::array<Polynomial, 2> resistance, modulus;  ///< Re m_ii = resistance/modulus
  Polynomial share;                               ///< Re m₁₁ Re m₂₂ = resistance₁ resistance₂ share/scale
  Polynomial p_re, p_im;                          ///< m₁₂ m₂₁ = (p_re + jω p_im)/scale
  Polynomial scale;

  [[nodiscard]] static ConditionsOnAxis of(const lti::RationalMatrix& m);

  /// Of m with Re m_ii − a. @param i  0 or 1
  [[nodiscard]] ConditionsOnAxis with_shortage(std::size_t i, const Rational& a) const;

  [[nodiscard]] Polynomial resistances() const;  ///< r₁₁ r₂₂ scale
  [[nodiscard]] Polynomial product() const;      ///< (2 r₁₁ r₂₂ − Re p) scale
  [[nodiscard]] Polynomial squares() const;  ///< (4 r₁₁ r₂₂ (r₁₁ r₂₂ − Re p) − (Im p)²) scale²
};

}  // namespace mbk::teleop
