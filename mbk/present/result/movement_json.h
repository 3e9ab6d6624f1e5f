#pragma once

#include <span>
#include <string>

#include "mbk/model/trial/movement.h"

namespace mbk::result {

/// Schema "mbk.movement/1": reaches of each recording.
[[nodiscard]] std::string to_json(std::span<const MovementQuality> all);

}  // namespace mbk::result
