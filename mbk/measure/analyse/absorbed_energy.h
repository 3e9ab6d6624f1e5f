#pragma once

#include <cstdint>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/energy.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

struct EnergyOptions {
  double block_s = 2.5;       ///< of a sustained perturbation, about [s] > 0
  double first_share = 0.05;  ///< of ∫ v·v dt, from which on the largest shortage is looked for; in (0, 1)
  int replicates = 5000;      ///< of the bootstrap, ≥ 100
  std::uint64_t seed = 1;     ///< of the bootstrap
};

/// Energy that the limb absorbed, E(t) = −∫ F_h·v dt, with F_h the force of the hand on the robot (Dyck 2013, eq. 3.1
/// and 4.3 with the sign of 3.2). No model is needed. It is the energy at the sensor, including
/// the kinetic energy ½ m v² of a handle beyond the sensor.
///
/// E is summed over the recorded samples, without any filter and without a derivative,
///   E_{i+1} = E_i − ½ (F_i + F_{i+1})·(x_{i+1} − x_i).
/// Noise of the force and white noise of the position do not bias it, even if they are correlated at each sample: the
/// expectation telescopes. A force delayed by τ biases it by τ ∫ Ḟ·v dt (docs/theory/energy.md).
/// v, used only for ∫ v·v dt and ∫ |v| dt, is the first derivative of the preparation's Savitzky–Golay filter at every
/// sample of the recording; no low-pass. No sum crosses a break: a gap of more than 1.5 sample times, time that does
/// not rise, a non-finite value. Samples without a known velocity are omitted from both sums.
///
/// The window runs from the first to the last sample of the analysed interval. Intervals come from a bootstrap over
/// blocks: of pulses, from one onset to the next; otherwise of about `block_s`, the window divided equally. Their
/// percentiles are widened for few blocks (Hesterberg 2015). The verdict uses both one-sided 95 % bounds of E: passive
/// if the lower is above 0, active if the upper is below 0. Fewer than six blocks are undecided, except five with the
/// same sign: if both signs were equally likely, this would happen in one case of 32.
/// @param recording  the source of the trial, after resampling if that was requested
/// @param model     for the work of its antisymmetric stiffness, or nullptr; one axis has none
/// @fails  data: a channel is missing; fewer than two samples; the recording is not the source of the trial; the limb
/// does not move in the window (∫ v·v dt = 0).  usage: an option is out of its range.
[[nodiscard]] Result<Energy> absorbed_energy(const Recording& recording, const PreparedTrial& trial,
                                             const EnergyOptions& options = {},
                                             const impedance::Model* model = nullptr);

/// Several recordings as one: energies and times are added, blocks pooled, and the shortage runs through the windows
/// one after another.
/// @param trials  one for each recording
/// @fails  as absorbed_energy; none; not as many trials as recordings; axes or units differ.
[[nodiscard]] Result<EnergyAccount> pooled_energy(std::span<const Recording* const> recordings,
                                                  std::span<const PreparedTrial> trials,
                                                  const EnergyOptions& options = {});

}  // namespace mbk::analyse
