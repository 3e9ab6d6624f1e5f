#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/mbk/terminal/completion.h"

namespace mbk::app {
namespace {

constexpr const char* kBashBeginning = R"(# bash completion for mbk, as written by 'mbk completion bash'

)";

// What is typed is one of three things: the value of the option before it, an option, or a command or argument.
// Bash splits --mode=reference at its '=', which is then a word of its own.
constexpr const char* kBashEnd = R"(
# _mbk_add_files PATTERN: files whose names match it, and the folders that lead to them
_mbk_add_files() {
  local name
  compopt -o filenames 2>/dev/null
  while IFS= read -r name; do
    if [[ -d $name || ( $1 != folders && $name =~ $1 ) ]]; then COMPREPLY+=("$name"); fi
  done < <(compgen -f -- "$current")
}

_mbk() {
  local current=${COMP_WORDS[COMP_CWORD]} command=mbk option='' given i
  local commands options valued words files IFS=$' \t\n'
  _mbk_command "$command"
  for ((i = 1; i < COMP_CWORD; i++)); do
    given=${COMP_WORDS[i]}
    if [[ " $valued " == *" $given "* ]]; then
      ((i++))
      if [[ ${COMP_WORDS[i]} == '=' ]]; then ((i++)); fi
      if ((i >= COMP_CWORD)); then option=$given; fi
    elif [[ " $commands " == *" $given "* ]]; then
      command+=" $given"
      _mbk_command "$command"
    fi
  done
  if [[ $current == '=' ]]; then current=''; fi

  COMPREPLY=()
  if [[ -n $option ]]; then
    _mbk_value "$command" "$option"
  elif [[ $current == -* ]]; then
    words=$options files=''
  else
    words="$commands $words"
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  if [[ -n $files ]]; then _mbk_add_files "$files"; fi
}

complete -F _mbk mbk
)";

/// What _mbk_add_files takes: "" for none, else the pattern of their names.
std::string files_of(const Values& values) {
  if (values.folders) return "folders";
  if (!values.files) return "";
  return values.extensions.empty() ? "." : fmt::format(R"(\.({})$)", fmt::join(values.extensions, "|"));
}

std::string assignments(const Values& values) {
  return fmt::format("words={} files={}", single_quoted(fmt::format("{}", fmt::join(values.words, " "))),
                     single_quoted(files_of(values)));
}

/// All arguments of a command as one, since the script does not know which of them is being typed.
Values together(const std::vector<OptionText>& positionals) {
  Values all;
  bool any_file = false;
  for (const OptionText& one : positionals) {
    all.words.insert(all.words.end(), one.values.words.begin(), one.values.words.end());
    all.extensions.insert(all.extensions.end(), one.values.extensions.begin(), one.values.extensions.end());
    all.files = all.files || one.values.files;
    all.folders = all.folders || one.values.folders;
    any_file = any_file || (one.values.files && one.values.extensions.empty());
  }
  if (any_file) all.extensions.clear();
  all.folders = all.folders && !all.files;
  return all;
}

std::string command_case(const CommandText& command) {
  std::vector<std::string> commands, options, valued;
  for (const CommandText& below : command.commands) commands.push_back(below.name());
  for (const OptionText& option : command.options) {
    options.insert(options.end(), option.names.begin(), option.names.end());
    if (!option.value.empty()) valued.insert(valued.end(), option.names.begin(), option.names.end());
  }
  return fmt::format("    {})\n      commands='{}'\n      options='{}'\n      valued='{}'\n      {}\n      ;;\n",
                     single_quoted(command.joined(" ")), fmt::join(commands, " "), fmt::join(options, " "),
                     fmt::join(valued, " "), assignments(together(command.positionals)));
}

std::string value_cases(const CommandText& command) {
  std::string cases;
  for (const OptionText& option : command.options) {
    if (option.values.words.empty() && files_of(option.values).empty()) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : option.names) patterns.push_back(single_quoted(command.joined(" ") + " " + name));
    cases += fmt::format("    {}) {} ;;\n", fmt::join(patterns, " | "), assignments(option.values));
  }
  return cases;
}

}  // namespace

std::string bash_completion(const CommandText& root) {
  std::string commands, values;
  for_each_command(root, [&](const CommandText& command) {
    commands += command_case(command);
    values += value_cases(command);
  });
  return std::string(kBashBeginning) +
         "# _mbk_command COMMAND: what may follow it; words and files are those of its arguments\n"
         "_mbk_command() {\n  case $1 in\n" +
         commands +
         "  esac\n}\n\n"
         "# _mbk_value COMMAND OPTION: what the value of this option may be\n"
         "_mbk_value() {\n  words='' files=''\n  case \"$1 $2\" in\n" +
         values + "  esac\n}\n" + kBashEnd;
}

}  // namespace mbk::app
