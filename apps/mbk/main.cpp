#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/mbk/commands.h"
#include "apps/mbk/last_words.h"
#include "apps/mbk/memory.h"
#include "apps/mbk/messages.h"
#include "apps/mbk/output.h"
#include "apps/mbk/process.h"
#include "mbk/base/core/vector4.h"
#include "mbk/base/core/version.h"
#include "mbk/base/core/words.h"
#include "mbk/present/report/text.h"

namespace {

/// Descriptions of options, broken into lines that a terminal shows whole.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(kNameColumns); }

  std::string make_option_desc(const CLI::Option* option) const override {
    return mbk::report::wrapped(CLI::Formatter::make_option_desc(option), mbk::report::kLineColumns - kNameColumns);
  }

 private:
  static constexpr std::size_t kNameColumns = 30;
};

/// "mbk: what is wrong; which help to read".
std::string one_line(const CLI::App* app, const CLI::Error& error) {
  const auto chosen = app->get_subcommands();
  if (!chosen.empty()) {
    const CLI::App* const command = chosen.front();
    const auto part = command->get_subcommands();
    if (!part.empty()) {
      return fmt::format("mbk: {}; see 'mbk {} {} --help'\n", error.what(), command->get_name(),
                         part.front()->get_name());
    }
    return fmt::format("mbk: {}; see 'mbk {} --help'\n", error.what(), command->get_name());
  }
  const std::vector<std::string> words = app->remaining();
  if (words.empty()) return "mbk: no command; see 'mbk --help'\n";
  return fmt::format("mbk: '{}' is an unknown command; see 'mbk --help'\n", words.front());
}

/// On standard error where there is no memory to make a line in. What cannot be written is lost: the exit code tells.
void say_plainly(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t wrote = write(STDERR_FILENO, text.data(), text.size());
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(wrote));
  }
}

constexpr std::string_view kNoMemory =
    "mbk: not enough memory; of a recording choose a part with --from and --to; of a trial 'mbk recover' saves "
    "what its journal holds, and what it does not hold is lost\n";

/// Where an exception has nowhere to go: before main begins, and out of a destructor that needs memory, as that of a
/// JSON tree does. No memory is no error of mbk; anything else is, and ends as it would.
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

using Commands = std::vector<std::pair<std::string_view, std::function<mbk::app::Action(CLI::App&)>>>;

/// Every command, in the order in which --help lists them.
Commands all_commands(const std::string& typed) {
  using namespace mbk::app;
  return {
      {"measure", [typed](CLI::App& app) { return add_measure(app, typed); }},
      {"identify", add_identify},
      {"explore", [typed](CLI::App& app) { return add_explore(app, typed); }},
      {"movement", add_movement},
      {"tf", [typed](CLI::App& app) { return add_tf(app, typed); }},
      {"ellipse", add_ellipse},
      {"passivity", add_passivity},
      {"compare", add_compare},
      {"info", add_info},
      {"convert", add_convert},
      {"simulate", add_simulate},
      {"run", add_run},
      {"recover", add_recover},
      {"springs", add_springs},
      {"teleop", add_teleop},
      {"sensor", add_sensor},
      {"robot", add_robot},
      {"study", add_study},
      {"work", add_work},
      {"validate", add_validate},
      {"reproduce", add_reproduce},
      {"completion", add_completion},
      {"manual", add_manual},
  };
}

/// The options of all commands are half of what it takes to start: where the first word on the command line names a
/// command, only that one is made. `completion` and `manual` speak of all.
mbk::app::Actions commands_for(std::string_view first, CLI::App& app, const std::string& typed) {
  const Commands all = all_commands(typed);
  const bool one = first != "completion" && first != "manual" &&
                   std::ranges::any_of(all, [&](const auto& command) { return command.first == first; });
  mbk::app::Actions made;
  for (const auto& [name, add] : all) {
    if (!one || name == first) made.emplace_back(name, add(app));
  }
  return made;
}

int run(int argc, char** argv) {
  mbk::app::prefer_large_pages();
  const char* const simd = std::getenv("MBK_SIMD");
  if (simd != nullptr && !mbk::value_of<mbk::Simd>(simd)) {
    mbk::app::say_text(fmt::format("mbk: MBK_SIMD is '{}', which is none of {}; unset it for what this processor has\n",
                                   simd, fmt::join(mbk::kWordList<mbk::Simd>, ", ")));
    return mbk::app::kWrongUsage;
  }
  CLI::App app{
      "mbk measures the mechanical impedance of the human arm with a rehabilitation robot: inertia M,\n"
      "damping B, stiffness K and equilibrium x0 at the hand, M ẍ + B ẋ + K (x − x0) = −F, from force\n"
      "and position while the robot perturbs it. F is the force that the hand exerts on the robot.\n\n"
      "  mbk measure log.mat                 the main job: recording → M, B, K, x0, ellipses, warnings\n"
      "  mbk passivity log.mat               what energy the limb absorbed, and what its model predicts\n"
      "  mbk info log.mat                    what is in a recording, and what is wrong with it\n"
      "  mbk measure --help                  every command explains itself\n"};
  app.name("mbk");
  app.set_version_flag("--version", fmt::format("mbk {}", mbk::version()));
  app.require_subcommand(1);
  app.formatter(std::make_shared<HelpFormatter>());
  app.failure_message(one_line);

  const std::string_view first = argc > 1 ? argv[1] : "";
  const mbk::app::Actions commands = commands_for(first, app, mbk::app::command_line(argc, argv));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, wrong;
    for (auto* stream : {&out, &wrong}) stream->exceptions(std::ios::badbit);  // where there is no memory
    const int code = app.exit(error, out, wrong);
    mbk::app::say_text(wrong.str());
    if (auto ok = mbk::app::Output().write(out.str()); !ok) return mbk::app::report_error(ok.error());
    return code == 0 ? mbk::app::kFine : mbk::app::kWrongUsage;
  }
  return mbk::app::run_chosen(app, commands);
}

}  // namespace

int main(int argc, char** argv) {
  mbk::app::prepare_process();
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    say_plainly(kNoMemory);
  } catch (const std::exception& error) {
    say_plainly("mbk: ");
    say_plainly(error.what());
    say_plainly("; nothing more was done\n");
  }
  return mbk::app::kBadData;
}
