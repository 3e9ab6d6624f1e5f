#include "apps/mbk/wording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include "apps/mbk/call.h"
#include "apps/mbk/terminal/command.h"
#include "apps/mbk/terminal/command_list.h"
#include "apps/mbk/terminal/command_tree.h"
#include "apps/mbk/terminal/help.h"

namespace mbk::app {
namespace {

constexpr std::string_view kEllipsis = "…";

/// Reserved words that could be the name of an option.
constexpr auto kPythonKeywords = std::to_array<std::string_view>(
    {"and", "as",     "class", "def", "del",  "for",   "from",   "global", "if",    "import", "in",
     "is",  "lambda", "not",   "or",  "pass", "raise", "return", "try",    "while", "with",   "yield"});

/// Commands without a function in +mbk.
constexpr auto kNotInMatlab = std::to_array<std::string_view>({"recover", "reproduce"});

// ---- options and commands ----

struct KnownOption {
  bool takes_value = false;     ///< in at least one command
  std::set<std::string> words;  ///< fixed values
};

enum class CommandKind { callable, group, shell };

struct Known {
  std::map<std::string, KnownOption> options;   ///< by name, with its dashes
  std::map<std::string, CommandKind> commands;  ///< by "robot identify"
};

Known read_known() {
  const Parser parser("mbk");
  add_help(parser.command());
  const Actions unused = add_commands("", parser.command(), "");
  Known all;
  for_each_command(describe(parser.command()), [&](const CommandText& command) {
    for (const OptionText& option : command.options) {
      KnownOption& entry = all.options[option.names.back()];
      entry.takes_value = entry.takes_value || !option.value.empty();
      entry.words.insert(option.values.words.begin(), option.values.words.end());
    }
    if (command.path.size() < 2) return;
    const CommandKind kind = !can_be_called(command.path[1]) ? CommandKind::shell
                             : command.commands.empty()      ? CommandKind::callable
                                                             : CommandKind::group;
    all.commands[fmt::format("{}", fmt::join(command.path.begin() + 1, command.path.end(), " "))] = kind;
  });
  return all;
}

/// Never destroyed: a thread of the host may still read a message while the process ends.
const Known& known() {
  static const Known& all = *new Known(read_known());
  return all;
}

// ---- characters and words ----

bool is_lower(char c) {
  return c >= 'a' && c <= 'z';
}

bool is_upper(char c) {
  return c >= 'A' && c <= 'Z';
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_number(const std::string& text) {
  static const std::regex kNumber(R"([+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?)");
  return std::regex_match(text, kNumber);
}

/// "HZ", "FILE"
bool is_placeholder(const std::string& text) {
  return std::ranges::any_of(text, is_upper) &&
         std::ranges::all_of(text, [](char c) { return is_upper(c) || c == '_' || c == '|'; });
}

/// Whether the word after an option is its value rather than the next word of the sentence.
bool is_value(const std::string& word, const KnownOption& option) {
  if (option.words.contains(word)) return true;
  if (word.starts_with("--") || word.front() == '(' || word.front() == '\'' || word.front() == '"') return false;
  if (word.front() == '-' && word.size() > 1) return true;
  if (word.find_first_of("=:/,._") != std::string::npos || word.find(kEllipsis) != std::string::npos) return true;
  if (std::ranges::any_of(word, is_digit)) return true;
  return std::ranges::any_of(word, is_upper) && std::ranges::none_of(word, is_lower);
}

/// The option of --help whose name begins at `at`: "--rate"; empty if there is none.
std::string option_at(std::string_view text, std::size_t at) {
  if (text.substr(at, 2) != "--" || at + 2 >= text.size() || !is_lower(text[at + 2])) return "";
  if (at > 0) {
    const char before = text[at - 1];
    if (is_lower(before) || is_upper(before) || is_digit(before) || before == '-' || before == '_' || before == '.' ||
        before == '/') {
      return "";
    }
  }
  std::size_t end = at + 2;
  while (end < text.size() && (is_lower(text[end]) || is_digit(text[end]) || text[end] == '-')) ++end;
  while (text[end - 1] == '-') --end;
  std::string name(text.substr(at, end - at));
  return known().options.contains(name) ? name : "";
}

struct FoundValue {
  std::string value;
  std::size_t end;  ///< position after it
};

/// The value of an option whose name ends at `at`.   @param certain  the next word is its value in any case
std::optional<FoundValue> value_at(const std::string& text, std::size_t at, const KnownOption& option, bool certain) {
  if (at >= text.size() || (text[at] != ' ' && text[at] != '=')) return std::nullopt;
  const std::size_t begin = at + 1;
  if (begin >= text.size()) return std::nullopt;
  const char quote = text[begin];
  if ((quote == '\'' || quote == '"') && text.compare(begin, 5, "'mbk ") != 0) {
    const std::size_t end = text.find(quote, begin + 1);
    if (end == std::string::npos) return std::nullopt;
    return FoundValue{text.substr(begin + 1, end - begin - 1), end + 1};
  }
  constexpr std::string_view kStops = ".,;:)?!'";
  std::size_t end = std::min(text.find_first_of(" \n", begin), text.size());
  const auto word = [&] { return text.substr(begin, end - begin); };
  while (end > begin && kStops.find(text[end - 1]) != std::string_view::npos && !word().ends_with("...")) --end;
  if (end == begin) return std::nullopt;
  if (text[at] == '=' || certain || is_value(word(), option)) return FoundValue{word(), end};
  return std::nullopt;
}

// ---- texts of a language ----

std::string identifier(Language language, std::string name) {
  if (language == Language::c) return name;
  std::ranges::replace(name, '-', '_');
  const bool reserved = std::ranges::find(kPythonKeywords, std::string_view(name)) != kPythonKeywords.end();
  return language == Language::python && reserved ? name + "_" : name;
}

std::string literal(Language language, const std::string& value) {
  if (value == "..." || value == kEllipsis) return std::string(kEllipsis);
  if (is_placeholder(value) || (language != Language::c && is_number(value))) return value;
  if (language == Language::matlab) {
    std::string doubled;
    for (const char c : value) doubled += c == '\'' ? std::string("''") : std::string(1, c);
    return fmt::format("'{}'", doubled);
  }
  const char quote = language == Language::python && value.find('"') != std::string::npos ? '\'' : '"';
  return fmt::format("{0}{1}{0}", quote, value);
}

/// @param option  "--rate", of --help    @param value  nothing: the option is named without a value
std::string argument(Language language, const std::string& option, const std::optional<std::string>& value) {
  if (option == "--json") return "JSON";
  if (option == "--help" || option == "--help-all") {
    if (language == Language::c) return "'mbk --help' in a terminal";
    return language == Language::python ? "help()" : "help";
  }
  const std::string name = identifier(language, option.substr(2));
  const bool is_flag = !known().options.at(option).takes_value;
  switch (language) {
    case Language::python:
      return name + "=" + (is_flag ? "True" : value ? literal(language, *value) : std::string(kEllipsis));
    case Language::matlab:
      return "'" + name + "'" + (is_flag ? ", true" : value ? ", " + literal(language, *value) : "");
    case Language::c:
      break;
  }
  if (is_flag) return "{\"" + name + "\", NULL}";
  return value ? "{\"" + name + "\", " + literal(language, *value) + "}" : "\"" + name + "\"";
}

/// Arguments of a command.
struct Arguments {
  std::vector<std::string> texts;
  bool json = false;  ///< --json was among them
  std::optional<std::string> out;
};

/// Nothing if an option is not in --help.
std::optional<Arguments> arguments_of(Language language, const std::vector<std::string>& words) {
  Arguments found;
  for (std::size_t k = 0; k < words.size(); ++k) {
    std::string word = words[k];
    if (!word.starts_with("--")) {
      if (word.size() > 3 && word.ends_with("...")) word.resize(word.size() - 3);
      found.texts.push_back(literal(language, word));
      continue;
    }
    const auto option = known().options.find(word);
    if (option == known().options.end()) return std::nullopt;
    if (word == "--json" || word == "--quiet") {
      found.json = found.json || word == "--json";
      continue;
    }
    std::optional<std::string> value;
    if (option->second.takes_value && k + 1 < words.size() && !words[k + 1].starts_with("--")) value = words[++k];
    if (word == "--out" && value) {
      found.out = value;
    } else {
      found.texts.push_back(argument(language, word, value));
    }
  }
  return found;
}

std::vector<std::string> words_in(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// A call of the command `path`; nothing if the language has none.   @param words  arguments of the command
std::optional<std::string> call_text(Language language, const std::vector<std::string>& path,
                                     const std::vector<std::string>& words) {
  std::string callee = "mbk";
  for (const std::string& part : path) {
    callee += "." + identifier(language, part);
    if (language == Language::matlab) break;  // a subcommand is an argument
  }
  if (std::ranges::find(words, "--help") != words.end()) {
    if (language == Language::c) return std::nullopt;
    return language == Language::python ? "help(" + callee + ")" : "'help " + callee + "'";
  }
  auto found = arguments_of(language, words);
  if (!found || (found->json && language != Language::python)) return std::nullopt;
  if (found->out && !found->json) found->texts.push_back(argument(language, "--out", found->out));
  if (language == Language::matlab && path.size() > 1) found->texts.insert(found->texts.begin(), "'" + path[1] + "'");
  const std::string all = fmt::format("{}", fmt::join(found->texts, ", "));
  if (language == Language::c) {
    return fmt::format("command \"{}\"{}{}", fmt::join(path, " "), all.empty() ? "" : " with ", all);
  }
  if (language == Language::matlab && all.empty()) return callee;
  std::string text = callee + "(" + all + ")";
  if (found->json) text += ".save(" + literal(language, found->out.value_or("...")) + ")";
  return text;
}

/// The call for "mbk measure FILE --pool"; nothing if mbk has no such command.
std::optional<std::string> command_text(Language language, const std::string& typed) {
  const std::vector<std::string> words = words_in(typed);
  if (words.size() < 2 || words.front() != "mbk") return std::nullopt;
  const std::string terminal = "'" + typed + "' in a terminal";
  const std::map<std::string, CommandKind>& commands = known().commands;
  const bool two = words.size() > 2 && commands.contains(words[1] + " " + words[2]);
  const std::vector<std::string> path(words.begin() + 1, words.begin() + (two ? 3 : 2));
  const std::vector<std::string> rest(words.begin() + (two ? 3 : 2), words.end());
  const auto command = commands.find(fmt::format("{}", fmt::join(path, " ")));
  if (command == commands.end()) {
    if (typed != "mbk --help") return std::nullopt;
    return language == Language::python ? "help(mbk)" : terminal;
  }
  const bool asks_help = rest.size() == 1 && rest.front() == "--help";
  const bool callable = command->second == CommandKind::callable ||
                        (command->second == CommandKind::group && (rest.empty() || asks_help));
  const bool is_missing =
      language == Language::matlab && std::ranges::find(kNotInMatlab, std::string_view(path[0])) != kNotInMatlab.end();
  if (!callable || is_missing) return terminal;
  return call_text(language, path, rest).value_or(terminal);
}

}  // namespace

std::string in_language(Language language, const std::string& text) {
  constexpr std::string_view kCommand = "'mbk ";
  if (text.find("--") == std::string::npos && text.find(kCommand) == std::string::npos) return text;
  std::string made;
  std::size_t at = 0;
  while (at < text.size()) {
    if (text.compare(at, kCommand.size(), kCommand) == 0) {
      const std::size_t end = text.find('\'', at + 1);
      const auto replaced =
          end == std::string::npos ? std::nullopt : command_text(language, text.substr(at + 1, end - at - 1));
      if (replaced) {
        made += *replaced;
        at = end + 1;
        continue;
      }
    }
    const std::string option = option_at(text, at);
    if (option.empty()) {
      made += text[at++];
      continue;
    }
    const std::size_t end = at + option.size();
    const char next = end < text.size() ? text[end] : '\0';
    if (next == ':' || (next == '\'' && at > 0 && text[at - 1] == '\'')) {  // place of an error; name in quotes
      made += identifier(language, option.substr(2));
      at = end;
      continue;
    }
    const KnownOption& kind = known().options.at(option);
    const bool certain = std::string_view(text).substr(0, at).ends_with("as in ");
    const auto found = kind.takes_value ? value_at(text, end, kind, certain) : std::nullopt;
    made += argument(language, option, found ? std::optional(found->value) : std::nullopt);
    at = found ? found->end : end;
    if (at < text.size() && text[at] == ' ' && !option_at(text, at + 1).empty()) made += ',';
  }
  return made;
}

Error in_language(Language language, const Error& error) {
  Error made = error;
  made.message = in_language(language, error.message);
  made.remedy = in_language(language, error.remedy);
  if (error.where.starts_with("--")) made.where = in_language(language, error.where);  // otherwise a file name
  return made;
}

}  // namespace mbk::app
