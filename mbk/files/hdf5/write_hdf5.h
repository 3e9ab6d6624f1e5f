#pragma once

#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// An HDF5 file with this content, as its bytes: superblock 0, which every HDF5 library reads. Equal trees give equal
/// bytes; there is no time in them. Numbers of 4 KiB and more are shuffled and deflated in chunks where that is
/// shorter. Texts are variable-length strings in UTF-8, but attributes named MATLAB_… use MATLAB's form: fixed length,
/// and for MATLAB_fields sequences of letters. ("HDF5 File Format Specification Version 2.0", The HDF Group.)
/// @param user_block  bytes that stand before HDF5: none, or 512, 1024, 2048, …
/// @fails  a name that HDF5 does not allow; one name for a group and a dataset; a number of values that differs from
/// the shape; a number that does not fit its stored type; a reference to a missing object; an attribute of 64 KiB or
/// more; a value that was not read.
[[nodiscard]] Result<std::string> serialise(const Group& root, std::string_view user_block = "");

}  // namespace mbk::hdf5
