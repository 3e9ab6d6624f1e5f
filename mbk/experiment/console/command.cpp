#include "mbk/experiment/console/command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace mbk::console {
namespace {

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

}  // namespace

Result<Command> parse_command(std::string_view json) {
  const auto parsed = parse(json);
  if (!parsed) return tl::unexpected(parsed.error());
  const auto& message = *parsed;
  const auto named = message.find("command");
  if (named == message.end() || !named->is_string()) return refused("a message names no command");
  const auto& name = named->get_ref<const std::string&>();
  const auto action = value_of<Action>(name);
  if (!action) return refused(fmt::format("unknown command '{:.40}'", name));

  Command command{*action, {}};
  const char* const key = command.action == Action::note ? "text" : command.action == Action::reset ? "code" : nullptr;
  for (const auto& [other, value] : message.items()) {
    if (other == "command") continue;
    if (key == nullptr || other != key) return refused(fmt::format("'{}' has no '{:.40}'", name, other));
    if (!value.is_string()) return refused(fmt::format("the {} of '{}' is no text", key, name));
    command.text = value.get<std::string>();
  }
  if (command.text.size() > kLongestNote) return refused(fmt::format("a text is longer than {} bytes", kLongestNote));
  if (command.action == Action::note && command.text.find_first_not_of(" \t\r\n") == std::string::npos) {
    return refused("a note is empty");
  }
  return command;
}

}  // namespace mbk::console
