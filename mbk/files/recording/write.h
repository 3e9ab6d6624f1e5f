#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/readers.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// The formats that recordings are written in.
enum class Format {
  mat5,   ///< .mat
  mat73,  ///< .mat, asked for by name: HDF5 within
  hdf5,   ///< .h5, .hdf5
  csv,    ///< .csv
};

[[nodiscard]] constexpr auto word_table(Format) {
  using enum Format;
  return std::to_array<Word<Format>>({{mat5, "mat5"}, {mat73, "mat73"}, {hdf5, "hdf5"}, {csv, "csv"}});
}

/// "MAT v5", "MAT v7.3", "HDF5", "CSV".
[[nodiscard]] std::string_view text(Format format);

/// The format that the end of a file's name says, or that `name` says ("mat", "mat5", "mat73", "hdf5", "csv").
/// @fails  usage: neither says one that is known; those that are known are named.
[[nodiscard]] Result<Format> format_of(const std::filesystem::path& file, std::string_view name = "");

/// What such a file has no place for, in words; nothing where everything comes back.
[[nodiscard]] std::vector<std::string> lost_in(const Recording& recording, Format format);

/// The frames among them: channels whose frame is another than their name implies.
[[nodiscard]] std::vector<std::string> lost_frames(const Recording& recording, std::string_view format);

/// @fails  data: no samples or channels; a channel twice or of another length; a text that is not one line.
[[nodiscard]] Result<void> check_writable(const Recording& recording);

/// Writes a recording. The file appears whole or not at all (write_file), and equal recordings give equal bytes,
/// whatever the order of their channels. What was measured on a person is for the file's owner alone, unless `readers`
/// says otherwise.
/// @fails  usage: the file is there and `overwrite` is false. data: the recording cannot be written in this format (the
///         message says what stands in the way); the folder cannot be written.
[[nodiscard]] Result<void> write(const Recording& recording, const std::filesystem::path& file, Format format,
                                 bool overwrite, Readers readers = Readers::owner);

}  // namespace mbk::recording
