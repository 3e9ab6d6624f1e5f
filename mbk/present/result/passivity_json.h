#pragma once

#include "mbk/model/trial/passivity.h"
#include "mbk/present/result/json.h"
#include "mbk/present/result/json_parts.h"

/// For the sources of this module only.
namespace mbk::result {

/// Object `passivity` of a result: what happened, what the model predicts, and the numbers behind both.
[[nodiscard]] Json passivity_json(const Passivity& passivity);

/// Energy of one recording, over time and part by part.
[[nodiscard]] Json energy_json(const Energy& energy);

/// Reads `passivity` of schema mbk.result/2 or mbk.result/1 back.
/// @throws Malformed or nlohmann::json::exception where it is not that
[[nodiscard]] StoredPassivity stored_passivity_from(const Json& passivity);

}  // namespace mbk::result
