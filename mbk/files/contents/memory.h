#pragma once

#include <cstdint>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// Memory that this process may still take [bytes]: what the system calls available, within the limits of its control
/// group and of its address space. The largest number where nobody says.
[[nodiscard]] std::uint64_t available_memory();

/// @fails  data: so many bytes are more than `available_memory`; the message names both. Small requests always pass.
[[nodiscard]] Result<void> check_memory(std::uint64_t bytes);

}  // namespace mbk::recording
