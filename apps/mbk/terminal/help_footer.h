#pragma once

#include <string>
#include <vector>

namespace mbk::app {

/// What a command line does, and what is said of it.
struct Example {
  std::string command, remark;
};

/// The text that follows the options in --help, taken apart:
///   Examples:
///     mbk info log.mat
///         what it does
///   Studies:
///     coverage   one line for each
///   A paragraph.
///   Exit codes: 0 fine, 2 wrong usage.
struct HelpFooter {
  std::vector<Example> examples;
  struct List {
    std::string heading;
    std::vector<std::pair<std::string, std::string>> entries;
  };
  std::vector<List> lists;
  std::vector<std::string> paragraphs;
  std::string exit_codes;  ///< "0 fine, 2 wrong usage."; empty where it names none
};

/// The description of a command may have examples in it too: it is read in the same way.
[[nodiscard]] HelpFooter parse_footer(const std::string& text);

}  // namespace mbk::app
