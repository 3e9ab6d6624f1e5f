#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

#include "apps/mbk/commands/new_commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/report_file.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/questions.h"
#include "apps/mbk/terminal/terminal.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/printable.h"
#include "mbk/base/system/terminal.h"
#include "mbk/files/recording/channel_map.h"
#include "mbk/files/recording/guess_channels.h"
#include "mbk/files/recording/read.h"
#include "mbk/files/recording/si_units.h"
#include "mbk/present/report/braille.h"
#include "mbk/present/report/picture.h"

namespace mbk::app {
namespace {

struct NewChannelsArguments {
  std::filesystem::path file;
  std::optional<double> rate_hz;
  double seconds = 3.0;
  bool yes = false;
  Output output;
};

using recording::ChannelGuess;
using recording::FileSignal;
using Signals = std::vector<FileSignal>;

/// "4 Hand force X [N]", in at most 20 columns.
std::string column_text(const FileSignal& signal) {
  constexpr std::size_t kWidest = 20;
  const bool named = signal.name == signal.source || signal.name.starts_with(signal.source + " (");
  const std::string text =
      printable(named ? signal.name : signal.source + (signal.name.empty() ? "" : " ") + signal.name);
  return report::columns(text) > kWidest ? fmt::format("{:.{}}…", text, kWidest - 1) : text;
}

std::string range_text(const Vector& values) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return low > high ? "no numbers" : fmt::format("{:.3g} to {:.3g}", low, high);
}

/// Samples in the first seconds; all of them if neither a time nor a rate is known.
Index drawn_samples(const Signals& signals, const ChannelGuess& guess, const NewChannelsArguments& arguments) {
  constexpr Index kAll = std::numeric_limits<Index>::max();
  if (arguments.rate_hz) return static_cast<Index>(std::min(arguments.seconds * *arguments.rate_hz, 1e15)) + 1;
  const auto time = std::ranges::find(guess.channels, "time", &recording::GuessedChannel::channel);
  if (time == guess.channels.end()) return kAll;
  const Vector& values = signals[time->signal].values;
  const recording::Unit& unit = *recording::find_unit(time->unit.empty() ? "s" : time->unit);
  Index samples = 0;
  while (samples < values.size() && unit.to_si(values[samples] - values[0]) <= arguments.seconds) ++samples;
  return samples;
}

/// A line for each guessed channel, each missing one, and the other signals as far as a screen of 24 lines has room.
std::string guess_text(const Signals& signals, const ChannelGuess& guess, const NewChannelsArguments& arguments) {
  constexpr std::size_t kLines = 13;
  const Index drawn = drawn_samples(signals, guess, arguments);
  const bool all = drawn >= signals.front().values.size();
  const auto line = [&](const std::string& role, const FileSignal& signal, const std::string& unit,
                        const std::string& why) {
    constexpr int kCharacters = 14;
    const Vector& values = signal.values;
    return fmt::format("  {:<5} {:<20}  {:<4}  {:<20}  {}{}\n", role, column_text(signal), unit, range_text(values),
                       report::sparkline(values.head(std::min(drawn, values.size())), kCharacters), why);
  };
  std::string text = fmt::format("  {:<5} {:<20}  {:<4}  {:<20}  {:<14}  {}\n", "", "column", "unit", "range",
                                 all ? "all samples" : fmt::format("first {:.3g} s", arguments.seconds), "by");
  std::vector<bool> used(signals.size(), false);
  bool by_size = false;
  for (const recording::GuessedChannel& one : guess.channels) {
    const std::string unit = one.unit.empty() ? "SI" : one.unit + (one.unit_by_size ? "?" : "");
    text += line(one.channel, signals[one.signal], unit, "  " + one.why);
    used[one.signal] = true;
    by_size = by_size || one.unit_by_size;
  }
  for (const std::string& channel : guess.missing) text += fmt::format("  {:<5} not recognised\n", channel);
  std::size_t lines = guess.channels.size() + guess.missing.size(), more = 0;
  for (std::size_t k = 0; k < signals.size(); ++k) {
    if (used[k]) continue;
    if (++lines > kLines) {
      ++more;
    } else {
      text += line("", signals[k], "", "");
    }
  }
  if (more > 0) text += fmt::format("  and {} columns more: see 'mbk info'\n", more);
  if (by_size) text += "  ? unit assumed from the size of the numbers\n";
  return text;
}

/// The guess with the channels of an answer changed. An answer with position and force replaces all but the time.
/// @fails  as `parse_channel_map`
Result<std::string> answered_map(const ChannelGuess& guess, const std::string& answer, bool has_rate) {
  const auto given = MBK_TRY(recording::parse_channel_map(answer));
  const auto names = [&](std::initializer_list<std::string_view> channels, std::string_view joint) {
    return std::ranges::any_of(given, [&](const recording::ChannelSource& one) {
      return std::ranges::find(channels, one.channel) != channels.end() || one.channel.starts_with(joint);
    });
  };
  const bool complete = names({"x", "hand_x", "position"}, "joint_") && names({"force_x", "reaction"}, "torque_");
  std::string map;
  for (const recording::GuessedChannel& one : guess.channels) {
    if (complete && (one.channel != "time" || has_rate)) continue;
    const auto guessed = MBK_TRY(recording::parse_channel_map(one.entry));
    const std::string& channel = guessed.front().channel;
    if (std::ranges::find(given, channel, &recording::ChannelSource::channel) == given.end()) map += one.entry + ",";
  }
  return map + answer;
}

/// " --axes 3" for a map with position and force along z, without which two axes are measured.
/// @fails  as `parse_channel_map`
Result<std::string> axes_option(const std::string& map) {
  const auto channels = MBK_TRY(recording::parse_channel_map(map));
  const auto names = [&](std::string_view name) {
    return std::ranges::find(channels, name, &recording::ChannelSource::channel) != channels.end();
  };
  return std::string(names("hand_z") && names("force_z") ? " --axes 3" : "");
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
  say_text(for_people(text, terminal_at(system::kError)));
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
  const ChannelGuess guess = recording::guess_channels(signals);
  tell(fmt::format("{}   {}\n\n{}", arguments.file.string(), contents->format, guess_text(signals, guess, arguments)));
  const bool by_person = system::is_terminal(system::kInput);
  const bool ask = !arguments.yes && (by_person || std::cin.peek() != std::istream::traits_type::eof());
  if (!ask && !guess.missing.empty()) {
    return report_error(
        {ErrorKind::usage, fmt::format("not recognised: {}", fmt::join(guess.missing, ", ")),
         "answer in a terminal without --yes, or pipe the answer, as in: echo x=2,F=3 | mbk new channels",
         arguments.file.string()});
  }
  if (ask) {
    tell(fmt::format(
        "\nF is the force of the hand on the robot; Fx=-4 reverses it, x=2:mm has a unit.\n"
        "Two axes: x, y, Fx, Fy, reference xr, yr; a third: z, Fz, zr. One: x, F, xr.\n{}\n",
        guess.missing.empty() ? "Enter accepts; or type what to change, e.g. Fx=4,Fy=5"
                              : fmt::format("Type what is missing or wrong, e.g. {}=3", guess.missing.front())));
  }

  constexpr const char* kAccept = "as shown";
  std::string map;
  const auto check = [&](const std::string& answer) -> std::string {
    auto meant =
        answer == kAccept ? Result<std::string>(guess.map) : answered_map(guess, answer, arguments.rate_hz.has_value());
    if (!meant) return meant.error().line();
    map = std::move(*meant);
    const auto read = read_with(**file, arguments, map);
    return read ? "" : read.error().line();
  };
  const auto answer = Questions(!ask).ask("channels", guess.missing.empty() ? kAccept : "", check);
  if (!answer) {
    const std::string name = arguments.file.string();
    const bool named = answer.error().line().find(name) != std::string::npos;
    return report_error(named ? answer.error() : answer.error().in(name));
  }
  const std::string rate = arguments.rate_hz ? fmt::format(" --rate {:g}", *arguments.rate_hz) : "";
  const auto axes = axes_option(map);
  if (!axes) return report_error(axes.error());
  const std::string option = fmt::format("--channels {}{}{}", shell_word(map), rate, *axes);
  say("\nmbk measure {} {}\n", shell_word(arguments.file.string()), option);
  if (!arguments.output.file && terminal_at(system::kOutput).there) return kFine;  // the person sees it in that line
  if (auto ok = arguments.output.write(option + "\n", {arguments.file}); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_new_channels(Command group) {
  auto arguments = std::make_shared<NewChannelsArguments>();
  const Command command =
      group.add_command("channels", "find which column of a file is which channel; prints the command with --channels");
  command.footer(
      "Examples:\n"
      "  mbk new channels log.csv\n"
      "      shows the guess with the first seconds of each column, asks once, and prints the command\n"
      "  mbk measure log.csv $(mbk new channels log.csv --yes)\n"
      "      accepts the guess; fails if there is none\n"
      "  echo Fx=4,Fy=5 | mbk new channels log.csv --out channels.txt\n"
      "      changes these channels of the guess; a map of position and force replaces all but time\n\n"
      "Without a terminal and an answer, the guess is accepted. Guess and command go to standard error, the\n"
      "option alone to standard output or FILE. It is printed only after the file was read with it.");
  command.add_option("FILE", arguments->file, "a recording whose columns or variables mbk does not know: .csv, .mat, …")
      .required();
  command.add_option("--rate", arguments->rate_hz, "sample rate, in Hz, if the file contains no time")
      .type_name("HZ")
      .check(positive());
  command.add_option("--seconds", arguments->seconds, "length of the signals drawn, in seconds (default: 3)")
      .type_name("S")
      .check(positive());
  command.add_flag("--yes", arguments->yes, "ask no questions; accept the guess");
  arguments->output.add_options(command);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
