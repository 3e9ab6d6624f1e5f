#pragma once

#include "mbk/present/result/json.h"
#include "mbk/present/result/json_parts.h"

/// For the sources of this module only.
namespace mbk::result {

/// Reads `passivity` of schema mbk.result/2 or mbk.result/1 back.
/// @throws Malformed or nlohmann::json::exception where it is not that
[[nodiscard]] StoredPassivity stored_passivity_from(const Json& passivity);

}  // namespace mbk::result
