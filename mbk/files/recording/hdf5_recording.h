#pragma once

#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::recording {

/// Decodes an HDF5 file: MATLAB files (v7.3) by MATLAB's conventions, others unchanged.
/// @fails  as hdf5::read.
[[nodiscard]] Result<Contents> decode_hdf5(std::span<const std::byte> file);

/// The contents of an HDF5 file that is not MATLAB's. Numbers of one or two dimensions come out under their paths
/// ("trial/force"), the first dimension as rows, as their attributes say (hdf5_attributes.h); data of a TimeSeries of
/// NWB have its clock; everything else is listed in a note. In the layout that mbk writes
///   /channels/NAME   come out as NAME;
///   /events/time, /events/value, /events/name   as `events.time`, …, for `take_annotations`;
/// and attributes of the root that are numbers or texts are metadata; but not `format` and mbk's own `software`.
[[nodiscard]] Contents contents_of_hdf5(hdf5::Group root);

}  // namespace mbk::recording
