#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// A format that is recognised by its first bytes but not supported.
struct LikelyFormat {
  std::string_view what;     ///< "an Excel workbook"
  std::string_view way_out;  ///< how to obtain its data: "save the sheet as CSV (File > Save As)"
};

/// First line of Octave's text format.
inline constexpr std::string_view kOctaveText = "# Created by Octave";

/// The likely format of an unsupported file, by its content only; nothing if unknown.
[[nodiscard]] std::optional<LikelyFormat> likely_format(std::span<const std::byte> file);

/// Error for such a file, with a remedy.
[[nodiscard]] tl::unexpected<Error> not_read(const LikelyFormat& format);

}  // namespace mbk::recording
