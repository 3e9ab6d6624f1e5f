#include "mbk/console/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace mbk::console {
namespace {

struct Name {
  Action action;
  std::string_view name;
};

constexpr std::array<Name, 8> kNames = {{{Action::stop, "stop"},
                                         {Action::end, "end"},
                                         {Action::start, "start"},
                                         {Action::repeat, "repeat"},
                                         {Action::next, "next"},
                                         {Action::abort, "abort"},
                                         {Action::reset, "reset"},
                                         {Action::note, "note"}}};

tl::unexpected<Error> refused(std::string message) {
  return bad_usage(std::move(message), "reload the page");
}

}  // namespace

std::string_view text(Action action) {
  return std::ranges::find(kNames, action, &Name::action)->name;
}

Result<Command> parse_command(std::string_view json) {
  const auto message = nlohmann::json::parse(json, nullptr, false);
  if (!message.is_object()) return refused("a message is no JSON object");
  const auto named = message.find("command");
  if (named == message.end() || !named->is_string()) return refused("a message names no command");
  const auto& name = named->get_ref<const std::string&>();
  const auto* const found = std::ranges::find(kNames, name, &Name::name);
  if (found == kNames.end()) return refused(fmt::format("there is no command '{:.40}'", name));

  Command command{found->action, {}};
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
