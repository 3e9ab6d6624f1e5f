#pragma once

#include <string_view>

#include "mbk/core/result.h"

namespace mbk::console {

/// The page of operator and participant, which are one file: its address says which of the two it shows.
/// @fails  usage: the program was built without it (MBK_WEB=OFF).
[[nodiscard]] Result<std::string_view> operator_page();

}  // namespace mbk::console
