#include "mbk/present/report/html.h"

#include <fmt/format.h>

#include "mbk/present/report/draw_chart.h"

#ifdef MBK_WEB
extern "C" const char kReportPageBegin[], kReportPageEnd[];  // page.S
#endif

namespace mbk::report {
namespace {

constexpr std::string_view kPlaceOfData = "@MBK_REPORT_DATA@", kPlaceOfText = "@MBK_REPORT_TEXT@";

std::string_view page_template() {
#ifdef MBK_WEB
  return {kReportPageBegin, static_cast<std::size_t>(kReportPageEnd - kReportPageBegin)};
#else
  return {};
#endif
}

std::string static_html(const StaticReport& plain) {
  std::string html = "<main class=\"plain\"><p>Scripts are off, so this is the report as text and drawings.</p><pre>";
  for (const char c : plain.text) {
    if (c == '&') {
      html += "&amp;";
    } else if (c == '<') {
      html += "&lt;";
    } else {
      html += c;
    }
  }
  html += "</pre>";
  for (const Chart& chart : plain.charts) html += chart_svg(chart);
  return html + "</main>";
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

Result<std::string> page(std::string_view report_json, const StaticReport& plain) {
  std::string html(page_template());
  const std::size_t place = html.find(kPlaceOfText);
  if (place != std::string::npos) html.replace(place, kPlaceOfText.size(), static_html(plain));
  return filled_page(html, report_json);
}

}  // namespace mbk::report
