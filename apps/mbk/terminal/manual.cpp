#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/commands/commands_json.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/terminal/manual_page.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/version.h"
#include "mbk/files/recording/write_file.h"

namespace mbk::app {
namespace {

struct ManualArguments {
  std::vector<std::string> command;
  std::optional<std::filesystem::path> pages;
  bool json = false, overwrite = false;
};

/// The command that the words name, from `root` down; nullptr if there is none.
const CommandText* find_command(const CommandText& root, const std::vector<std::string>& words) {
  const CommandText* at = &root;
  for (const std::string& word : words) {
    const auto below = std::ranges::find(at->commands, word, &CommandText::name);
    if (below == at->commands.end()) return nullptr;
    at = &*below;
  }
  return at;
}

/// Every page as a file of its own.
int write_pages(const CommandText& root, const std::filesystem::path& folder, bool overwrite) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return report_error({ErrorKind::usage, error.message(), "name a folder that can be created", folder.string()});
  }
  Result<void> written;
  for_each_command(root, [&](const CommandText& command) {
    if (!written) return;
    written = recording::write_file(folder / manual_file(command), overwrite,
                                    manual_page(command, root, std::string(version())));
  });
  return written ? kFine : report_error(written.error());
}

int run(const ManualArguments& arguments, Command app) {
  const CommandText root = describe(app);
  if (arguments.json) {
    if (auto ok = print_text(commands_json(root)); !ok) return report_error(ok.error());
    return kFine;
  }
  if (arguments.pages) {
    if (arguments.command.empty()) return write_pages(root, *arguments.pages, arguments.overwrite);
    return report_error(
        {ErrorKind::usage, "--pages writes every page, but COMMAND names one", "omit COMMAND or --pages", ""});
  }
  const CommandText* const command = find_command(root, arguments.command);
  if (command == nullptr) {
    return report_error(
        {ErrorKind::usage,
         fmt::format("unknown command {}", quoted(fmt::format("{}", fmt::join(arguments.command, " ")))),
         "see 'mbk --help'", ""});
  }
  if (auto ok = print_text(manual_page(*command, root, std::string(version()))); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_manual(Command app) {
  auto arguments = std::make_shared<ManualArguments>();
  const Command command = app.add_command("manual", "print the manual page of a command, for man");
  command.footer(
      "Examples:\n"
      "  mbk manual measure | man -l -\n"
      "  mbk manual springs field | man -l -\n"
      "  mbk manual --pages ~/.local/share/man/man1\n"
      "      writes every page to a folder where man finds them: man mbk-measure\n"
      "  mbk manual --json\n"
      "      prints every command with its options, for programs that call mbk\n\n"
      "If mbk was installed from a package or with 'cmake --install', the pages are already installed.");
  const Option named =
      command.add_option("COMMAND", arguments->command, "the command, as it is typed (default: mbk itself)")
          .check(suggests(names_below(app)));
  const Option pages =
      command.add_option("--pages", arguments->pages, "write every page to this folder, as mbk-measure.1 and so on")
          .type_name("FOLDER")
          .check(not_empty());
  command.add_flag("--overwrite", arguments->overwrite, "replace existing pages").needs(pages);
  command.add_flag("--json", arguments->json, "print every command with its options as JSON: schema mbk.commands/1")
      .excludes(named)
      .excludes(pages);
  return [arguments, app] { return run(*arguments, app); };
}

}  // namespace mbk::app
