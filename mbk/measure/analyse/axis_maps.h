#pragma once

#include <optional>
#include <vector>

#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// Checks whether force and motion have the same signs and order of axes. For a symmetric positive definite Z and a
/// signed permutation R other than I, the symmetric part of R Z is never positive definite: of the eight maps R (two
/// with one axis), the force Rᵀ F gives a passive model by one at most. If it is not the given one, and
/// the given one is significantly not passive in at least two of M, B and K, the warning names it with the
/// corresponding
/// --channels. If the reference shows that the motion, not the force, was mapped wrongly, the channels of the motion
/// are named. A force rotated relative to the motion by the same angle in M, B and K is reported, too.
[[nodiscard]] std::optional<Warning> check_axes(const std::vector<const Recording*>& recordings,
                                                const std::vector<PreparedTrial>& trials, const Measurement& measured);

/// Checks whether the inertia is symmetric, as for every limb: not if |m_yx − m_xy| exceeds 4.4 standard errors
/// (p = 10⁻⁵), with both methods if both are usable. The angle θ by which the force is rotated relative to the motion
/// makes R(−θ)(M + Λ I), R(−θ) B and R(−θ) K symmetric, Λ the handle's mass: by generalised least squares over the
/// three, or over M alone where the three contradict each other (a reflex may make B and K antisymmetric). If the
/// gains of the axes explain M, B and K and an angle does not, or less well (Akaike's criterion), the gains are named;
/// if neither does and another warning already reports a biased M, there is no warning.
[[nodiscard]] std::optional<Warning> check_symmetry(const Measurement& measured);

}  // namespace mbk::analyse
