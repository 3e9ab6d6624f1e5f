#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

class OpenTrials;

/// A format that mbk reads. These rows define the decoder of a file, --help, error messages, the files searched for in
/// a folder, and the table of `mbk info --formats`.
struct FileFormat {
  std::string_view name;                       ///< "C3D"
  std::string_view extensions;                 ///< ".sto .mot": usual extensions; the content decides
  std::string_view about;                      ///< versions, and the programs that write it
  bool (*looks_like)(OpenFile& file);          ///< detects it by content; nullptr: a folder, not a file
  Result<Contents> (*decode)(OpenFile& file);  ///< nullptr if a file holds several records
  Result<std::shared_ptr<const OpenTrials>> (*open)(OpenFile& file) = nullptr;  ///< of such a file
};

/// In the order in which they are tried.
[[nodiscard]] std::span<const FileFormat> file_formats();

/// The first format that matches the content.
/// @fails  data: none matches; the message says what the file resembles and what to do.
[[nodiscard]] Result<const FileFormat*> format_of(OpenFile& file);

/// ".h5", ".mat", …: each once, in the order of the rows.
[[nodiscard]] std::vector<std::string_view> format_extensions();

/// ".h5, .mat, … or the folder of a BIDS data set": for help and messages.
[[nodiscard]] std::string readable_files();

}  // namespace mbk::recording
