#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/measure/measurement/measure.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/validate/study.h"

namespace mbk::validation {

/// The scenarios of a ready file (laboratory/ready_scenarios.h).
/// @fails  no scenario has that name.
[[nodiscard]] Result<std::vector<laboratory::Scenario>> ready(std::string_view name);

/// The scenario of an arm with the limb of a participant (participant::participant_limb); everything else stays.
/// @fails  as participant_limb
[[nodiscard]] Result<laboratory::Scenario> with_limb(laboratory::Scenario scenario, int number);

/// ±8 mm along a diagonal, by the hand, at random moments.
void perturb_along_a_diagonal(laboratory::Scenario& scenario);

/// Participants of the thesis whose limbs studies of behaviour use.
inline constexpr std::array kArms = {1, 4, 5};

/// One simulated trial, measured.
struct SimulatedTrial {
  double energy_absorbed = 0.0;   ///< by the limb [J]
  impedance::Model truth;         ///< intrinsic, mean over the trial
  Identification identification;  ///< empty where the trial was not measured
};

/// What is to be simulated, and how it is measured; absent: it is not.
struct TrialPlan {
  laboratory::Scenario scenario;
  std::optional<measurement::Options> measurement;
};

/// Every plan once, several at a time; the order is that of the plans, on any number of threads. The handle's mass is
/// subtracted as a user would. Of the options, threads and progress count.
/// @fails  as simulate and measure; a model that is not usable is no failure.
[[nodiscard]] Result<std::vector<SimulatedTrial>> run_trials(const std::vector<TrialPlan>& plans,
                                                             const StudyOptions& options);

/// "K5" and "M3" of a rig's trial "K5_M3": its stiffness and its mass; the whole name twice where it has no "_M".
[[nodiscard]] std::pair<std::string, std::string> rig_names(const std::string& trial);

/// The measurement of a payload on springs.
[[nodiscard]] measurement::Options mass_and_springs();

/// A chart that waits for its points.
[[nodiscard]] Chart identified_against_true(std::string title, const std::string& unit);

}  // namespace mbk::validation
