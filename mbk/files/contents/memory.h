#pragma once

#include <cstdint>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// Memory that this process may still take [bytes]: the memory that the system reports as available, within the limits
/// of its control group and address space. The largest number if unknown.
[[nodiscard]] std::uint64_t available_memory();

/// @fails  data: the bytes exceed `available_memory`; the message gives both. Small requests always pass.
[[nodiscard]] Result<void> check_memory(std::uint64_t bytes);

}  // namespace mbk::recording
