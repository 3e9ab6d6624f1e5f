#pragma once

#include <optional>

#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// Mass of the handle beyond the force sensor as the recording says it [kg]; NaN where that is no number, nothing where
/// it does not say.
[[nodiscard]] std::optional<double> recorded_handle_mass(const Recording& recording);

}  // namespace mbk::preprocess
