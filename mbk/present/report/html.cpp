#include "mbk/present/report/html.h"

#ifdef MBK_WEB
extern "C" const char kReportPageBegin[], kReportPageEnd[];  // page.S
#endif

namespace mbk::report {
namespace {

constexpr std::string_view kPlaceOfData = "@MBK_REPORT_DATA@";

std::string_view page_template() {
#ifdef MBK_WEB
  return {kReportPageBegin, static_cast<std::size_t>(kReportPageEnd - kReportPageBegin)};
#else
  return {};
#endif
}

}  // namespace

Result<std::string> filled_page(std::string_view page, std::string_view json) {
  const std::size_t place = page.find(kPlaceOfData);
  if (place == std::string_view::npos) {
    return bad_usage("this mbk was built without its pages",
                     "build it with -DMBK_WEB=ON, which needs Node.js, or omit the HTML file");
  }
  std::string html(page.substr(0, place));
  html.reserve(page.size() + json.size() + json.size() / 64);
  for (const char c : json) {
    if (c == '<') {
      html += "\\u003c";
    } else {
      html += c;
    }
  }
  html += page.substr(place + kPlaceOfData.size());
  return html;
}

Result<std::string> page(std::string_view report_json) {
  return filled_page(page_template(), report_json);
}

}  // namespace mbk::report
