#pragma once

#include <string>
#include <string_view>

#include "mbk/core/result.h"

namespace mbk::report {

/// One HTML file that needs nothing beside it: the page of web/report with a document of schema "mbk.report/1" in it.
/// Every '<' of the document is written `\u003c`, so that nothing in it can end the element that holds it.
/// @fails  usage: the program was built without the page (MBK_WEB=OFF).
[[nodiscard]] Result<std::string> page(std::string_view report_json);

}  // namespace mbk::report
