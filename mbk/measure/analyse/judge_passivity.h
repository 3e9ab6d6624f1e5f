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
/// known perturbation explains more than 0.8 of position and of force (multiple coherence, the smallest of all axes).
/// Where no reference was recorded, at which the motion explains more than 0.8 of the force.
/// @returns absent where there is no such frequency, or where the axes were not moved independently
[[nodiscard]] std::optional<PassivityBand> coherent_band(const std::vector<PreparedTrial>& trials);

/// The excited band of all trials, not below one period of the longest segment: what is left to look at where
/// coherent_band() has nothing to say. It is extrapolated.
[[nodiscard]] PassivityBand excited_band(const std::vector<PreparedTrial>& trials);

/// A band that was asked for, and whether it reaches beyond the coherent one, by more than the 1 % to which it is
/// printed.
[[nodiscard]] PassivityBand asked_band(Hertz low, Hertz high, const std::optional<PassivityBand>& coherent);

/// Passivity of a model in a band, from its parameters and their covariance by the delta method
/// (impedance/passivity_index.h). Conditions, as theorem 3.2 of Dyck (2013) has them after correction: M_s, B_s and K_s
/// positive definite; and at both ends of the band |ω m_a − k_a/ω| < √det B_s, each side by itself. m_a and k_a are not
/// tested apart: they can add up.
/// @fails  the model is not there (NaN); the band is empty or not positive.
[[nodiscard]] Result<ModelPassivity> model_passivity(const Identification& identification, const PassivityBand& band);

/// The same of several models, in their order; nullptr, a model that was not found and one without damping, which was
/// not asked whether the limb has any, are left out.
/// @fails  as model_passivity
[[nodiscard]] Result<std::vector<ModelPassivity>> model_passivities(std::initializer_list<const Identification*> models,
                                                                    const PassivityBand& band);

/// Which of two methods' models makes the prediction: that of instrumental variables where its instruments are strong
/// and it differs from least squares by more than chance, otherwise that of least squares.
[[nodiscard]] bool instruments_speak(const Identification& instrumental,
                                     const std::optional<Disagreement>& disagreement);

/// What happened in the trial. The signals must be plausible: with a force of the other sign it is the opposite.
/// @param result  whose warnings say whether they are
/// @returns absent where they are not
[[nodiscard]] std::optional<TrialPassivity> trial_passivity(const Identification& result, EnergyAccount energy,
                                                            std::vector<EnergyLine> lines = {});

/// What the first model predicts. There is no prediction where the result or that model is not usable. It is undecided
/// at most where the model fits poorly or the data show at no frequency how the limb answers; and not active by the
/// antisymmetric part alone where much of what the model leaves of the force answers the perturbation too, for the
/// intervals know noise, and that answer is none. It is not passive over a band in which the limb surely delivered
/// energy at a line.
/// @param usable  the result
/// @param coherent  coherent_band()    @param lines  energy_lines()
[[nodiscard]] PassivityPrediction predict_passivity(const std::vector<ModelPassivity>& models, bool usable,
                                                    const std::optional<PassivityBand>& coherent,
                                                    const std::vector<EnergyLine>& lines = {});

}  // namespace mbk::analyse
