#pragma once

#include <complex>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/units.h"
#include "mbk/base/core/words.h"
#include "mbk/teleop/two_port.h"

namespace mbk::teleop {

/// Master and slave are masses with a damper, Z_m = m_m s + b_m and Z_s = m_s s + b_s; their controllers act on
/// positions, as impedances C_m = d_m + k_m/s and C_s = d_s + k_s/s. Port 1 is the master: V₁ is the force of the hand
/// on it, I₁ = v_m. Port 2 is the slave: V₂ is the force of the environment on it, I₂ = v_s. D₁ delays signals to the
/// slave, D₂ signals to the master. Every architecture is a case of the four-channel one (Lawrence 1993; Hashtrudi-Zaad
/// & Salcudean 2001):
///   (1 + C₆) V₁ + D₂ C₂ V₂ = (Z_m + C_m) I₁ + D₂ C₄ I₂
///   D₁ C₃ V₁ + (1 + C₅) V₂ = −D₁ C₁ I₁ + (Z_s + C_s) I₂
enum class Architecture {
  /// C₁ = C_s, C₄ = −C_m, and no force is sent:
  ///   z = [[Z_m + C_m, −D₂ C_m], [−D₁ C_s, Z_s + C_s]]
  position_position,
  /// C₁ = C_s, C₂ = k_f, and no position is sent to the master; C_m, if given, couples it to the ground:
  ///   h = [[Z_m + C_m, −D₂ k_f], [D₁ C_s/(Z_s + C_s), 1/(Z_s + C_s)]]
  position_force,
  /// C₁ = C_s, C₄ = −C_m, C₂ = k_f, with local force feedback C₅ and C₆:
  ///   z = [[1 + C₆, D₂ k_f], [0, 1 + C₅]]⁻¹ [[Z_m + C_m, −D₂ C_m], [−D₁ C_s, Z_s + C_s]]
  three_channel,
  /// All four channels; C₁ = m₁ s + d₁ + k₁/s and −C₄ = m₄ s + d₄ + k₄/s:
  ///   z = [[1 + C₆, D₂ C₂], [D₁ C₃, 1 + C₅]]⁻¹ [[Z_m + C_m, D₂ C₄], [−D₁ C₁, Z_s + C_s]]
  /// C₁ = Z_s + C_s, C₄ = −(Z_m + C_m), C₂ = 1 + C₆ and C₃ = 1 + C₅ is transparent without delay: there is no z, and
  ///   h = [[0, −1], [1, 0]].
  four_channel,
};

[[nodiscard]] constexpr auto word_table(Architecture) {
  using enum Architecture;
  return std::to_array<Word<Architecture>>({{position_position, "position-position"},
                                            {position_force, "position-force"},
                                            {three_channel, "three-channel"},
                                            {four_channel, "four-channel"}});
}

/// The equations above as printable lines.
[[nodiscard]] std::vector<std::string> matrix_lines(Architecture architecture);

/// One number of a teleoperator.
struct Parameter {
  std::string_view name;     ///< "slave.k"
  std::string_view section;  ///< of a design file
  std::string_view key;      ///< "controller_stiffness_N_per_m"
  std::string_view unit;     ///< SI: "N/m"; empty for gains
  std::string_view meaning;  ///< "k_s, stiffness of the slave's controller"
};

/// All parameters.
[[nodiscard]] std::span<const Parameter> all_parameters();

/// Whether an architecture has that parameter, and whether it is required; by default it is zero, except that C₁ and
/// −C₄ of four channels are C_s and C_m if none of their values is given.
enum class Need { none, optional, required };
[[nodiscard]] Need need(Architecture architecture, std::string_view parameter);

struct Teleoperator {
  Architecture architecture = Architecture::position_position;
  std::map<std::string, Rational, std::less<>> values;  ///< by the name of the parameter, SI
  int pade_order = 2;                                   ///< of each delay

  [[nodiscard]] bool has_delay() const;

  /// D(s) ≈ Q(−sT)/Q(sT), Q(x) = Σ_j (2n − j)! n! / ((2n)! j! (n − j)!) xʲ (Padé).
  /// @param parameter  the one that remains a variable, k of the equations; its value is ignored. Empty: none
  [[nodiscard]] PortEquations equations(std::string_view parameter = {}) const;

  /// The same with D = 1.
  [[nodiscard]] PortEquations without_delay(std::string_view parameter = {}) const;

  /// [V₁ V₂ I₁ I₂] of both equations at s = jω, with the exact D = e^(−jωT). With a sample time, the motor commands are
  /// also held between samples: everything but V₁ = Z_m I₁ and V₂ = Z_s I₂ of the robots themselves times
  ///   H(s) = (1 − e^(−s T_s))/(s T_s)
  /// which for ω well below π/T_s is half a sample of delay. Aliasing from above π/T_s is neglected.
  /// @param sample_time  T_s [s] ≥ 0
  [[nodiscard]] Eigen::Matrix<std::complex<double>, 2, 4> with_exact_delay(RadPerSec frequency,
                                                                           double sample_time = 0.0) const;
};

}  // namespace mbk::teleop
