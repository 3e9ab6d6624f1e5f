#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/write.h"
#include "mbk/model/trial/readers.h"

namespace mbk::recording {

/// Writes every array of a file unchanged, whether or not it is a channel: numbers, names, units, rates, clocks,
/// metadata and events. Nothing is converted to SI.
///   HDF5  each under its path ("trial/force"), with the attributes `unit`, `rate_hz` and `clock`; the stamps of a
///   clock
///         in /clocks/NAME; metadata as attributes of the root; /events as in recordings
///   MAT   each as a variable, with its attributes in the structures `units`, `rates_hz` and `clocks`, `metadata`,
///         `events`
///   CSV   if all have equal lengths: a column for each row or column along the longer side, `NAME[K]`, with
///         the unit in brackets, and the time if one rate or one clock is known
/// The file appears completely or not at all.
/// @returns one sentence for each renamed array, and for data that the format cannot store
/// @fails  usage: the file exists and `overwrite` is false. data: there is no array; CSV: they have different lengths
///         or clocks; MAT v5: one of them is too large; the folder cannot be written.
[[nodiscard]] Result<std::vector<std::string>> write_contents(const Contents& contents,
                                                              const std::filesystem::path& file, Format format,
                                                              bool overwrite, Readers readers = Readers::owner);

}  // namespace mbk::recording
