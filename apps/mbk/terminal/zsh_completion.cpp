#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

#include "apps/mbk/terminal/completion.h"

namespace mbk::app {
namespace {

constexpr const char* kZshBeginning = R"(#compdef mbk
# zsh completion for mbk, as written by 'mbk completion zsh'

)";

// The file is autoloaded as the function _mbk, or read by a start-up file.
constexpr const char* kZshEnd = R"(if [[ $funcstack[1] == _mbk ]]; then
  _mbk "$@"
else
  compdef _mbk mbk
fi
)";

/// Characters that a specification of _arguments would read as its own.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("\\[]:").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// "(default reference)", "_files -g ...": how the value is completed; " " if unknown.
std::string action_of(const Values& values) {
  std::string files;
  if (values.folders) files = "_files -/";
  if (values.files) {
    files =
        values.extensions.empty() ? "_files" : fmt::format("_files -g \"*.({})\"", fmt::join(values.extensions, "|"));
  }
  const std::string words = fmt::format("{}", fmt::join(values.words, " "));
  if (files.empty()) return words.empty() ? " " : "(" + words + ")";
  if (words.empty()) return files;
  return fmt::format(R"({{compadd {}; {}}})", words, files);
}

/// '(-h --help)'{-h,--help}'[description]:HZ:action'
std::string option_lines(const OptionText& option, bool several) {
  std::string lines;
  for (const std::string& name : option.names) {
    std::string others;
    for (const std::string& other : option.names) others += (others.empty() ? "" : " ") + other;
    std::string spec = option.repeats ? "*" : several ? "(" + others + ")" : "";
    spec += name + "[" + escaped(option.description) + "]";
    if (!option.value.empty()) spec += ":" + escaped(option.value) + ":" + action_of(option.values);
    lines += "    " + single_quoted(spec) + " \\\n";
  }
  return lines;
}

std::string positional_lines(const std::vector<OptionText>& positionals) {
  std::string lines;
  int place = 0;
  for (const OptionText& one : positionals) {
    const std::string where = one.repeats ? "*" : fmt::format("{}", ++place);
    lines += "    " +
             single_quoted(
                 fmt::format("{}:{}{}:{}", where, one.required ? "" : ":", escaped(one.value), action_of(one.values))) +
             " \\\n";
  }
  return lines;
}

std::string function_of(const CommandText& command) {
  std::string options;
  for (const OptionText& option : command.options) options += option_lines(option, option.names.size() > 1);
  const std::string name = command.joined("_");
  if (command.commands.empty()) {
    std::string arguments = options + positional_lines(command.positionals);
    if (arguments.ends_with(" \\\n")) arguments.erase(arguments.size() - 3, 2);
    return fmt::format("_{}() {{\n  _arguments -s -S \\\n{}}}\n\n", name, arguments);
  }
  std::string listed, calls;
  for (const CommandText& below : command.commands) {
    listed += "    " + single_quoted(escaped(below.name()) + ":" + escaped(below.description)) + "\n";
    calls += fmt::format("        {}) _{} ;;\n", below.name(), below.joined("_"));
  }
  return fmt::format(
      "_{0}() {{\n  local curcontext=$curcontext state line\n  local -a commands=(\n{1}  )\n"
      "  _arguments -C \\\n{2}    '1: :->command' \\\n    '*:: :->arguments'\n"
      "  case $state in\n    command) _describe command commands ;;\n"
      "    arguments)\n      case $words[1] in\n{3}      esac\n      ;;\n  esac\n}}\n\n",
      name, listed, options, calls);
}

}  // namespace

std::string zsh_completion(const CommandText& root) {
  std::string functions;
  for_each_command(root, [&](const CommandText& command) { functions += function_of(command); });
  return kZshBeginning + functions + kZshEnd;
}

}  // namespace mbk::app
