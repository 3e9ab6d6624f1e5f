#pragma once

#include <initializer_list>
#include <optional>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/energy.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/passivity.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::analyse {

/// The band in which a model can be judged: from the lowest to the highest frequency of the excited band at which the
/// multiple coherence of position and force with the known perturbation exceeds 0.8 on all axes. Without a recorded
/// reference, the coherence of force with motion.
/// @returns absent if there are fewer than two such frequencies, or if the axes were not moved independently
[[nodiscard]] std::optional<PassivityBand> coherent_band(const std::vector<PreparedTrial>& trials);

/// The excited band of all trials, not below one period of the longest segment; used if coherent_band() is absent. A
/// model is extrapolated in it.
[[nodiscard]] PassivityBand excited_band(const std::vector<PreparedTrial>& trials);

/// A requested band, and whether it extends beyond the coherent one by more than 1 %, the precision of the printed
/// ends.
[[nodiscard]] PassivityBand asked_band(Hertz low, Hertz high, const std::optional<PassivityBand>& coherent);

/// Passivity of a model in a band, from its parameters and their covariance by the delta method
/// (impedance/passivity_index.h). Conditions, as theorem 3.2 of Dyck (2013) has them after correction: M_s, B_s and K_s
/// positive definite; and at both ends of the band |ω m_a − k_a/ω| < √det B_s, each side separately. m_a and k_a are
/// not tested separately because their effects can add up.
/// @fails  the model is missing (NaN); the band is empty or not positive.
[[nodiscard]] Result<ModelPassivity> model_passivity(const Identification& identification, const PassivityBand& band);

/// The same for several models, in their order. Omitted: nullptr, a model that was not found, and a mass-spring model,
/// whose damping was not estimated.
/// @fails  as model_passivity
[[nodiscard]] Result<std::vector<ModelPassivity>> model_passivities(std::initializer_list<const Identification*> models,
                                                                    const PassivityBand& band);

/// Whether the model by instrumental variables makes the prediction although least squares is the method of the result:
/// it is usable, its instruments are strong, and it differs significantly from least squares. If instrumental variables
/// are the method of the result, which default mode prefers, their model always makes the prediction.
[[nodiscard]] bool prefer_instruments(const Identification& instrumental,
                                      const std::optional<Disagreement>& disagreement);

/// The statement on the trial from its energy. The signals must be plausible: a wrong sign of the force would invert
/// it.
/// @param result  its warnings show whether the signals are plausible
/// @returns absent if they are not
[[nodiscard]] std::optional<TrialPassivity> trial_passivity(const Identification& result, EnergyAccount energy,
                                                            std::vector<EnergyLine> lines = {});

/// The prediction of the first model. None if the result or that model is not usable. Undecided if the model fits
/// poorly, no reference was recorded or there is no coherent band. Not active by the antisymmetric part alone if much
/// of the residual is coherent with the perturbation, because the intervals account for noise only. Not passive over a
/// band in which the limb significantly delivered energy at a line.
/// @param usable  the result
/// @param coherent  coherent_band()    @param lines  energy_lines()
[[nodiscard]] PassivityPrediction predict_passivity(const std::vector<ModelPassivity>& models, bool usable,
                                                    const std::optional<PassivityBand>& coherent,
                                                    const std::vector<EnergyLine>& lines = {});

}  // namespace mbk::analyse
