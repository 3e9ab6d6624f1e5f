#pragma once

#include <string>
#include <string_view>

#include "mbk/base/core/result.h"

namespace mbk::report {

/// A page of web/ with its document where the page has `@MBK_REPORT_DATA@`. Every '<' of the document is written
/// `\u003c`, so that nothing in it can end the element that holds it.
/// @fails  usage: there is no such place: the program was built without its pages (MBK_WEB=OFF).
[[nodiscard]] Result<std::string> filled_page(std::string_view page, std::string_view json);

/// One HTML file that needs nothing beside it: the page of web/report with a document of schema "mbk.report/1" in it.
/// @fails  as filled_page
[[nodiscard]] Result<std::string> page(std::string_view report_json);

}  // namespace mbk::report
