#pragma once

#include "mbk/model/trial/passivity.h"
#include "mbk/present/result/json_parts.h"

/// For the sources of this module only.
namespace mbk::result {

/// Object `passivity` of a result: the verdict, what decided it, and the numbers behind it.
[[nodiscard]] Json passivity_json(const Passivity& passivity);

/// Energy of one recording, over time and part by part.
[[nodiscard]] Json energy_json(const Energy& energy);

}  // namespace mbk::result
