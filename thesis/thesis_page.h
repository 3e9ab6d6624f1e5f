#pragma once

#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/reproduction.h"

namespace mbk::thesis {

/// One HTML file that needs nothing beside it: the page of web/reproduction with the document in it.
/// @param document  result::to_json(reproduction)
/// @fails  usage: the program was built without its pages (MBK_WEB=OFF).
[[nodiscard]] Result<std::string> page(const Reproduction& reproduction, std::string_view document);

}  // namespace mbk::thesis
