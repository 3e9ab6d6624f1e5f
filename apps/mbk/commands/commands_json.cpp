#include "apps/mbk/commands/commands_json.h"

#include "apps/mbk/call.h"

namespace mbk::app {

using document::Fields;
using document::through;

void describe(Fields<OptionText>& fields) {
  const auto is_option = [](const OptionText& option) { return !option.names.empty(); };
  fields.type("Option", "An option, a flag or an argument, as --help describes it.");
  fields.add_unless_empty("names", &OptionText::names, "\"-h\", \"--help\"; absent for an argument");
  fields.add("value", &OptionText::value, "placeholder, such as HZ or default|reference; empty for a flag");
  fields.add("description", &OptionText::description);
  fields.add_if(is_option, "group", &OptionText::group, "heading of --help above it");
  fields.add("required", &OptionText::required);
  fields.add("repeats", &OptionText::repeats, "takes several values, or may be given several times");
  fields.add("needs", &OptionText::needs, "options that must be given with it");
  fields.add("excludes", &OptionText::excludes, "options that must not be given with it");
  fields.add("words", through(&OptionText::values, &Values::words), "fixed values");
  fields.add("files", through(&OptionText::values, &Values::files), "a value may be the name of a file");
  fields.add("folders", through(&OptionText::values, &Values::folders), "a value is the name of a folder");
  fields.add("extensions", through(&OptionText::values, &Values::extensions),
             "of those files, without the dot; empty: any");
}

void describe(Fields<CommandText>& fields) {
  using From = const CommandText&;
  fields.type("Command");
  fields.add(
      "path", [](From one) { return std::vector<std::string>(one.path.begin() + 1, one.path.end()); },
      "words of the command line: \"springs\", \"field\"");
  fields.add("summary", &CommandText::description);
  fields.add("footer", &CommandText::footer, "examples and exit codes");
  fields.add(
      "callable", [](From one) { return one.commands.empty() && can_be_called(one.path[1]); },
      "whether it can be called in a process, as from Python, MATLAB and C; false for a command that has subcommands, "
      "and for those that need their own process");
  fields.add("arguments", &CommandText::positionals);
  fields.add("options", &CommandText::options);
}

namespace {

struct Commands {
  std::vector<const CommandText*> commands;
};

void describe(Fields<Commands>& fields) {
  fields.type("Commands",
              "Output of `mbk manual --json`: every command with its arguments and options, as --help lists them. The "
              "functions in other languages are generated from it.");
  fields.header("mbk.commands/1");
  fields.add("commands", &Commands::commands);
}

}  // namespace

std::string commands_json(const CommandText& root) {
  Commands all;
  for_each_command(root, [&](const CommandText& command) {
    if (command.path.size() > 1) all.commands.push_back(&command);
  });
  return document::document(all);
}

void add_commands_schema(document::Schemas& schemas) {
  schemas["commands"] = document::schema_of<Commands>();
}

}  // namespace mbk::app
