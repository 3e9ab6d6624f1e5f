#include "mbk/experiment/console/page.h"

#include <array>
#include <charconv>
#include <cstddef>
#include <span>
#include <utility>

#include "mbk/files/contents/sha256.h"

#ifdef MBK_WEB
extern "C" const char kConsolePageBegin[], kConsolePageEnd[];  // page.S
#endif

namespace mbk::console {
namespace {

/// 64 hexadecimal digits as base64 (RFC 4648, §4).
std::string base64_of_hexadecimal(std::string_view digits) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  unsigned bits = 0;
  int held = 0;  // bits that are not written yet
  for (const char& digit : digits) {
    unsigned value = 0;
    std::from_chars(&digit, &digit + 1, value, 16);
    bits = bits << 4 | value;
    for (held += 4; held >= 6; held -= 6) text += kDigits[bits >> (held - 6) & 63U];
  }
  if (held > 0) text += kDigits[bits << (6 - held) & 63U];
  while (text.size() % 4 != 0) text += '=';
  return text;
}

/// " 'sha256-…'" of each element of that name; " 'none'" where there is none.
std::string hashes(std::string_view html, std::string_view name) {
  const std::string begin = "<" + std::string(name), end = "</" + std::string(name) + ">";
  std::string sources;
  for (std::size_t at = html.find(begin); at != std::string_view::npos; at = html.find(begin, at)) {
    const std::size_t tag = html.find('>', at);
    if (tag == std::string_view::npos) break;
    const std::size_t last = html.find(end, tag);
    if (last == std::string_view::npos) break;
    if (html.substr(at, tag - at).find("application/json") == std::string_view::npos) {
      const std::string_view inside = html.substr(tag + 1, last - tag - 1);
      sources += " 'sha256-" + base64_of_hexadecimal(recording::sha256(std::as_bytes(std::span(inside)))) + "'";
    }
    at = last;
  }
  return sources.empty() ? " 'none'" : sources;
}

}  // namespace

std::string inline_sources(std::string_view html) {
  return "script-src" + hashes(html, "script") + "; style-src" + hashes(html, "style");
}

Page make_page(std::string html) {
  std::string sources = inline_sources(html);
  return {std::make_shared<std::string>(std::move(html)), std::move(sources)};
}

Result<std::string_view> operator_page() {
#ifdef MBK_WEB
  return std::string_view(kConsolePageBegin, static_cast<std::size_t>(kConsolePageEnd - kConsolePageBegin));
#else
  return bad_usage("this mbk was built without the pages of its console",
                   "build it with -DMBK_WEB=ON, which needs Node.js, or take --no-console");
#endif
}

}  // namespace mbk::console
