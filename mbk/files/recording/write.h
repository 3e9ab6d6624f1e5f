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
  c3d,    ///< .c3d, only to convert to: it rounds numbers
};

[[nodiscard]] constexpr auto word_table(Format) {
  using enum Format;
  return std::to_array<Word<Format>>({{mat5, "mat5"}, {mat73, "mat73"}, {hdf5, "hdf5"}, {csv, "csv"}, {c3d, "c3d"}});
}

/// "MAT v5", "MAT v7.3", "HDF5", "CSV", "C3D".
[[nodiscard]] std::string_view text(Format format);

/// The format given by the extension of a file, among those that preserve every number.
/// @fails  usage: it gives no such format; the message lists them.
[[nodiscard]] Result<Format> format_of(const std::filesystem::path& file);

/// The format to convert to, given by the extension, or by `name` ("mat", "mat5", "mat73", "hdf5", "csv", "c3d"; "":
/// by the extension).
/// @fails  usage: neither gives a known format; the message lists the known ones.
[[nodiscard]] Result<Format> format_of(const std::filesystem::path& file, std::string_view name);

/// Data that such a file cannot store, one sentence each; none if everything is restored.
[[nodiscard]] std::vector<std::string> lost_in(const Recording& recording, Format format);

/// The frames among them: channels whose frame differs from the one implied by their name.
[[nodiscard]] std::vector<std::string> lost_frames(const Recording& recording, std::string_view format);

/// @fails  data: no samples or channels; a channel twice or of another length; a text that is not one line.
[[nodiscard]] Result<void> check_writable(const Recording& recording);

/// Writes a recording. The file appears completely or not at all (write_file), and equal recordings give equal bytes,
/// whatever the order of their channels. Only the owner of the file may read it, unless `readers` says otherwise.
/// @fails  usage: the file exists and `overwrite` is false. data: the recording cannot be written in this format (the
/// message gives the reason); the folder cannot be written.
[[nodiscard]] Result<void> write(const Recording& recording, const std::filesystem::path& file, Format format,
                                 bool overwrite, Readers readers = Readers::owner);

}  // namespace mbk::recording
