#include <fmt/format.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <memory>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/engine_options.h"
#include "apps/mbk/options/output.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/vector4.h"
#include "mbk/batch/merge.h"

namespace mbk::app {
namespace {

struct WorkArguments {
  std::filesystem::path folder;
  std::optional<std::int64_t> chunk;
  double heartbeat_s = 20.0;
  bool with_parent = false, status = false, json = false, cancel = false;
};

int show_state(const batch::JobFolder& folder, bool json) {
  const auto state = batch::state_of(folder);
  if (!state) return report_error(state.error());
  const std::string text =
      json ? batch::to_json(*state) + "\n" : fmt::format("{}\n{}\n", folder.job().title, batch::to_text(*state));
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return kFine;
}

int cancel(const batch::JobFolder& folder) {
  batch::EngineOptions options;
  options.kind = batch::EngineKind::slurm;
  const auto engine = batch::make_engine(folder, options);
  if (!engine) return report_error(engine.error());
  if (const auto alive = (*engine)->alive(); !alive) return report_error(alive.error());
  (*engine)->cancel_all();
  return kFine;
}

int run(const WorkArguments& arguments) {
  const auto folder = batch::JobFolder::open(arguments.folder);
  if (!folder) return report_error(folder.error());
  if (arguments.cancel) return cancel(*folder);
  if (arguments.status || arguments.json) return show_state(*folder, arguments.json);
  if (arguments.with_parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() == 1) return kBadData;  // it is gone already
  }
  if (auto ok = folder->check_program(); !ok) return report_error(ok.error());
  // Before anything computes: processors of different kinds then give the same digits.
  const std::string& simd_of_job = folder->job().simd;
  ::setenv("MBK_SIMD", simd_of_job.c_str(), 1);
  if (word_of(simd()) != simd_of_job) {
    return report_error({ErrorKind::data,
                         fmt::format("the job was begun on a processor of kind {}, and this one is of kind {}",
                                     simd_of_job, word_of(simd())),
                         fmt::format("begin it with MBK_SIMD={}", word_of(simd())), folder->folder().string()});
  }
  const auto done = [](std::int64_t chunk, const batch::ChunkDone& did) {
    return print_text(fmt::format("chunk {}: {} units, {} failed\n", chunk, did.units, did.failed));
  };
  const batch::WorkOptions options{arguments.heartbeat_s};
  const auto worked = with_units(*folder, [&](const batch::UnitFunction& compute) -> Result<void> {
    if (!arguments.chunk) return batch::work_on_free_chunks(*folder, compute, options, done);
    const auto did = MBK_TRY(batch::work(*folder, *arguments.chunk, compute, options));
    return done(*arguments.chunk, did);
  });
  if (!worked) return report_error(worked.error());
  return kFine;
}

}  // namespace

Action add_work(Command app) {
  auto arguments = std::make_shared<WorkArguments>();
  const Command command = app.add_command("work", "work on a job that --engine began");
  command.footer(
      "Examples:\n"
      "  mbk work arms/jobs/measure --status\n"
      "      how far it is\n"
      "  mbk work arms/jobs/measure --chunk 12\n"
      "      what a task of Slurm does; by hand, too\n"
      "  mpirun -n 64 mbk work arms/jobs/measure\n"
      "      64 workers, by MPI or by srun: each does chunks that nobody has begun, until there are none\n"
      "  mbk work arms/jobs/measure --cancel\n"
      "      ends the tasks that wait or run in Slurm; what they finished stays\n\n"
      "A chunk's results stand in the job's folder, shards/CHUNK.*.shard; the command that began the job collects\n"
      "them. A chunk that is done twice gives the same bytes.");
  command.add_option("FOLDER", arguments->folder, "the job's folder").required().check(not_empty());
  const Option chunk =
      command.add_option("--chunk", arguments->chunk, "only this part, from 0 (all that nobody has begun)")
          .type_name("K")
          .check(whole_number(0, 1'000'000'000));
  command.add_option("--heartbeat", arguments->heartbeat_s, "between two signs of life in the shard (20)")
      .type_name("S")
      .check(positive());
  command.add_flag("--with-parent", arguments->with_parent, "end when the process that started this one ends")
      .needs(chunk);
  const Option status = command.add_flag("--status", arguments->status, "how far the job is").excludes(chunk);
  command.add_flag("--cancel", arguments->cancel, "end its tasks in Slurm").excludes(chunk).excludes(status);
  command.add_flag("--json", arguments->json, "of --status, for machines: schema mbk.job_state/1").excludes(chunk);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
