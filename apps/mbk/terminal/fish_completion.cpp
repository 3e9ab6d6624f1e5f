#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/mbk/terminal/completion.h"

namespace mbk::app {
namespace {

/// 'text' as fish reads it: within single quotes it knows \\ and \'.
std::string quoted_for_fish(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\\' || c == '\'') out += '\\';
    out += c;
  }
  return out + "'";
}

constexpr const char* kFishBeginning = R"(# fish completion for mbk, as written by 'mbk completion fish'

)";

constexpr const char* kAt = R"(
# __mbk_at COMMAND: that is the command that has been typed so far
function __mbk_at
    set -l command mbk
    for word in (commandline -opc)
        if contains -- "$command $word" $__mbk_commands
            set command "$command $word"
        end
    end
    test "$command" = "$argv"
end

complete -c mbk -f
)";

/// What completes a value: -x -a '...', -r -F or -x.
std::string offer_of(const Values& values) {
  std::vector<std::string> offered = values.words;
  if (values.folders) offered.emplace_back("(__fish_complete_directories)");
  if (values.files && values.extensions.empty() && offered.empty()) return "-r -F";
  if (values.files && values.extensions.empty()) offered.emplace_back("(__fish_complete_path)");
  for (const std::string& extension : values.files ? values.extensions : std::vector<std::string>()) {
    offered.push_back(fmt::format("(__fish_complete_suffix .{})", extension));
  }
  return offered.empty() ? "-x" : "-x -a " + quoted_for_fish(fmt::format("{}", fmt::join(offered, " ")));
}

std::string lines_of(const CommandText& command) {
  const std::string beginning = "complete -c mbk -n " + quoted_for_fish("__mbk_at " + command.joined(" ")) + " ";
  std::string lines = "\n";
  for (const CommandText& below : command.commands) {
    lines += beginning + "-a " + below.name() + " -d " + quoted_for_fish(below.description) + "\n";
  }
  for (const OptionText& option : command.options) {
    lines += beginning;
    for (const std::string& name : option.names) {
      lines += name.starts_with("--") ? "-l " + name.substr(2) + " " : "-s " + name.substr(1) + " ";
    }
    if (!option.value.empty()) lines += offer_of(option.values) + " ";
    lines += "-d " + quoted_for_fish(option.description) + "\n";
  }
  for (const OptionText& one : command.positionals) {
    lines += beginning + offer_of(one.values) + " -d " + quoted_for_fish(one.value) + "\n";
  }
  return lines;
}

}  // namespace

std::string fish_completion(const CommandText& root) {
  std::string names = "set -g __mbk_commands", lines;
  for_each_command(root, [&](const CommandText& command) {
    if (&command != &root) names += " " + quoted_for_fish(command.joined(" "));
    lines += lines_of(command);
  });
  return kFishBeginning + names + "\n" + kAt + lines;
}

}  // namespace mbk::app
