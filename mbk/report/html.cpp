#include "mbk/report/html.h"

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

Result<std::string> page(std::string_view report_json) {
  const std::string_view whole = page_template();
  const std::size_t place = whole.find(kPlaceOfData);
  if (place == std::string_view::npos) {
    return bad_usage("this mbk was built without the page of its reports",
                     "build it with -DMBK_WEB=ON, which needs Node.js, or leave --report away");
  }
  std::string html(whole.substr(0, place));
  html.reserve(whole.size() + report_json.size() + report_json.size() / 64);
  for (const char c : report_json) {
    if (c == '<') {
      html += "\\u003c";
    } else {
      html += c;
    }
  }
  html += whole.substr(place + kPlaceOfData.size());
  return html;
}

}  // namespace mbk::report
