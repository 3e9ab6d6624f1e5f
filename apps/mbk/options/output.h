#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/terminal/command.h"
#include "mbk/base/core/result.h"

namespace mbk::app {

inline constexpr int kFine = 0, kFallsShort = 1, kWrongUsage = 2, kBadData = 3, kNotUsable = 4;

/// Their meaning, for help and manual; a command with other codes has a line "Exit codes: …" in its footer.
inline constexpr const char* kExitCodes = "0 fine, 2 wrong usage, 3 bad or unreadable data, 4 computed but not usable.";

/// Prints "mbk: where: what; what to do" on stderr and returns the exit code of that kind of error.
int report_error(const Error& error);

/// Where a command's text goes: standard output, or a file that is written under a temporary name and then renamed,
/// and never overwritten unless asked.
struct Output {
  std::optional<std::filesystem::path> file;
  bool overwrite = false;

  /// Adds --out and --overwrite.
  void add_options(Command command);

  /// Checks before the work begins, as `check_new_file`.
  [[nodiscard]] Result<void> check(const std::vector<std::filesystem::path>& inputs) const;

  /// @param sources  the files that the text was computed from; who may not read them may not read it
  [[nodiscard]] Result<void> write(const std::string& text, const std::vector<std::filesystem::path>& sources) const;

  /// The same for a text for people: at a terminal as wide as it is, with colour.
  [[nodiscard]] Result<void> show(const std::string& text, const std::vector<std::filesystem::path>& sources) const;
};

/// To standard output.
[[nodiscard]] Result<void> print_text(const std::string& text);

/// "mbk: wrote FILE" on standard error, unless `quiet`; a caller within the process is told nothing.
void say_written(const std::string& what, bool quiet);

/// To be called at the end of main. If the reader of standard output ended early (`mbk … | head`) and nothing else is
/// wrong, the program ends by SIGPIPE, as filters do; during a command, which may move a robot, it does not.
/// @returns  `code`
[[nodiscard]] int ended(int code) noexcept;

/// Checks a file that an option names, before the work begins.
/// @fails  usage: the file exists and may not be overwritten, or is one of `inputs`.
[[nodiscard]] Result<void> check_new_file(const std::filesystem::path& file, const char* option, bool overwrite,
                                          const std::vector<std::filesystem::path>& inputs);

}  // namespace mbk::app
