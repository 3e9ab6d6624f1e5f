#include <fmt/format.h>

#include <memory>

#include "apps/mbk/commands.h"
#include "apps/mbk/option_checks.h"
#include "apps/mbk/output.h"
#include "mbk/session/session.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path journal, out;
  bool overwrite = false, keep = false;
};

int run(const Arguments& arguments) {
  fs::path out = arguments.out;
  if (out.empty()) {
    out = arguments.journal;
    if (out.extension() == ".journal")
      out.replace_extension();
    else
      out += ".h5";
  }
  const auto recording = session::recover(arguments.journal, out, arguments.overwrite, arguments.keep);
  if (!recording) return report_error(recording.error());
  const auto& metadata = recording->metadata;
  const auto detail = metadata.find("ended_detail");
  const std::string text = fmt::format("{}: {} samples, {:.3f} s; {}{}\n", out.string(), recording->samples(),
                                       recording->time[recording->samples() - 1], metadata.at("ended"),
                                       detail == metadata.end() ? "" : ": " + detail->second);
  if (auto ok = Output().write(text); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_recover(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("recover", "make the recording of a session that was cut off");
  command->footer(
      "Examples:\n"
      "  mbk recover p07_relaxed.h5.journal\n"
      "      writes p07_relaxed.h5 and then removes the journal\n"
      "  mbk recover p07_relaxed.h5.journal --out p07.mat --keep\n\n"
      "Every block of the journal has a checksum; what is whole comes back, and what is not is left out and said.\n"
      "'mbk info' of the recording says how it ended.");
  command->add_option("JOURNAL", arguments->journal, "NAME.h5.journal, beside where the recording should be")
      ->required();
  command->add_option("--out", arguments->out, "the recording to write (NAME.h5)")
      ->type_name("REC")
      ->check(not_empty());
  command->add_flag("--overwrite", arguments->overwrite, "replace a recording that is there");
  command->add_flag("--keep", arguments->keep, "leave the journal where it is");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
