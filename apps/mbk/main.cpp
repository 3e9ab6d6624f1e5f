#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/terminal/built_from.h"
#include "apps/mbk/terminal/citation.h"
#include "apps/mbk/terminal/command.h"
#include "apps/mbk/terminal/command_list.h"
#include "apps/mbk/terminal/help.h"
#include "apps/mbk/terminal/last_words.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/printable.h"
#include "mbk/base/core/vector4.h"
#include "mbk/base/core/words.h"
#include "mbk/base/system/files.h"
#include "mbk/base/system/process.h"
#include "mbk/base/system/terminal.h"

namespace {

/// "mbk: what is wrong; see 'mbk measure --help'".
std::string one_line(const mbk::app::NotTaken& why) {
  return fmt::format("mbk: {}{} see '{} --help'\n", why.usage, why.usage.ends_with('?') ? "" : ";", why.command);
}

/// On standard error when there is no memory to format a line. What cannot be written is lost; the exit code remains.
void say_plainly(std::string_view text) noexcept {
  static_cast<void>(mbk::system::write_all(mbk::system::kError, std::as_bytes(std::span(text))));
}

constexpr std::string_view kNoMemory =
    "mbk: not enough memory; analyse part of a recording with --from and --to; after a trial, 'mbk recover' saves what "
    "its journal contains\n";

/// For an exception that nothing can catch: before main begins, or from a destructor that needs memory, such as that of
/// a JSON tree. Lack of memory is not an error of mbk; any other exception is, and ends the program as usual.
[[noreturn]] void end_without_memory() noexcept {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
  } catch (const std::bad_alloc&) {
    mbk::app::LastWords::say();
    say_plainly(kNoMemory);
    std::_Exit(mbk::app::kBadData);
  } catch (...) {
    __gnu_cxx::__verbose_terminate_handler();
  }
  std::abort();
}

/// Before the tables of CLI11 are filled, which is before main.
[[gnu::constructor(101)]] void expect_no_memory() noexcept {
  std::set_terminate(end_without_memory);
}

/// Keeps freed memory for the next use instead of returning it to the system, which would clear it page by page: that
/// takes a tenth of the time of `measure`. Blocks larger than the columns of a minute are returned.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 16 << 20);
  mallopt(M_TRIM_THRESHOLD, 128 << 20);
  mallopt(M_TOP_PAD, 16 << 20);
#endif
}

/// @param words  of the command line, behind the program's name
int run(const std::vector<std::string>& words) {
  keep_freed_memory();
  const char* const simd = std::getenv("MBK_SIMD");
  if (simd != nullptr && !mbk::value_of<mbk::Simd>(simd)) {
    mbk::app::say("mbk: MBK_SIMD is '{}', not one of {}; unset it to use all that this processor supports\n", simd,
                  fmt::format("{}", fmt::join(mbk::kWordList<mbk::Simd>, ", ")));
    return mbk::app::kWrongUsage;
  }
  const mbk::app::Parser parser(
      "mbk",
      "mbk measures the mechanical impedance of the human arm with a rehabilitation robot: inertia M,\n"
      "damping B, stiffness K and equilibrium x0 at the hand, M ẍ + B ẋ + K (x − x0) = −F, from force\n"
      "and position while the robot perturbs it. F is the force that the hand exerts on the robot.\n");
  const mbk::app::Command app = parser.command();
  app.add_text_flag("--version", mbk::app::built_from, "Print the version and exit");
  app.add_text_flag("--cite", mbk::app::bibtex, "Print BibTeX entries for mbk and the thesis behind it, and exit");
  app.require_subcommand();
  mbk::app::add_help(app);

  const std::string_view first = words.empty() ? "" : std::string_view(words.front());
  const mbk::app::Actions commands = mbk::app::add_commands(first, app, mbk::app::command_line(words));
  if (const auto taken = parser.parse(words); !taken) {
    const mbk::app::NotTaken& why = taken.error();
    if (!why.answer) {
      mbk::app::say_text(mbk::printable_lines(one_line(why)));
      return mbk::app::kWrongUsage;
    }
    if (auto ok = mbk::app::Output().show(*why.answer, {}); !ok) return mbk::app::report_error(ok.error());
    return mbk::app::kFine;
  }
  return mbk::app::run_chosen(app, commands);
}

}  // namespace

int main(int argc, char** argv) {
  if (!mbk::system::prepare_streams()) std::_Exit(mbk::app::kBadData);  // nobody can be told
  try {
    return mbk::app::ended(run(mbk::system::arguments(argc, argv)));
  } catch (const std::bad_alloc&) {
    say_plainly(kNoMemory);
  } catch (const std::exception& error) {
    say_plainly("mbk: ");
    say_plainly(error.what());
    say_plainly("; the command was aborted\n");
  }
  return mbk::app::kBadData;
}
