#pragma once

#include <optional>
#include <span>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/explore/frequency_response_of.h"
#include "mbk/measure/explore/impulse_response.h"
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

/// Everything that may be chosen on the way from recordings to what they say without a model.
struct ExploreOptions {
  preprocess::Options preprocess;
  std::optional<Hertz> resample;           ///< put the samples on an even clock first
  double force_delay = 0.0;                ///< by which the force was read late, undone first [s]
  std::optional<ExploredSignals> signals;  ///< absent: from the position to −F
  explore::FrequencyResponseOptions frequency_response;
  explore::ImpulseResponseOptions impulse_response;
};

/// What recordings of one limb in one condition say of it without a model of M, B and K. They are averaged.
/// @fails  as preprocess::exploration_trial_of and the parts; the message names the file.
[[nodiscard]] Result<Exploration> explore(std::span<const Recording> recordings, const ExploreOptions& options);

}  // namespace mbk::measurement
