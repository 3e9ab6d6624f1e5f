#pragma once

#include <string>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/reproduction.h"

namespace mbk::thesis {

/// One HTML file that needs nothing beside it: the page of web/reproduction with the reproduction in it.
/// @fails  usage: the program was built without its pages (MBK_WEB=OFF).
[[nodiscard]] Result<std::string> page(const Reproduction& reproduction);

}  // namespace mbk::thesis
