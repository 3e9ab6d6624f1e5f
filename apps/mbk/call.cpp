#include "apps/mbk/call.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <sstream>
#include <unordered_map>

#include "apps/mbk/caller.h"
#include "apps/mbk/commands/commands.h"
#include "apps/mbk/commands/commands_json.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/terminal/command.h"
#include "apps/mbk/terminal/command_list.h"
#include "apps/mbk/terminal/command_tree.h"
#include "apps/mbk/terminal/help.h"
#include "mbk/base/core/edit_distance.h"
#include "mbk/base/core/version.h"
#include "mbk/files/recording/in_memory.h"

namespace mbk::app {
namespace {

/// Commands that move a robot, ask questions, work as one of several processes, or serve a shell or this project: not
/// for scripts.
constexpr auto kNotCallable = std::to_array<std::string_view>({"run", "new", "work", "completion", "manual"});

constexpr std::size_t kMaxPrepared = 64;

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> words;
  std::istringstream stream{std::string(text)};
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// A command line that was parsed.
struct Prepared {
  Parser parser;
  Actions actions;
  bool json = false;
};

/// The command below `app` that `path` names; nothing if there is none or if it has subcommands.
std::optional<Command> find_command(Command app, std::span<const std::string> path) {
  Command at = app;
  for (const std::string& word : path) {
    const auto below = at.commands();
    const auto named = std::ranges::find(below, word, &Command::name);
    if (named == below.end()) return std::nullopt;
    at = *named;
  }
  return at.commands().empty() ? std::optional(at) : std::nullopt;
}

/// The call as text, one item a line: the same text has the same parsed command line.
std::string key_of(const Call& call, std::span<const std::string> words) {
  std::string key = call.command;
  const auto add = [&](const std::string& text, char kind) {
    key += '\n';
    key += kind;
    key += std::to_string(text.size());
    key += ':';
    key += text;
  };
  for (const CallOption& option : call.options) {
    add(option.name, '-');
    for (const std::string& value : option.values) add(value, '=');
  }
  for (const std::string& word : words) add(word, ' ');
  return key;
}

/// The error of an unknown option, with a suggestion.
tl::unexpected<Error> no_option(Command command, const std::string& name) {
  const std::string meant = meant_word("--" + name, command.option_names());
  return bad_usage(fmt::format("unknown option '{}' of {}", name, command.name()),
                   meant.empty() ? "" : fmt::format("did you mean '{}'?", meant.substr(2)));
}

/// As it would be typed, word by word.
std::vector<std::string> typed_option(Command command, const CallOption& given) {
  const std::string name = "--" + given.name;
  if (given.values.empty()) return {name};
  const auto option = command.find_option(name);
  const bool flag = option && option->is_flag();
  if (flag && given.values.front() == "false") return {};
  if (flag && given.values.front() == "true") return {name};
  const bool in_one = option && option->takes_following();
  std::vector<std::string> words;
  for (std::size_t k = 0; k < given.values.size(); ++k) {
    words.push_back(k > 0 && in_one ? given.values[k] : name + "=" + given.values[k]);
  }
  return words;
}

/// The words that would be typed after the command.
/// @fails  usage: an unknown option
Result<std::vector<std::string>> typed_words(Command command, const Call& call, const std::vector<std::string>& words) {
  std::vector<std::string> typed;
  for (const CallOption& option : call.options) {
    if (!command.find_option("--" + option.name)) return no_option(command, option.name);
    const std::vector<std::string> more = typed_option(command, option);
    typed.insert(typed.end(), more.begin(), more.end());
  }
  if (!words.empty()) {
    typed.emplace_back("--");
    typed.insert(typed.end(), words.begin(), words.end());
  }
  return typed;
}

/// A zero byte would end a file name.
bool holds_zero(const Call& call) {
  const auto has_zero = [](const std::string& text) { return text.find('\0') != std::string::npos; };
  return has_zero(call.command) || std::ranges::any_of(call.words, has_zero) ||
         std::ranges::any_of(call.options,
                             [&](const CallOption& option) { return std::ranges::any_of(option.values, has_zero); });
}

/// @fails  usage: the error of the parser
Result<void> parse(const Parser& parser, std::vector<std::string> typed, const std::string& help) {
  const auto taken = parser.parse(std::move(typed));
  if (taken) return {};
  return bad_usage(taken.error().answer ? "this option prints a text and is available only on the command line"
                                        : taken.error().usage,
                   help);
}

/// @fails  usage: an unknown command; the error of the parser
Result<std::shared_ptr<const Prepared>> prepare(const Call& call, const std::vector<std::string>& words) {
  const std::vector<std::string> path = split(call.command);
  const std::string first = path.empty() ? "" : path.front();
  const Parser probe;
  const Actions unused = add_commands(first, probe.command(), "");
  const auto command = path.empty() ? std::nullopt : find_command(probe.command(), path);
  if (!command || !can_be_called(first)) {
    return bad_usage(fmt::format("'{}' is not a command that can be called", call.command), "see 'mbk --help'");
  }
  auto behind = MBK_TRY(typed_words(*command, call, words));
  const bool said = std::ranges::any_of(call.options, [](const CallOption& o) { return o.name == "json"; });
  const bool can = command->find_option("--json").has_value();
  std::vector<std::string> typed = path;
  if (can && !said) typed.emplace_back("--json");
  typed.insert(typed.end(), behind.begin(), behind.end());

  auto prepared = std::make_shared<Prepared>();
  prepared->json = can && std::ranges::find(typed, "--json") != typed.end();
  prepared->actions = add_commands(first, prepared->parser.command(), command_line(typed));
  MBK_TRY(parse(prepared->parser, typed, fmt::format("see 'mbk {} --help'", call.command)));
  return std::shared_ptr<const Prepared>(std::move(prepared));
}

/// The result of `work`, with exceptions as errors.
template <class Work>
auto guarded(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return bad_data("not enough memory", "analyse part of a recording with --from and --to");
  } catch (const std::exception& error) {
    return bad_data(error.what(), "the command was aborted");
  }
}

/// Parsed command lines, reused when the same call is repeated.
class Prepareds {
 public:
  Result<std::shared_ptr<const Prepared>> get(const Call& call, const std::vector<std::string>& words) {
    const std::string key = key_of(call, words);
    {
      const std::scoped_lock lock(mutex_);
      const auto found = made_.find(key);
      if (found != made_.end()) return found->second;
    }
    auto prepared = prepare(call, words);
    if (!prepared) return prepared;
    const std::scoped_lock lock(mutex_);
    if (made_.size() >= kMaxPrepared) made_.clear();
    made_.emplace(key, *prepared);
    return prepared;
  }

 private:
  std::mutex mutex_;
  std::unordered_map<std::string, std::shared_ptr<const Prepared>> made_;
};

/// Never destroyed: a thread of the host may still call while the process exits.
Prepareds& prepareds() {
  static Prepareds& all = *new Prepareds;
  return all;
}

/// End of the list of a JSON document that starts at `begin`.
std::size_t end_of_list(std::string_view text, std::size_t begin) {
  int depth = 0;
  bool within = false;
  for (std::size_t k = begin; k < text.size(); ++k) {
    const char c = text[k];
    if (within) {
      if (c == '\\') ++k;
      if (c == '"') within = false;
    } else if (c == '"') {
      within = true;
    } else if (c == '[') {
      ++depth;
    } else if (c == ']' && --depth == 0) {
      return k + 1;
    }
  }
  return text.size();
}

/// The words of the call, preceded by those of recordings and documents in memory that no word names.
std::vector<std::string> all_words(const Call& call) {
  std::vector<std::string> words;
  const auto add_unnamed = [&](std::size_t count, std::string (*word_of)(std::size_t)) {
    for (std::size_t k = 0; k < count; ++k) {
      std::string word = word_of(k);
      const bool named = std::ranges::find(call.words, word) != call.words.end() ||
                         std::ranges::any_of(call.options, [&](const CallOption& option) {
                           return std::ranges::find(option.values, word) != option.values.end();
                         });
      if (!named) words.push_back(std::move(word));
    }
  };
  add_unnamed(call.recordings.size(), recording_word);
  add_unnamed(call.documents.size(), document_word);
  words.insert(words.end(), call.words.begin(), call.words.end());
  return words;
}

}  // namespace

std::string recording_word(std::size_t k) {
  return fmt::format("<recording {}>", k + 1);
}

std::string document_word(std::size_t k) {
  return fmt::format("<result {}>.json", k + 1);
}

Result<Answer> call(const Call& call) {
  return guarded([&]() -> Result<Answer> {
    if (holds_zero(call)) return bad_usage("a text contains a zero byte", "remove it");
    const auto prepared = MBK_TRY(prepareds().get(call, all_words(call)));
    Caller caller(call);
    const Requester::Scope scope(&caller);
    const int code = run_chosen(prepared->parser.command(), prepared->actions);
    if (caller.stopped()) throw Stopped();
    bool wrote = false;
    Answer answer = caller.take(code, wrote);
    if (!wrote && code != kFine) {
      if (!answer.errors.empty()) return tl::unexpected(answer.errors.front());
      return bad_data(fmt::format("'mbk {}' ended with exit code {}", call.command, code));
    }
    answer.json = prepared->json;
    return answer;
  });
}

std::vector<std::pair<std::string, std::string>> warnings_of(const Answer& answer) {
  // A document may be long: only its lists of warnings are parsed.
  constexpr std::string_view kKey = "\"warnings\": [";
  std::vector<std::pair<std::string, std::string>> warnings;
  if (!answer.json) return warnings;
  const std::string_view text = answer.text;
  const auto text_of = [](const nlohmann::json& warning, const char* key) {
    const auto found = warning.find(key);
    return found != warning.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  for (std::size_t at = text.find(kKey); at != std::string_view::npos; at = text.find(kKey, at)) {
    const std::size_t begin = at + kKey.size() - 1;
    const bool quoted = at > 0 && text[at - 1] == '\\';  // the end of a name that says so
    at = quoted ? begin : end_of_list(text, begin);
    if (quoted) continue;
    for (const nlohmann::json& one : nlohmann::json::parse(text.substr(begin, at - begin), nullptr, false)) {
      if (!one.is_object()) continue;
      const std::string advice = text_of(one, "try");
      warnings.emplace_back(text_of(one, "code"), text_of(one, "message") + (advice.empty() ? "" : "; " + advice));
    }
  }
  return warnings;
}

Result<std::vector<std::shared_ptr<const recording::InMemory>>> read(const Call& call) {
  ReadRequest reading;
  SensorRequest sensor;
  const Parser parser("read");
  add_reading_options(parser.command(), reading);
  add_sensor_options(parser.command(), sensor);
  if (holds_zero(call)) return bad_usage("a text contains a zero byte", "remove it");
  auto typed = MBK_TRY(typed_words(parser.command(), call, all_words(call)));
  MBK_TRY(parse(parser, std::move(typed), ""));
  return guarded([&]() -> Result<std::vector<std::shared_ptr<const recording::InMemory>>> {
    Caller caller(call);
    const Requester::Scope scope(&caller);
    const auto reader = MBK_TRY(open_recordings(reading, sensor));
    std::vector<std::shared_ptr<const recording::InMemory>> recordings;
    for (int k = 0; k < reader.count(); ++k) {
      stop_if_cancelled();
      auto one = MBK_TRY(reader.read(k));
      recordings.push_back(std::make_shared<const recording::InMemory>(recording::InMemory::of(std::move(one))));
    }
    return recordings;
  });
}

bool can_be_called(std::string_view command) {
  return std::ranges::find(kNotCallable, command.substr(0, command.find(' '))) == kNotCallable.end();
}

std::string describe_commands() {
  const Parser parser("mbk");
  add_help(parser.command());
  const Actions unused = add_commands("", parser.command(), "");
  return commands_json(describe(parser.command()));
}

}  // namespace mbk::app
