#pragma once

#include <cstdint>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// @fails  data: the bytes exceed `system::available_memory`; the message gives both. Small requests always pass.
[[nodiscard]] Result<void> check_memory(std::uint64_t bytes);

}  // namespace mbk::recording
