#pragma once

#include <array>
#include <complex>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/base/lti/rational.h"
#include "mbk/teleop/parametric.h"

namespace mbk::teleop {

/// The immittance matrices of a two-port with efforts V₁, V₂ (the forces that the terminations exert on it) and flows
/// I₁, I₂ (the velocities of its ports, positive with those forces):
///   z: [V₁ V₂] = z [I₁ I₂]   y: [I₁ I₂] = y [V₁ V₂]   h: [V₁ I₂] = h [I₁ V₂]   g: [I₁ V₂] = g [V₁ I₂]
/// Teleoperation often writes h with −v_s for I₂ and the force on the environment for V₂: both signs turn, h₁₂ and h₂₁
/// change theirs, and h₁₂ h₂₁ stays.
enum class Form { z, y, h, g };

inline constexpr std::array<Form, 4> kForms = {Form::z, Form::h, Form::g, Form::y};

[[nodiscard]] constexpr auto word_table(Form) {
  using enum Form;
  return std::to_array<Word<Form>>({{z, "z"}, {y, "y"}, {h, "h"}, {g, "g"}});
}

/// A linear two-port, exactly.
struct TwoPort {
  Form form = Form::z;
  lti::RationalMatrix matrix = lti::RationalMatrix(2);
};

/// The same network in another form.
/// @fails  not usable: it has none, because the determinant that would have to be inverted is zero for every s.
[[nodiscard]] Result<TwoPort> convert(const TwoPort& two_port, Form form);

enum class Port { one = 1, two = 2 };

/// The other port's view: ports 1 and 2 exchanged, in the form with that meaning (h becomes g).
[[nodiscard]] TwoPort exchanged(const TwoPort& two_port);

/// The same network as z or, where that does not exist, as h (port 1) or g (port 2).
/// @fails  not usable: it has neither; then no series impedance at that port changes anything.
[[nodiscard]] Result<TwoPort> as_impedance_at(const TwoPort& two_port, Port port);

/// The network with −a put in series with the port, z_ii − a: absolutely stable if and only if the network itself is
/// stable with any termination of Re z ≥ −a at that port and a passive one at the other (Dyck 2013, theorem 4.2).
/// @param a  shortage of passivity of the termination [N·s/m]; negative for an excess
/// @fails  not usable: the network has no form in which that port stands as an impedance.
[[nodiscard]] Result<TwoPort> with_shortage(const TwoPort& two_port, Port port, const Rational& a);

/// A two-port as two equations between its variables, polynomial in s and in one parameter k:
///   row [V₁ V₂ I₁ I₂]ᵀ = 0
/// It has every form that exists, even where one of them does not.
struct PortEquations {
  std::array<std::array<ParametricPolynomial, 4>, 2> rows;

  /// The equations of `two_port`, the same for every k.
  [[nodiscard]] static PortEquations of(const TwoPort& two_port);

  /// As the function above, with a polynomial of k for a. Every network has this.
  [[nodiscard]] PortEquations with_shortage(Port port, const Polynomial& a) const;

  /// The network at this k, in the first of z, h, g, y that exists.
  /// @fails  not usable: the equations depend on each other, so that no form exists.
  [[nodiscard]] Result<TwoPort> at(const Rational& k) const;
};

/// M = N/d over polynomials of s and k, without a common factor.
struct ParametricTwoPort {
  Form form = Form::z;
  std::array<std::array<ParametricPolynomial, 2>, 2> numerator;
  ParametricPolynomial denominator;
};

/// The first of z, h, g, y that exists for all but single k.
/// @fails  not usable: none does.
[[nodiscard]] Result<ParametricTwoPort> immittance(const PortEquations& equations);

/// The matrix of the equations in that form, in double; not finite where the form does not exist.
/// @param equations  the coefficients of [V₁ V₂ I₁ I₂]
[[nodiscard]] Eigen::Matrix2cd immittance(const Eigen::Matrix<std::complex<double>, 2, 4>& equations, Form form);

}  // namespace mbk::teleop
