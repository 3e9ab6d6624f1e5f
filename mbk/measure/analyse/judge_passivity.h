#pragma once

#include <optional>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/energy.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/passivity.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::analyse {

/// The band in which a model can be judged: from the lowest to the highest frequency of the excited band at which the
/// known perturbation explains more than 0.8 of position and of force (multiple coherence, the smallest of all axes).
/// Where no reference was recorded, or the coherence never reaches that, the excited band itself; `rule` says which.
[[nodiscard]] PassivityBand passivity_band(const std::vector<PreparedTrial>& trials);

/// Passivity of a model in a band, from its parameters and their covariance by the delta method
/// (impedance/passivity_index.h). Conditions, as theorem 3.2 of Dyck (2013) has them after correction: M_s, B_s and K_s
/// positive definite; and at both ends of the band |ω m_a − k_a/ω| < √det B_s, each side by itself. m_a and k_a are not
/// tested apart: they can add up.
/// @fails  the model is not there (NaN); the band is empty or not positive.
[[nodiscard]] Result<ModelPassivity> model_passivity(const Identification& identification, const PassivityBand& band);

/// Which of two methods' models describes the limb: that of instrumental variables where its instruments are strong
/// and it differs from least squares by more than chance, otherwise that of least squares.
[[nodiscard]] bool instruments_speak(const Identification& instrumental,
                                     const std::optional<Disagreement>& disagreement);

/// The verdict on a limb. The model decides where it explains at least half of the force (least squares explains most
/// of what any M, B and K can, so its held-out VAF is the measure) and is itself decided or the energy is not known;
/// where it does not, the energy decides. A model that leaves much of the limb's answer to the perturbation
/// unexplained is not called active by its antisymmetric part alone: its intervals know noise, and that answer is none.
/// @param models  of both methods, or of the only one; the first describes the limb
/// @param explained  [%] held-out VAF of least squares, mean of the axes
[[nodiscard]] Passivity decide(std::vector<ModelPassivity> models, double explained,
                               std::optional<EnergyAccount> energy);

}  // namespace mbk::analyse
