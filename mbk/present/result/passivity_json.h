#pragma once

#include "mbk/base/document/json_values.h"
#include "mbk/present/result/json.h"

/// For the sources of this module only.
namespace mbk::result {

/// Reads `passivity` of schema mbk.result/2 or mbk.result/1 back.
/// @throws Malformed or nlohmann::json::exception where it is not that
[[nodiscard]] StoredPassivity stored_passivity_from(const document::Json& passivity);

}  // namespace mbk::result
