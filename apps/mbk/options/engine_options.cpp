#include "apps/mbk/options/engine_options.h"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "apps/mbk/caller.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/table_options.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/system/process.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;

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
  auto program = system::program_file();
  if (program.empty()) {
    return bad_data(std::generic_category().message(errno), "make this link readable; it names the running program",
                    "/proc/self/exe");
  }
  return program;
}

Result<Carried> carry_out(const EngineArguments& arguments, const batch::JobRequest& request, bool quiet) {
  if (Caller::current() != nullptr) {
    return bad_usage("--engine starts processes of the program mbk", "call it on the command line");
  }
  const auto program = MBK_TRY(this_program());
  const system::NotedEndRequests requests;
  const auto stop = [&] {
    using system::EndRequest;
    const EndRequest came = requests.came();
    return came == EndRequest::none      ? batch::Stop::no
           : came == EndRequest::hang_up ? batch::Stop::leave
                                         : batch::Stop::cancel;
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
      carried.code = requests.exit_code();
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
