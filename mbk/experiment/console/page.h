#pragma once

#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/experiment/console/outbox.h"

namespace mbk::console {

/// A page, and what its Content-Security-Policy has to let through.
struct Page {
  Message html;         ///< null: the page does not exist
  std::string sources;  ///< inline_sources of it
};

/// "script-src 'sha256-…'; style-src 'sha256-…'": of each script and style that stands in the page, so that a browser
/// runs these and nothing that came into the page later (CSP Level 3, §6.7.3). Data in script elements (type
/// "application/json") is never run and left out. The page has line ends as Unix has them.
[[nodiscard]] std::string inline_sources(std::string_view html);

[[nodiscard]] Page make_page(std::string html);

/// The page of operator and participant, which are one file: its address says which of the two it shows.
/// @fails  usage: the program was built without it (MBK_WEB=OFF).
[[nodiscard]] Result<std::string_view> operator_page();

}  // namespace mbk::console
