#include "apps/mbk/commands/commands_json.h"

#include <nlohmann/json.hpp>

#include "apps/mbk/call.h"

namespace mbk::app {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson option_json(const OptionText& option) {
  OrderedJson json;
  if (!option.names.empty()) json["names"] = option.names;
  json["value"] = option.value;
  json["description"] = option.description;
  if (!option.names.empty()) json["group"] = option.group;
  json["required"] = option.required;
  json["repeats"] = option.repeats;
  json["needs"] = option.needs;
  json["excludes"] = option.excludes;
  json["words"] = option.values.words;
  json["files"] = option.values.files;
  json["folders"] = option.values.folders;
  json["extensions"] = option.values.extensions;
  return json;
}

OrderedJson command_json(const CommandText& command) {
  OrderedJson json;
  json["path"] = std::vector<std::string>(command.path.begin() + 1, command.path.end());  // without "mbk"
  json["summary"] = command.description;
  json["footer"] = command.footer;
  json["callable"] = command.commands.empty() && can_be_called(command.path[1]);
  json["arguments"] = OrderedJson::array();
  for (const OptionText& positional : command.positionals) json["arguments"].push_back(option_json(positional));
  json["options"] = OrderedJson::array();
  for (const OptionText& option : command.options) json["options"].push_back(option_json(option));
  return json;
}

}  // namespace

std::string commands_json(const CommandText& root, const std::string& version) {
  OrderedJson json;
  json["schema"] = "mbk.commands/1";
  json["software"] = "mbk " + version;
  json["commands"] = OrderedJson::array();
  for_each_command(root, [&](const CommandText& command) {
    if (command.path.size() > 1) json["commands"].push_back(command_json(command));
  });
  return json.dump(2) + "\n";
}

}  // namespace mbk::app
