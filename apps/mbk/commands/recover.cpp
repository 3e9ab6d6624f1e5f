#include <fmt/format.h>

#include <memory>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/readers_option.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/experiment/session/session.h"
#include "mbk/present/report/text.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;

struct RecoverArguments {
  fs::path journal, out;
  session::RecoverOptions options;
};

std::string paragraph(std::string_view first, std::string_view text) {
  constexpr std::size_t kIndent = 4;
  std::string lines = fmt::format("  {} {}", first, report::wrapped(text, report::kLineColumns - kIndent));
  for (std::size_t at = lines.find('\n'); at != lines.npos; at = lines.find('\n', at + 1))
    lines.insert(at + 1, kIndent, ' ');
  return lines + '\n';
}

std::string outcome_text(const session::Recovered& recovered, const RecoverArguments& arguments, const fs::path& out) {
  const Recording& recording = recovered.recording;
  const auto& metadata = recording.metadata;
  const auto detail = metadata.find("ended_detail");
  std::string text = fmt::format("{}: {} samples, {:.3f} s; {}{}\n", out.string(), recording.samples(),
                                 recording.time[recording.samples() - 1], metadata.at("ended"),
                                 detail == metadata.end() ? "" : ": " + detail->second);
  if (!recovered.damage.any()) return text;
  for (const std::string& sentence : recovered.damage.sentences()) text += paragraph("!", sentence);
  if (!recovered.damage.lost.empty()) text += "  the recording contains a row of NaN for each missing tick\n";
  return text + fmt::format("  the journal is kept: {}\n", arguments.journal.string());
}

int run(const RecoverArguments& arguments) {
  fs::path out = arguments.out;
  if (out.empty()) {
    out = arguments.journal;
    if (out.extension() == ".journal")
      out.replace_extension();
    else
      out += ".h5";
  }
  const auto recovered = session::recover(arguments.journal, out, arguments.options);
  if (!recovered) return report_error(recovered.error());
  if (auto ok = print_text(outcome_text(*recovered, arguments, out)); !ok) return report_error(ok.error());
  if (!recovered->incomplete) return kFine;
  return report_error({ErrorKind::data, recovered->recording.metadata.at("ended"),
                       "run 'mbk info' on the recording to see where; keep the journal", out.string()});
}

}  // namespace

Action add_recover(Command app) {
  auto arguments = std::make_shared<RecoverArguments>();
  const Command command =
      app.add_command("recover", "recover the recording of an interrupted session from its journal");
  command.footer(
      "Examples:\n"
      "  mbk recover p07_relaxed.h5.journal\n"
      "      writes p07_relaxed.h5, then removes the journal\n"
      "  mbk recover p07_relaxed.h5.journal --out p07.mat --keep\n\n"
      "Every block of the journal has a checksum, and its ticks are numbered. Every intact block is\n"
      "recovered, wherever it is. A missing tick becomes a row of NaN and is reported, here and in the\n"
      "recording ('ended', 'ticks_lost', 'gaps'; see 'mbk info'). A damaged journal is never removed.\n\n"
      "Exit codes: 0 fine, 2 wrong usage, 3 bad or unreadable data, or lost ticks (the recording contains\n"
      "the others).");
  command.add_option("JOURNAL", arguments->journal, "journal of the session: NAME.h5.journal").required();
  command.add_option("--out", arguments->out, "recording to write (default: NAME.h5)")
      .type_name("REC")
      .check(not_empty());
  command.add_flag("--overwrite", arguments->options.overwrite, "replace an existing recording");
  command.add_flag("--keep", arguments->options.keep, "keep the journal");
  add_readers_option(command, arguments->options.readers);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
