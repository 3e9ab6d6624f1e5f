#include "apps/mbk/options/engine_options.h"

#include <fmt/format.h>

#include <array>
#include <csignal>
#include <utility>

#include "apps/mbk/caller.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/table_options.h"
#include "apps/mbk/terminal/messages.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t signal_that_came = 0;

void note_signal(int signal) {
  signal_that_came = signal;
}

/// During its lifetime a request to end is noted, and a second one ends the program.
class NotedSignals {
 public:
  NotedSignals() {
    signal_that_came = 0;
    for (const int signal : kSignals) {
      struct sigaction action {};
      action.sa_handler = note_signal;
      action.sa_flags = static_cast<int>(SA_RESETHAND);
      sigaction(signal, &action, nullptr);
    }
  }
  NotedSignals(const NotedSignals&) = delete;
  NotedSignals& operator=(const NotedSignals&) = delete;
  ~NotedSignals() {
    for (const int signal : kSignals) std::signal(signal, SIG_DFL);
  }

 private:
  static constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};
};

}  // namespace

void add_engine_options(Command command, EngineArguments& arguments) {
  add_options(command, batch::job_table(), arguments);
  command
      .add_flag("--progress-json", arguments.progress_json,
                "print progress as JSON lines on standard error: schema mbk.job_state/1")
      .group("Many processes and computers");
}

fs::path job_folder_here(const std::string& kind, const std::string& specification) {
  return fs::path("mbk-jobs") / batch::job_name(kind, specification);
}

Result<fs::path> this_program() {
  std::error_code error;
  auto program = fs::read_symlink("/proc/self/exe", error);
  if (error)
    return bad_data(error.message(), "make this link readable; it names the running program", "/proc/self/exe");
  return program;
}

Result<Carried> carry_out(const EngineArguments& arguments, const batch::JobRequest& request, bool quiet) {
  if (Caller::current() != nullptr) {
    return bad_usage("--engine starts processes of the program mbk", "call it on the command line");
  }
  const auto program = MBK_TRY(this_program());
  const NotedSignals signals;
  const auto stop = [] {
    const int signal = signal_that_came;
    return signal == 0 ? batch::Stop::no : signal == SIGHUP ? batch::Stop::leave : batch::Stop::cancel;
  };
  const auto progress = [&](const batch::JobState& state) {
    if (arguments.progress_json) {
      say("{}\n", batch::to_json(state));
    } else if (!quiet) {
      say("{}\n", batch::to_text(state));
    }
  };
  auto [folder, report] = MBK_TRY(batch::carry_out(arguments, request, program, stop, progress));
  Carried carried;
  if (report.end == batch::RunEnd::finished) {
    carried.folder = std::move(folder);
    return carried;
  }
  const std::string where = folder.folder().string();
  switch (report.end) {
    case batch::RunEnd::detached:
      say("mbk: the tasks continue without this process; 'mbk work {} --status' shows their progress, and repeating "
          "this command collects their results\n",
          where);
      carried.code = kFine;
      break;
    case batch::RunEnd::stopped:
      say("mbk: stopped; repeat the command to continue\n");
      carried.code = 128 + signal_that_came;
      break;
    default:
      say("mbk: {} of {} chunks failed; see the logs in {}\n", report.state.given_up, report.state.chunks,
          folder.logs().string());
      carried.folder = std::move(folder);
      carried.code = kBadData;
  }
  return carried;
}

}  // namespace mbk::app
