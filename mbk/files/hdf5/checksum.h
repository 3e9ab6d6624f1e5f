#pragma once

#include "mbk/files/hdf5/bytes.h"

namespace mbk::hdf5 {

inline constexpr std::size_t kChecksumSize = 4;

/// The checksum of HDF5's structures: Jenkins' lookup3, `hashlittle` with the initial value 0 (Jenkins 2006).
[[nodiscard]] std::uint32_t lookup3(Bytes bytes);

/// The checksum of the filter fletcher32: Fletcher's sums over big-endian words of 16 bits; an odd last byte counts as
/// the upper half of a word.
[[nodiscard]] std::uint32_t fletcher32(Bytes bytes);

/// Whether the last four bytes are the lookup3 of those before them. Builds for fuzzing do not ask, so that damage
/// gets beyond the checksums.
[[nodiscard]] bool checksum_is_right(Bytes block);

}  // namespace mbk::hdf5
