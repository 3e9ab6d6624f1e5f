#include "mbk/base/core/table_text.h"

#include <algorithm>
#include <array>
#include <charconv>
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

bool is_formula(std::string_view text) {
  if (text.empty() || std::string_view("=+-@\t\r\n").find(text.front()) == std::string_view::npos) return false;
  const std::string_view digits = text.substr(text.front() == '+' ? 1 : 0);
  double number = 0.0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return code != std::errc() || end != digits.data() + digits.size();
}

std::string csv_field(std::string_view text) {
  const char* const before = is_formula(text) ? "'" : "";
  if (text.find_first_of(",;\t\"\r\n") == std::string_view::npos) return before + std::string(text);
  std::string quoted = std::string("\"") + before;
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
