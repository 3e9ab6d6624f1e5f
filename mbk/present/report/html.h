#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/chart.h"

namespace mbk::report {

/// A page of web/ with its document where the page has `@MBK_REPORT_DATA@`. Every '<' of the document is written
/// `\u003c`, so that nothing in it can end the element that contains it.
/// @fails  usage: there is no such place: the program was built without its pages (MBK_WEB=OFF).
[[nodiscard]] Result<std::string> filled_page(std::string_view page, std::string_view json);

/// What a reader without JavaScript sees.
struct StaticReport {
  std::string text;           ///< as the terminal shows it
  std::vector<Chart> charts;  ///< below the text
};

/// One HTML file that needs no other: the page of web/report with a document of schema "mbk.report/1" and the same as
/// plain HTML and SVG for readers without JavaScript.
/// @fails  as filled_page
[[nodiscard]] Result<std::string> page(std::string_view report_json, const StaticReport& plain);

}  // namespace mbk::report
