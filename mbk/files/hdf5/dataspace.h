#pragma once

#include <vector>

#include "mbk/files/hdf5/bytes.h"

namespace mbk::hdf5 {

inline constexpr std::size_t kMaxDimensions = 32;  ///< of HDF5

/// How many elements there are, and how they are arranged.
struct Dataspace {
  std::vector<std::uint64_t> shape;    ///< slowest dimension first; empty: a single value
  std::vector<std::uint64_t> maximum;  ///< what it may grow to; kUndefined: without limit
  std::uint64_t count = 1;             ///< product of the shape
};

/// A dataspace message (specification, IV.A.2.b). A null dataspace has the shape 0.
/// @fails  it is broken; the product of the dimensions overflows.
[[nodiscard]] Result<Dataspace> read_dataspace(Cursor in);

}  // namespace mbk::hdf5
