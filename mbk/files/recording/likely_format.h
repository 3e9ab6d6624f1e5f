#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// A format that is known by its first bytes and not read.
struct LikelyFormat {
  std::string_view what;     ///< "an Excel workbook"
  std::string_view way_out;  ///< how its data can be had: "save the sheet as CSV (File > Save As)"
};

/// How Octave's text format begins.
inline constexpr std::string_view kOctaveText = "# Created by Octave";

/// What a file most likely is that no reader takes, by its content alone; nothing where the content says nothing.
[[nodiscard]] std::optional<LikelyFormat> likely_format(std::span<const std::byte> file);

/// That a file is such, and what to do.
[[nodiscard]] tl::unexpected<Error> not_read(const LikelyFormat& format);

}  // namespace mbk::recording
