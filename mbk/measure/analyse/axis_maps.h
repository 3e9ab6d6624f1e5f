#pragma once

#include <optional>
#include <vector>

#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// Whether force and motion have the same signs and the same order of axes. For a symmetric positive definite Z and a
/// signed permutation R other than I, the symmetric part of R Z is never positive definite: of the eight maps R (two
/// with one axis), the force Rᵀ F gives a passive model by one at most. Where it is not the one that was given, and
/// the given one is surely not passive in at least two of M, B and K, it is named, with the --channels that reads the
/// recording so. Where the reference shows that the motion, and not the force, was mapped wrongly, the motion's
/// channels are named. Beyond the eight, a force that is turned against the motion by the same angle in M, B and K is
/// named too.
[[nodiscard]] std::optional<Warning> check_axes(const std::vector<const Recording*>& recordings,
                                                const std::vector<PreparedTrial>& trials, const Measurement& measured);

/// Whether the inertia is symmetric, as that of every limb is: |m_yx − m_xy| above 4.4 standard errors says no (10⁻⁵
/// by chance), by both methods where both are usable. The angle θ by which the force is then turned against the motion
/// makes R(−θ)(M + Λ I), R(−θ) B and R(−θ) K symmetric, Λ the handle's mass: by generalised least squares over the
/// three, or over M alone where the three contradict each other (a reflex may make B and K antisymmetric). Where a
/// gain of one axis explains M, B and K and an angle does not, that is named; where neither does and another warning
/// says that M is biased, nothing.
[[nodiscard]] std::optional<Warning> check_symmetry(const Measurement& measured);

}  // namespace mbk::analyse
