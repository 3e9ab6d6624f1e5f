#pragma once

#include "mbk/base/core/result.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// How many values a shape stands for.
[[nodiscard]] std::uint64_t count_of(const std::vector<std::uint64_t>& shape);

/// Whether `serialise` can write this.
/// @fails  as `serialise` does.
[[nodiscard]] Result<void> check_writable(const Group& root);

}  // namespace mbk::hdf5
