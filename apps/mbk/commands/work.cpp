#include <fmt/format.h>

#include <memory>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/engine_options.h"
#include "apps/mbk/options/output.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/vector4.h"
#include "mbk/base/system/process.h"
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
    if (!system::end_with_parent()) return kBadData;  // it is gone already
  }
  if (auto ok = folder->check_program(); !ok) return report_error(ok.error());
  // Before any computation: processors of different kinds then give the same digits.
  const std::string& simd_of_job = folder->job().simd;
  system::set_environment("MBK_SIMD", simd_of_job);
  if (word_of(simd()) != simd_of_job) {
    return report_error({ErrorKind::data,
                         fmt::format("the job was started with SIMD level {}, but this processor uses {}", simd_of_job,
                                     word_of(simd())),
                         fmt::format("start the job with MBK_SIMD={}", word_of(simd())), folder->folder().string()});
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
  const Command command = app.add_command("work", "work on a job started with --engine, or show its progress");
  command.footer(
      "Examples:\n"
      "  mbk work arms/jobs/measure --status\n"
      "      shows its progress\n"
      "  mbk work arms/jobs/measure --chunk 12\n"
      "      does one chunk, as each Slurm task does\n"
      "  mpirun -n 64 mbk work arms/jobs/measure\n"
      "      64 workers, started by MPI or srun: each takes unstarted chunks until none are left\n"
      "  mbk work arms/jobs/measure --cancel\n"
      "      cancels waiting and running Slurm tasks; finished chunks are kept\n\n"
      "The results of a chunk are in the job's folder, shards/CHUNK.*.shard; the command that started the\n"
      "job collects them. Repeating a chunk gives the same bytes.");
  command.add_option("FOLDER", arguments->folder, "the job's folder").required().check(not_empty());
  const Option chunk =
      command
          .add_option("--chunk", arguments->chunk,
                      "do only this chunk, a part of the job, counted from 0 (default: all unstarted chunks)")
          .type_name("K")
          .check(whole_number(0, 1'000'000'000));
  command
      .add_option("--heartbeat", arguments->heartbeat_s,
                  "time between two heartbeats in the shard, in seconds (default: 20)")
      .type_name("S")
      .check(positive());
  command.add_flag("--with-parent", arguments->with_parent, "end when the parent process ends").needs(chunk);
  const Option status = command.add_flag("--status", arguments->status, "show the progress of the job").excludes(chunk);
  command.add_flag("--cancel", arguments->cancel, "cancel its Slurm tasks").excludes(chunk).excludes(status);
  command.add_flag("--json", arguments->json, "print the progress as JSON: schema mbk.job_state/1").excludes(chunk);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
