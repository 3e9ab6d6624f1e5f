#include "mbk/base/core/table_text.h"

#include <algorithm>
#include <array>
#include <utility>

namespace mbk {
namespace {

constexpr auto kLatex = std::to_array<std::pair<std::string_view, std::string_view>>({{"&", "\\&"},
                                                                                      {"%", "\\%"},
                                                                                      {"$", "\\$"},
                                                                                      {"#", "\\#"},
                                                                                      {"_", "\\_"},
                                                                                      {"{", "\\{"},
                                                                                      {"}", "\\}"},
                                                                                      {"~", "\\~{}"},
                                                                                      {"^", "\\^{}"},
                                                                                      {"\\", "\\textbackslash{}"},
                                                                                      {"·", "$\\cdot$"},
                                                                                      {"²", "$^2$"},
                                                                                      {"°", "$^\\circ$"},
                                                                                      {"±", "$\\pm$"}});

}  // namespace

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string latex_text(std::string_view text) {
  std::string made;
  while (!text.empty()) {
    const auto* const found =
        std::ranges::find_if(kLatex, [&](const auto& one) { return text.starts_with(one.first); });
    const std::size_t taken = found == kLatex.end() ? 1 : found->first.size();
    made += found == kLatex.end() ? text.substr(0, 1) : found->second;
    text.remove_prefix(taken);
  }
  return made;
}

}  // namespace mbk
