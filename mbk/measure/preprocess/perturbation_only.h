#pragma once

#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// The part of a session's recording that lies between its events `perturbation_start` and `perturbation_end`, on a
/// clock that begins at the first of them, as do its excluded windows; what the approach and the way back left is no
/// answer to the perturbation. A note says what was left out. A recording without a start is given back as it is; one
/// without an end goes on to its last sample. Where there are several, from the first start to the first end behind it.
[[nodiscard]] Recording perturbation_only(Recording recording);

}  // namespace mbk::preprocess
