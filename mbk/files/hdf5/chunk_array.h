#pragma once

#include <functional>

#include "mbk/files/hdf5/file.h"

namespace mbk::hdf5 {

/// Calls use(index, element) for the elements of an array that are stored, in order. An element is the address of a
/// chunk or, where chunks are packed, its address, size and skipped filters.
using ArrayElement = std::function<Result<void>(std::uint64_t index, Cursor element)>;

/// The index of datasets that cannot grow (specification, VII.B). @fails  a block is broken; `use` fails.
[[nodiscard]] Result<void> for_each_fixed(File& file, std::uint64_t header, bool packed, const ArrayElement& use);

/// The index of datasets that can grow in one dimension (specification, VII.C). @fails  as above.
[[nodiscard]] Result<void> for_each_extensible(File& file, std::uint64_t header, bool packed, const ArrayElement& use);

}  // namespace mbk::hdf5
