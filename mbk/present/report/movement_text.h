#pragma once

#include <string>

#include "mbk/model/trial/movement.h"

namespace mbk::report {

/// Reaches of a recording, one line each, and their medians.
[[nodiscard]] std::string movement_text(const MovementQuality& found);

}  // namespace mbk::report
