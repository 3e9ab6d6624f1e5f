#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/explore/emg_responses.h"
#include "mbk/measure/explore/frequency_response_of.h"
#include "mbk/measure/explore/impulse_response.h"
#include "mbk/measure/explore/measure_plateaus.h"
#include "mbk/measure/explore/measure_reaches.h"
#include "mbk/measure/explore/stretch.h"
#include "mbk/measure/preprocess/force_rotation.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/model/trial/exploration.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

/// A response other than that of force to motion: from one channel to another.
struct ExploredSignals {
  std::string input, output, reference;        ///< channels; reference: empty where there is none
  double input_sign = 1.0, output_sign = 1.0;  ///< 1 or −1
  std::string input_name, output_name;         ///< as they are shown
};

/// Options of an exploration of recordings without a model.
struct ExploreOptions {
  preprocess::Options preprocess;
  std::optional<Hertz> resample;                   ///< put the samples on an even clock first
  double force_delay = 0.0;                        ///< by which the force was read late, undone first [s]
  preprocess::RotationVector force_rotation = {};  ///< by which the force is turned first [rad]
  std::optional<ExploredSignals> signals;          ///< absent: from the position to −F
  std::optional<ExplorationPart> only;             ///< absent: every part but emg and stretch
  explore::FrequencyResponseOptions frequency_response;
  explore::ImpulseResponseOptions impulse_response;
  explore::PlateauOptions plateau;  ///< of a reference of ramps and holds
  explore::ReachOptions reaches;    ///< of recordings of reaches
  explore::EmgOptions emg;
  std::vector<std::string> muscles;     ///< EMG channels that are a path of the force, or the schedule
  explore::StretchOptions stretch;      ///< of stretches at constant velocity
  std::string schedule;                 ///< channel that M, B and K are followed over, kCoContraction; empty: time
  std::string schedule_name;            ///< what it is called in the result; empty: as the channel
  std::optional<std::string> align;     ///< event, or "reference", since which time counts; absent: the first sample
  std::optional<double> after_onset_s;  ///< M, B and K from so long after each onset of the reference; absent: not
};

/// Explores recordings of one limb in one condition without a model of M, B and K. They are averaged.
/// @fails  as preprocess::exploration_trial_of and the parts; the message names the file.
[[nodiscard]] Result<Exploration> explore(std::span<const Recording> recordings, const ExploreOptions& options);

/// Adds the ellipse of its symmetric part and its antisymmetric part to a stiffness of two axes, with 95 % intervals as
/// wide as those of the stiffness, by Student's t.
void add_ellipse(StiffnessRegression& fit);

/// Only the stiffness from ramps and holds, with its ellipse and warnings. The rest before the first ramp is needed, so
/// whole recordings are used unless options.preprocess.window is set.
/// @param warnings  warnings are appended
/// @fails  as preprocess::exploration_trial_of and explore::plateau_stiffness; the message names the file.
[[nodiscard]] Result<PlateauStiffness> plateau_stiffness(std::span<const Recording> recordings,
                                                         const ExploreOptions& options, std::vector<Warning>& warnings);
/// Only M, B and K over time, or over the variable in the options (explore::time_course).
/// @fails  as explore() and the parts
[[nodiscard]] Result<TimeCourseEstimate> time_course(std::span<const Recording> recordings,
                                                     const ExploreOptions& options);
/// Only M, B and K from the first options.after_onset_s after each onset of the reference (explore::after_onset).
/// @fails  usage: the option is absent. As explore() and the part.
[[nodiscard]] Result<AfterOnsetEstimate> after_onset(std::span<const Recording> recordings,
                                                     const ExploreOptions& options);

}  // namespace mbk::measurement
