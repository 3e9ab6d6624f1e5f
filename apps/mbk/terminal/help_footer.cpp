#include "apps/mbk/terminal/help_footer.h"

#include <algorithm>
#include <sstream>
#include <string_view>

#include "mbk/base/core/trimmed.h"

namespace mbk::app {
namespace {

constexpr std::size_t kEntryIndent = 2;
constexpr std::string_view kExitCodesHeading = "Exit codes:";

void append(std::string& text, std::string_view line) {
  if (!text.empty()) text += ' ';
  text += line;
}

class FooterReader {
 public:
  void read(const std::string& line) {
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    if (indent == line.size()) {
      in_paragraph_ = false;
    } else if (indent > 0) {
      read_indented(indent, trimmed(line));
      in_paragraph_ = false;
    } else if (line.ends_with(':')) {
      heading_ = line.substr(0, line.size() - 1);
      in_examples_ = heading_.starts_with("Example");
      if (!in_examples_) footer_.lists.push_back({heading_, {}});
    } else {
      if (!in_paragraph_) footer_.paragraphs.emplace_back();
      append(footer_.paragraphs.back(), trimmed(line));
      in_paragraph_ = true;
    }
  }

  /// Takes the exit codes out of the paragraphs.
  HelpFooter finished() {
    std::vector<std::string>& paragraphs = footer_.paragraphs;
    const auto codes =
        std::ranges::find_if(paragraphs, [](const std::string& p) { return p.starts_with(kExitCodesHeading); });
    if (codes != paragraphs.end()) {
      footer_.exit_codes = trimmed(std::string_view(*codes).substr(kExitCodesHeading.size()));
      paragraphs.erase(codes);
    }
    return std::move(footer_);
  }

 private:
  void read_indented(std::size_t indent, std::string_view text) {
    if (in_examples_) return read_example(indent, text);
    const std::size_t gap = text.find("  ");
    const std::string_view remark = gap == std::string_view::npos ? std::string_view() : trimmed(text.substr(gap));
    footer_.lists.back().entries.emplace_back(text.substr(0, gap), remark);
  }

  void read_example(std::size_t indent, std::string_view text) {
    std::vector<Example>& examples = footer_.examples;
    const bool continues = !examples.empty() && examples.back().command.ends_with('\\');
    if (continues) {
      examples.back().command += "\n    " + std::string(text);
    } else if (indent == kEntryIndent || examples.empty()) {
      const std::size_t gap = text.find("  ");  // a remark on the same line
      examples.push_back({std::string(text.substr(0, gap)), ""});
      if (gap != std::string_view::npos) examples.back().remark = trimmed(text.substr(gap));
    } else {
      append(examples.back().remark, text);
    }
  }

  HelpFooter footer_;
  std::string heading_;
  bool in_examples_ = true, in_paragraph_ = false;  // indented lines without a heading are examples
};

}  // namespace

HelpFooter parse_footer(const std::string& text) {
  FooterReader reader;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) reader.read(line);
  return reader.finished();
}

}  // namespace mbk::app
