#include "mbk/batch/job_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <span>
#include <thread>
#include <tuple>
#include <utility>

#include "mbk/base/system/process.h"
#include "mbk/batch/merge.h"
#include "mbk/files/contents/sha256.h"

namespace mbk::batch {
namespace {

namespace fs = std::filesystem;

int cores() {
  return std::max<int>(static_cast<int>(std::thread::hardware_concurrency()), 1);
}

/// What units cost, measured on a few of them.
struct Measured {
  double s_per_weight = 0.0;
  std::int64_t memory_mb = 0;
};

double taken_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

Measured measured_cost(const JobRequest& request) {
  constexpr std::size_t kMeasured = 3;
  constexpr double kLongest = 10.0;  // [s]
  const auto begin = std::chrono::steady_clock::now();
  double weight = 0.0;
  const std::size_t count = std::min(kMeasured, request.keys.size());
  for (std::size_t k = 0; k < count && taken_since(begin) < kLongest; ++k) {
    const std::size_t unit = count == 1 ? 0 : k * (request.keys.size() - 1) / (count - 1);
    // What fails here fails in its chunk, too, and is told there.
    std::ignore = request.compute(static_cast<std::int64_t>(unit), request.keys[unit]);
    weight += request.weights[unit];
  }
  Measured measured;
  measured.s_per_weight = std::max(taken_since(begin), 1e-6) / weight;
  constexpr std::int64_t kMegabyte = std::int64_t{1} << 20, kBeside = 256;  // half as much again, and [MB]
  measured.memory_mb = system::peak_memory() * 3 / (2 * kMegabyte) + kBeside;
  return measured;
}

double target_of(const JobOptions& options, double total_s) {
  if (options.chunk_s) return *options.chunk_s;
  const bool slurm = options.kind == EngineKind::slurm;
  // A task of Slurm begins after seconds, a process of this machine after hundredths.
  const ChunkLengths lengths = slurm ? ChunkLengths{30.0, 2.0} : ChunkLengths{2.0, 0.2};
  return chunk_length(total_s, options.tasks > 0 || slurm ? options.tasks : cores(), lengths);
}

EngineOptions engine_options(const JobOptions& options, const fs::path& program) {
  EngineOptions engine;
  engine.kind = *options.kind;
  engine.program = program;
  engine.tasks = options.tasks;
  engine.heartbeat_s = std::min(20.0, options.silence_s / 5.0);
  engine.partition = options.partition;
  engine.account = options.account;
  engine.extra = options.extra;
  engine.settle_s = options.settle_s;
  return engine;
}

Result<JobFolder> begin_job(const JobOptions& options, const JobRequest& request, const EngineOptions& engine,
                            const fs::path& folder) {
  const auto most = MBK_TRY(max_chunks(engine));
  const Measured cost = measured_cost(request);
  std::vector<double> costs = request.weights;
  double total = 0.0;
  for (double& one : costs) total += one *= cost.s_per_weight;
  std::vector<std::int64_t> ends;
  if (options.chunk_units) {
    const std::vector<double> ones(costs.size(), 1.0);
    ends = cut_into_chunks(ones, static_cast<double>(*options.chunk_units), most);
  } else {
    ends = cut_into_chunks(costs, target_of(options, total), most);
  }
  Job job;
  job.kind = request.kind;
  job.title = request.title;
  job.specification = nlohmann::json::parse(request.specification).dump();
  job.memory_mb = options.memory_mb.value_or(cost.memory_mb);
  return JobFolder::create(folder, std::move(job), request.keys, ends, costs);
}

Result<JobFolder> job_of(const JobOptions& options, const JobRequest& request, const EngineOptions& engine) {
  const fs::path folder = options.folder.value_or(request.folder);
  std::error_code error;
  const fs::path whole = fs::absolute(folder, error);
  if (!JobFolder::is_there(whole)) return begin_job(options, request, engine, whole);
  auto opened = MBK_TRY(JobFolder::open(whole));
  MBK_TRY(opened.check_program());
  if (opened.job().kind != request.kind ||
      nlohmann::json::parse(opened.job().specification) != nlohmann::json::parse(request.specification)) {
    return fail(ErrorKind::usage, "the folder contains another job",
                "finish it, or name another folder with --job-folder", whole.string());
  }
  return opened;
}

}  // namespace

const OptionTable<JobOptions>& job_table() {
  static const auto kTable = [] {
    OptionTable<JobOptions> table;
    table.group("Many processes and computers")
        .add({"--engine", "", "local: processes on this computer; slurm: a job array (default: within this process)"},
             &JobOptions::kind)
        .check([](const std::string& given) -> std::string {
          if (given != "mpi") return one_of({kWordList<EngineKind>.begin(), kWordList<EngineKind>.end()}).wrong(given);
          return "the engine mpi was removed; start the job with local or slurm, and add workers with "
                 "'mpirun -n N mbk work FOLDER'";
        })
        .add({"--tasks", "N", "simultaneous processes (default: number of cores; slurm: no limit)",
              whole_number(1, 100'000)},
             &JobOptions::tasks)
        .add({"--job-folder", "FOLDER",
              "folder of the job, on a disk that every computer sees; a job found there is continued", not_empty()},
             &JobOptions::folder)
        .add({"--chunk-seconds", "S", "computing time of a chunk in s (default: from measured cost)", positive()},
             &JobOptions::chunk_s)
        .add({"--chunk-units", "N", "size of a chunk in recordings or runs", whole_number(1, 100'000'000)},
             &JobOptions::chunk_units)
        .add({"--memory-mb", "MB", "memory of each Slurm task in MB (default: from measurements)",
              whole_number(1, 10'000'000)},
             &JobOptions::memory_mb)
        .add({"--silence", "S", "time in s after which a silent process counts as dead (default: 300)", positive()},
             &JobOptions::silence_s)
        .add({"--settle", "S", "time in s that a task's file may take to become visible after its end (default: 10)",
              positive()},
             &JobOptions::settle_s)
        .add({"--partition", "NAME", "Slurm partition (default: SBATCH_PARTITION)"}, &JobOptions::partition)
        .add({"--account", "NAME", "Slurm account (default: SBATCH_ACCOUNT)"}, &JobOptions::account)
        .add({.name = "--engine-option",
              .value = "OPTION",
              .help = "option passed to sbatch; repeatable",
              .repeats = true},
             &JobOptions::extra)
        .add({"--detach", "", "slurm: submit the tasks and exit; the same command later collects their results"},
             &JobOptions::detach)
        .add({"--keep-job", "", "keep the job's folder after completion"}, &JobOptions::keep);
    return table;
  }();
  return kTable;
}

Result<CarriedOut> carry_out(const JobOptions& options, const JobRequest& request, const fs::path& program,
                             std::function<Stop()> stop, std::function<void(const JobState&)> progress) {
  if (options.detach && options.kind != EngineKind::slurm) {
    return bad_usage("--detach needs --engine slurm", "omit it");
  }
  EngineOptions engine_of = engine_options(options, program);
  auto folder = MBK_TRY(job_of(options, request, engine_of));
  const auto chunks = MBK_TRY(folder.chunks());
  for (const Chunk& chunk : chunks) engine_of.longest_chunk_s = std::max(engine_of.longest_chunk_s, chunk.expected_s);
  engine_of.memory_mb = options.memory_mb.value_or(folder.job().memory_mb);
  const auto engine = MBK_TRY(make_engine(folder, engine_of));
  RunOptions run_options;
  run_options.silence_s = options.silence_s;
  run_options.detach = options.detach;
  run_options.stop = std::move(stop);
  run_options.progress = std::move(progress);
  auto report = MBK_TRY(run(folder, *engine, run_options));
  return CarriedOut{std::move(folder), std::move(report)};
}

Result<std::vector<std::string>> results_of(const JobFolder& folder) {
  std::vector<std::string> results;
  const auto merged = MBK_TRY(merge(folder, [&](MergedUnit unit) -> Result<void> {
    if (!unit.differing.empty()) {
      return bad_data(
          fmt::format("{} gives a different result from {}", unit.differing[1].string(), unit.differing[0].string()),
          "two computers computed it differently, so nothing is shown; compare the programs and the files",
          folder.folder().string());
    }
    if (unit.failed) return bad_data(unit.payload);
    results.push_back(std::move(unit.payload));
    return {};
  }));
  if (merged.missing_chunks > 0) return bad_data("some of its chunks are missing", "", folder.folder().string());
  return results;
}

Result<void> remove_job(const JobFolder& folder, const JobOptions& options) {
  if (options.keep) return {};
  MBK_TRY(folder.remove());
  std::error_code ignored;
  if (!options.folder) fs::remove(folder.folder().parent_path(), ignored);
  return {};
}

std::string job_name(const std::string& kind, const std::string& specification) {
  constexpr std::size_t kDigits = 12;
  const std::string sum = recording::sha256(std::as_bytes(std::span(specification)));
  return fmt::format("{}-{}", kind, sum.substr(0, kDigits));
}

}  // namespace mbk::batch
