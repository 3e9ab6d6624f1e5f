#pragma once

#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// An HDF5 file with this content, as its bytes: superblock 0, which every HDF5 library reads. Equal trees give equal
/// bytes; there is no time in them. Numbers of 4 KiB and more are shuffled and deflated in chunks where that is
/// shorter. Texts are variable-length strings in UTF-8, but in attributes called MATLAB_… they stand as MATLAB has
/// them: of fixed length, and those of MATLAB_fields as sequences of letters. ("HDF5 File Format Specification
/// Version 2.0", The HDF Group.)
/// @param user_block  bytes that stand before HDF5: none, or 512, 1024, 2048, …
/// @fails  a name that HDF5 cannot hold; one name for a group and a dataset; another count of values than the shape
///         says; a number that its stored type cannot hold; a reference to what is not there; an attribute of 64 KiB
///         and more; a value that was not read.
[[nodiscard]] Result<std::string> serialise(const Group& root, std::string_view user_block = "");

}  // namespace mbk::hdf5
