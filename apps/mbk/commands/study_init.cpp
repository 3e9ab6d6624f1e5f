#include <fmt/format.h>

#include <memory>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/options/study_options.h"
#include "apps/mbk/options/table_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/printable.h"

namespace mbk::app {
namespace {

struct InitArguments {
  StudyArguments study;
  std::filesystem::path folder;
  std::string title;
  request::MeasureRequest measuring;
};

/// The given options, if a study can store them.
Result<std::string> kept_options(Command command) {
  const OptionTexts given = given_options(command, workflow::measuring_table());
  if (workflow::names_files(given)) {
    return bad_usage("--robot and --sensor name files, which a study does not store",
                     "pass them to 'mbk study measure'");
  }
  MBK_TRY(workflow::measuring_of(given));
  return workflow::options_to_json(given);
}

int run_init(Command command, const InitArguments& arguments) {
  const auto options = kept_options(command);
  if (!options) return report_error(options.error());
  const store::StudyFacts facts{printable(arguments.title), *options};
  if (auto ok = store::Store::create(arguments.folder, facts, arguments.study.role); !ok) {
    return report_error(ok.error());
  }
  if (auto ok = print_text(fmt::format("{}: a new study\n", arguments.folder.string())); !ok) {
    return report_error(ok.error());
  }
  return kFine;
}

int run_defaults(Command command, const InitArguments& arguments) {
  const auto options = kept_options(command);
  if (!options) return report_error(options.error());
  auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  if (!given_options(command, workflow::measuring_table()).empty()) {
    if (auto ok = study->set_options(*options, arguments.study.role); !ok) return report_error(ok.error());
  }
  const auto stored = workflow::default_options(*study);
  if (!stored) return report_error(stored.error());
  const std::string text = typed_text(*stored);
  if (auto ok = print_text((text.empty() ? "none: as 'mbk measure' without options" : text) + "\n"); !ok) {
    return report_error(ok.error());
  }
  return kFine;
}

}  // namespace

Action add_study_init(Command group) {
  auto arguments = std::make_shared<InitArguments>();
  const Command command = group.add_command("init", "create a new study in its own folder");
  command.footer(
      "Examples:\n"
      "  mbk study init arms --title \"Stiffness at rest\"\n"
      "  mbk study init ankles --axes 1 --channels x=position_rad,F=torque_Nm --protocol free\n"
      "      also sets the default options for reading and measuring its recordings\n\n"
      "Only the owner can read the folder. Create it on a local disk: network file systems do not lock\n"
      "files as the database requires.");
  command.add_option("FOLDER", arguments->folder, "folder of the study, which must be new or empty").required();
  command.add_option("--title", arguments->title, "title, one line; do not name a person")
      .type_name("TEXT")
      .check(not_empty());
  add_choice_of_role(command, arguments->study);
  add_measuring_options(command, arguments->measuring);
  return [command, arguments] { return run_init(command, *arguments); };
}

Action add_study_defaults(Command group) {
  auto arguments = std::make_shared<InitArguments>();
  const Command command = group.add_command("defaults", "show or change the default options for measuring recordings");
  command.footer(
      "Examples:\n"
      "  mbk study defaults\n"
      "      shows the defaults\n"
      "  mbk study defaults --mode reference --protocol sinusoidal\n"
      "      replaces all defaults; the next 'mbk study measure' measures everything with these");
  add_study_and_role(command, arguments->study);
  add_measuring_options(command, arguments->measuring);
  return [command, arguments] { return run_defaults(command, *arguments); };
}

}  // namespace mbk::app
