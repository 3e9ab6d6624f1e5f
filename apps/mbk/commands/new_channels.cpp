#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "apps/mbk/commands/new_commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/report_file.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/questions.h"
#include "apps/mbk/terminal/terminal.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/files/recording/channel_map.h"
#include "mbk/files/recording/guess_channels.h"
#include "mbk/files/recording/read.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/result_charts.h"

namespace mbk::app {
namespace {

struct NewChannelsArguments {
  std::filesystem::path file;
  std::optional<double> rate_hz;
  double seconds = 3.0;
  bool yes = false;
  Output output;
};

/// The first signals, each with its range.
std::string signals_text(const std::vector<recording::FileSignal>& signals) {
  constexpr std::size_t kShown = 40;
  std::string text;
  for (std::size_t k = 0; k < std::min(kShown, signals.size()); ++k) {
    const recording::FileSignal& one = signals[k];
    text += fmt::format("  {:<12}  {:<24}  {:.4g} to {:.4g}\n", one.source, one.name, one.values.minCoeff(),
                        one.values.maxCoeff());
  }
  if (signals.size() > kShown) text += fmt::format("  and {} more\n", signals.size() - kShown);
  return text;
}

Result<Recording> read_with(const recording::RecordingFile& file, const NewChannelsArguments& arguments,
                            const std::string& map) {
  recording::ReadOptions options;
  auto channels = MBK_TRY(recording::parse_channel_map(map));
  options.channels = std::move(channels);
  if (arguments.rate_hz) options.rate = Hertz(*arguments.rate_hz);
  return recording::read(file, options);
}

/// Shows what a person needs to see before answering.
void tell(const std::string& text) {
  say_text(for_people(text, terminal_at(STDERR_FILENO)));
}

int run(const NewChannelsArguments& arguments) {
  if (auto ok = arguments.output.check({arguments.file}); !ok) return report_error(ok.error());
  const auto file = recording::open(arguments.file);
  if (!file) return report_error(file.error());
  const auto contents = recording::read_contents(**file);
  if (!contents) return report_error(contents.error());
  const auto signals = recording::signals_of(*contents);
  if (signals.empty()) {
    return report_error({ErrorKind::data, "the file contains no signal that a channel map can name",
                         "see 'mbk info' for its contents", arguments.file.string()});
  }
  tell(fmt::format("{}, {}\n{}", arguments.file.string(), contents->format, signals_text(signals)));
  const recording::ChannelGuess guess = recording::guess_channels(signals);
  std::string text = guess.reasons.empty() ? "" : "guessed\n";
  for (const std::string& reason : guess.reasons) text += "  " + reason + "\n";
  if (!guess.missing.empty()) text += fmt::format("  not recognised: {}\n", fmt::join(guess.missing, ", "));
  tell(text +
       "Two axes have x, y, Fx, Fy and the reference xr, yr; one axis has x, F, xr. x=2:mm converts a unit, Fx=-4 "
       "reverses "
       "a sign.\n");

  std::optional<Recording> recording;
  const auto check = [&](const std::string& map) -> std::string {
    auto read = read_with(**file, arguments, map);
    if (!read) return read.error().line();
    recording = std::move(*read);
    return "";
  };
  const auto map = Questions(arguments.yes).ask("channels", guess.missing.empty() ? guess.map : "", check);
  if (!map) return report_error(map.error().in(arguments.file.string()));
  for (const Chart& chart : report::first_seconds(*recording, arguments.seconds))
    tell("\n" + report::chart_text(chart));
  tell("The force must be that of the hand on the robot; 'mbk measure' reports a reversed sign.\n");
  const std::string rate = arguments.rate_hz ? fmt::format(" --rate {:g}", *arguments.rate_hz) : "";
  const std::string line = fmt::format("--channels {}{}", shell_word(*map), rate);
  tell(fmt::format("next: mbk measure {} {}\n", shell_word(arguments.file.string()), line));
  if (auto ok = arguments.output.write(line + "\n", {arguments.file}); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_new_channels(Command group) {
  auto arguments = std::make_shared<NewChannelsArguments>();
  const Command command =
      group.add_command("channels", "find which column of a file is which channel; prints the option --channels");
  command.footer(
      "Examples:\n"
      "  mbk new channels log.csv\n"
      "      lists the columns, guesses from their names, asks, and plots the first seconds\n"
      "  mbk measure log.csv $(mbk new channels log.csv --yes)\n"
      "      accepts the guess; fails if there is none\n"
      "  echo time=1:ms,x=2:mm,F=5 | mbk new channels log.csv --out channels.txt\n\n"
      "Questions and plots go to standard error, the option alone to standard output. The map is printed\n"
      "only after the file was read with it.");
  command.add_option("FILE", arguments->file, "a recording whose columns or variables mbk does not know: .csv, .mat, …")
      .required();
  command.add_option("--rate", arguments->rate_hz, "sample rate, in Hz, if the file contains no time")
      .type_name("HZ")
      .check(positive());
  command.add_option("--seconds", arguments->seconds, "length of the plots, in seconds (default: 3)")
      .type_name("S")
      .check(positive());
  command.add_flag("--yes", arguments->yes, "ask no questions; accept the guess");
  arguments->output.add_options(command);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
