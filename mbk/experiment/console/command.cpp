#include "mbk/experiment/console/command.h"

#include <fmt/format.h>

#include <cstdint>
#include <set>
#include <string>

#include "mbk/experiment/console/messages.h"

namespace mbk::console {
namespace {

constexpr std::uint64_t kMaxAttempt = 1'000'000;

tl::unexpected<Error> refused(std::string message) {
  return bad_usage(std::move(message), "reload the page");
}

/// The JSON of a message in which no object has a key twice and nothing is nested; else why not.
Result<nlohmann::json> parse(std::string_view text) {
  using Json = nlohmann::json;
  std::set<std::string> keys;
  std::string twice;
  bool nested = false;
  const auto look = [&](int depth, Json::parse_event_t event, Json& parsed) {
    using Event = Json::parse_event_t;
    nested = nested || (depth > 0 && (event == Event::object_start || event == Event::array_start));
    if (event == Event::key) {
      const auto& key = parsed.get_ref<const std::string&>();
      if (!nested && !keys.insert(key).second) twice = key;
    }
    return !nested;
  };
  auto message = Json::parse(text, look, false);
  if (nested) return refused("a message has a list or an object in it");
  if (!message.is_object()) return refused("a message is no JSON object");
  if (!twice.empty()) return refused(fmt::format("a message has '{:.40}' twice", twice));
  return message;
}

/// Whether a command has the key.
bool knows(Action action, std::string_view key) {
  switch (action) {
    case Action::note:
      return key == "text";
    case Action::reset:
      return key == "code";
    case Action::exclude:
      return key == "text" || key == "attempt" || key == "from_s" || key == "to_s";
    case Action::include:
      return key == "attempt";
    default:
      return false;
  }
}

}  // namespace

void describe(document::Fields<Command>& fields) {
  const auto known = [](std::string_view key) {
    return [key](const Command& command) { return knows(command.action, key); };
  };
  const auto end = [](double Window::*of) {
    return
        [of](const Command& command) { return command.window ? std::optional((*command.window).*of) : std::nullopt; };
  };
  fields.type("ConsoleCommand", "What a page tells the console of `mbk run`.");
  fields.add("command", &Command::action);
  fields.add_if(known("text"), "text", &Command::text, "of a note; why something is excluded");
  fields.add_if(known("code"), "code", &Command::text, "of a reset: the one that a state holds");
  fields.add_if(known("attempt"), "attempt", &Command::attempt, "of what is excluded or included: its number");
  fields.add_number("from_s", end(&Window::from),
                    "of the window that is excluded, where it is not the whole trial [s]");
  fields.add_number("to_s", end(&Window::to), "[s]");
}

Result<Command> parse_command(std::string_view json) {
  const auto parsed = MBK_TRY(parse(json));
  const auto& message = parsed;
  const auto named = message.find("command");
  if (named == message.end() || !named->is_string()) return refused("a message names no command");
  const auto& name = named->get_ref<const std::string&>();
  const auto action = value_of<Action>(name);
  if (!action) return refused(fmt::format("unknown command '{:.40}'", name));

  Command command;
  command.action = *action;
  for (const auto& [key, value] : message.items()) {
    if (key == "command") continue;
    if (!knows(*action, key)) return refused(fmt::format("'{}' has no '{:.40}'", name, key));
    const bool text = key == "text" || key == "code";
    if (text && !value.is_string()) return refused(fmt::format("the {} of '{}' is no text", key, name));
    if (!text && !value.is_number()) return refused(fmt::format("the {} of '{}' is no number", key, name));
  }
  for (const char* const key : {"text", "code"}) {
    if (message.contains(key)) command.text = message.at(key).get<std::string>();
  }
  if (command.text.size() > kLongestNote) return refused(fmt::format("a text is longer than {} bytes", kLongestNote));
  if (knows(*action, "text") && command.text.find_first_not_of(" \t\r\n") == std::string::npos) {
    return refused(fmt::format("the text of '{}' is empty", name));
  }
  if (knows(*action, "attempt")) {
    const auto attempt = message.find("attempt");
    if (attempt == message.end() || !attempt->is_number_unsigned() || attempt->get<std::uint64_t>() == 0 ||
        attempt->get<std::uint64_t>() > kMaxAttempt) {
      return refused(fmt::format("the attempt of '{}' is no number from 1 on", name));
    }
    command.attempt = attempt->get<int>();
  }
  if (message.contains("from_s") != message.contains("to_s")) return refused("a window has one end");
  if (message.contains("from_s")) {
    command.window = Window{message.at("from_s").get<double>(), message.at("to_s").get<double>()};
    const auto [from, to] = *command.window;
    if (!(from >= 0.0 && to > from)) return refused(fmt::format("the window {:g} to {:g} s is empty", from, to));
  }
  return command;
}

}  // namespace mbk::console
