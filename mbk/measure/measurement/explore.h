#pragma once

#include <optional>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/explore/impulse_response.h"
#include "mbk/measure/explore/welch_response.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/model/trial/exploration.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

/// Everything that may be chosen on the way from recordings to what they say without a model.
struct ExploreOptions {
  preprocess::Options preprocess;
  std::optional<Hertz> resample;  ///< put the samples on an even clock first
  double force_delay = 0.0;       ///< by which the force was read late, undone first [s]
  explore::WelchOptions welch;
  explore::ImpulseResponseOptions impulse_response;
};

/// What recordings of one limb in one condition say of it without a model of M, B and K. They are averaged.
/// @fails  as preprocess::exploration_trial_of and the parts; the message names the file.
[[nodiscard]] Result<Exploration> explore(std::span<const Recording> recordings, const ExploreOptions& options);

}  // namespace mbk::measurement
