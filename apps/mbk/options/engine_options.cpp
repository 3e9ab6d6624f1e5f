#include "apps/mbk/options/engine_options.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <thread>

#include "apps/mbk/caller.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/word_options.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/batch/job_events.h"
#include "mbk/batch/merge.h"
#include "mbk/files/contents/sha256.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;
using batch::EngineKind;
using batch::JobFolder;

volatile std::sig_atomic_t signal_that_came = 0;

void note_signal(int signal) {
  signal_that_came = signal;
}

/// While it lives, a request to end is noted, and a second one ends the program.
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

int cores() {
  return std::max<int>(static_cast<int>(std::thread::hardware_concurrency()), 1);
}

/// What units cost, measured on a few of them.
struct Measured {
  double s_per_weight = 0.0;
  std::int64_t memory_mb = 0;
};

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

Measured measured_cost(const Request& request) {
  constexpr std::size_t kUnits = 3;
  constexpr double kLongest = 10.0;  // [s]
  const auto begin = std::chrono::steady_clock::now();
  double weight = 0.0;
  const std::size_t count = std::min(kUnits, request.keys.size());
  for (std::size_t k = 0; k < count && seconds_since(begin) < kLongest; ++k) {
    const std::size_t unit = count == 1 ? 0 : k * (request.keys.size() - 1) / (count - 1);
    // What fails here fails in its chunk, too, and is told there.
    std::ignore = request.compute(static_cast<std::int64_t>(unit), request.keys[unit]);
    weight += request.weights[unit];
  }
  Measured measured;
  measured.s_per_weight = std::max(seconds_since(begin), 1e-6) / weight;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  constexpr std::int64_t kKilobytes = 1024, kBeside = 256;  // half as much again, and [MB]
  measured.memory_mb = usage.ru_maxrss * 3 / (2 * kKilobytes) + kBeside;
  return measured;
}

double target_of(const EngineArguments& arguments, double total_s) {
  if (arguments.chunk_s) return *arguments.chunk_s;
  const bool slurm = arguments.kind == EngineKind::slurm;
  // A task of Slurm begins after seconds, a process of this machine after hundredths.
  const batch::ChunkLengths lengths = slurm ? batch::ChunkLengths{30.0, 2.0} : batch::ChunkLengths{2.0, 0.2};
  return batch::chunk_length(total_s, arguments.tasks > 0 || slurm ? arguments.tasks : cores(), lengths);
}

batch::EngineOptions engine_options(const EngineArguments& arguments, const fs::path& program) {
  batch::EngineOptions options;
  options.kind = *arguments.kind;
  options.program = program;
  options.tasks = arguments.tasks;
  options.heartbeat_s = std::min(20.0, arguments.silence_s / 5.0);
  options.partition = arguments.partition;
  options.account = arguments.account;
  options.extra = arguments.extra;
  options.settle_s = arguments.settle_s;
  return options;
}

Result<JobFolder> begin_job(const EngineArguments& arguments, const Request& request,
                            const batch::EngineOptions& options, const fs::path& folder) {
  const auto most = MBK_TRY(batch::max_chunks(options));
  const Measured cost = measured_cost(request);
  std::vector<double> costs = request.weights;
  double total = 0.0;
  for (double& one : costs) total += one *= cost.s_per_weight;
  std::vector<std::int64_t> ends;
  if (arguments.chunk_units) {
    const std::vector<double> ones(costs.size(), 1.0);
    ends = batch::cut_into_chunks(ones, static_cast<double>(*arguments.chunk_units), most);
  } else {
    ends = batch::cut_into_chunks(costs, target_of(arguments, total), most);
  }
  nlohmann::json specification = nlohmann::json::parse(request.specification);
  batch::Job job;
  job.kind = request.kind;
  job.title = request.title;
  job.specification = specification.dump();
  job.memory_mb = arguments.memory_mb.value_or(cost.memory_mb);
  return JobFolder::create(folder, std::move(job), request.keys, ends, costs);
}

Result<JobFolder> job_of(const EngineArguments& arguments, const Request& request,
                         const batch::EngineOptions& options) {
  const fs::path folder = arguments.folder.value_or(request.folder);
  std::error_code error;
  const fs::path whole = fs::absolute(folder, error);
  if (!JobFolder::is_there(whole)) return begin_job(arguments, request, options, whole);
  auto opened = JobFolder::open(whole);
  if (!opened) return opened;
  MBK_TRY(opened->check_program());
  if (opened->job().kind != request.kind ||
      nlohmann::json::parse(opened->job().specification) != nlohmann::json::parse(request.specification)) {
    return fail(ErrorKind::usage, "there is another job in this folder",
                "finish it, or name another folder with --job-folder", whole.string());
  }
  return opened;
}

}  // namespace

void add_engine_options(Command command, EngineArguments& arguments) {
  constexpr const char* kGroup = "Many processes and machines";
  const auto add = [&](Option option) { option.group(kGroup); };
  add(add_choice(
      command, "--engine", arguments.kind,
      "processes on this machine (local), a job array (slurm), mpirun (mpi); without it: within this process"));
  add(command
          .add_option("--tasks", arguments.tasks, "processes at a time (as many as there are cores; slurm: no limit)")
          .type_name("N")
          .check(whole_number(1, 100'000)));
  add(command
          .add_option(
              "--job-folder", arguments.folder,
              "where the work is noted, on a disk that every machine sees; a job that stands there is gone on with")
          .type_name("FOLDER")
          .check(not_empty()));
  add(command.add_option("--chunk-seconds", arguments.chunk_s, "a process does so much at a time (by measured cost)")
          .type_name("S")
          .check(positive()));
  add(command.add_option("--chunk-units", arguments.chunk_units, "the same in recordings or runs")
          .type_name("N")
          .check(whole_number(1, 100'000'000)));
  add(command.add_option("--memory-mb", arguments.memory_mb, "of each task of Slurm (by what was measured)")
          .type_name("MB")
          .check(whole_number(1, 10'000'000)));
  add(command
          .add_option("--silence", arguments.silence_s,
                      "a process that shows no sign of life for so long is taken for dead (300)")
          .type_name("S")
          .check(positive()));
  add(command
          .add_option("--settle", arguments.settle_s,
                      "so long after a task's end its file may take to come into sight (10)")
          .type_name("S")
          .check(positive()));
  add(command.add_option("--partition", arguments.partition, "of Slurm (SBATCH_PARTITION)").type_name("NAME"));
  add(command.add_option("--account", arguments.account, "of Slurm (SBATCH_ACCOUNT)").type_name("NAME"));
  add(command.add_option("--engine-option", arguments.extra, "passed on to sbatch or mpirun; may be repeated")
          .type_name("OPTION")
          .allow_extra_args(false));
  add(command.add_flag("--detach", arguments.detach,
                       "of Slurm: hand the tasks out and end; the same command later collects what they did"));
  add(command.add_flag("--progress-json", arguments.progress_json,
                       "progress as JSON lines on standard error: schema mbk.job_state/1"));
  add(command.add_flag("--keep-job", arguments.keep, "leave the job's folder where all is done"));
}

Result<std::vector<std::string>> results_of(const JobFolder& folder) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::string> results;
  const auto merged = MBK_TRY(batch::merge(folder, [&](batch::MergedUnit unit) -> Result<void> {
    if (!unit.differing.empty()) {
      return bad_data(
          fmt::format("{} gives another result than {}", unit.differing[1].string(), unit.differing[0].string()),
          "two machines computed it differently; nothing is shown", folder.folder().string());
    }
    if (unit.failed) return bad_data(unit.payload);
    results.push_back(std::move(unit.payload));
    return {};
  }));
  if (merged.missing_chunks > 0) return bad_data("some of its chunks are missing", "", folder.folder().string());
  batch::note_merged(folder, seconds_since(begin));
  return results;
}

Result<void> remove_job(const JobFolder& folder, const EngineArguments& arguments) {
  if (arguments.keep) return {};
  MBK_TRY(folder.remove());
  std::error_code ignored;
  if (!arguments.folder) fs::remove(folder.folder().parent_path(), ignored);
  return {};
}

fs::path job_folder_here(const std::string& kind, const std::string& specification) {
  constexpr std::size_t kDigits = 12;
  const std::string sum = recording::sha256(std::as_bytes(std::span(specification)));
  return fs::path("mbk-jobs") / fmt::format("{}-{}", kind, sum.substr(0, kDigits));
}

Result<fs::path> this_program() {
  std::error_code error;
  auto program = fs::read_symlink("/proc/self/exe", error);
  if (error) return bad_data(error.message(), "it names this program", "/proc/self/exe");
  return program;
}

Result<Carried> carry_out(const EngineArguments& arguments, const Request& request, bool quiet) {
  if (arguments.detach && arguments.kind != EngineKind::slurm) {
    return bad_usage("--detach belongs to --engine slurm", "leave it out");
  }
  if (Caller::current() != nullptr) {
    return bad_usage("--engine starts processes of the program mbk", "call it on the command line");
  }
  const auto program = MBK_TRY(this_program());
  batch::EngineOptions options = engine_options(arguments, program);
  auto folder = MBK_TRY(job_of(arguments, request, options));
  const auto chunks = MBK_TRY(folder.chunks());
  for (const batch::Chunk& chunk : chunks) {
    options.longest_chunk_s = std::max(options.longest_chunk_s, chunk.expected_s);
  }
  options.memory_mb = arguments.memory_mb.value_or(folder.job().memory_mb);
  const auto engine = MBK_TRY(batch::make_engine(folder, options));

  batch::RunOptions run_options;
  run_options.silence_s = arguments.silence_s;
  run_options.engine = word_of(*arguments.kind);
  run_options.detach = arguments.detach;
  const NotedSignals signals;
  run_options.stop = [] {
    const int signal = signal_that_came;
    return signal == 0 ? batch::Stop::no : signal == SIGHUP ? batch::Stop::leave : batch::Stop::cancel;
  };
  std::string said;
  run_options.progress = [&](const batch::JobState& state) {
    if (arguments.progress_json) {
      say("{}\n", batch::to_json(state));
    } else if (!quiet) {
      say("{}\n", batch::to_text(state));
    }
  };
  const auto report = MBK_TRY(batch::run(folder, *engine, run_options));
  Carried carried;
  if (report.end == batch::RunEnd::finished) {
    carried.folder = std::move(folder);
    return carried;
  }
  const std::string where = folder.folder().string();
  switch (report.end) {
    case batch::RunEnd::detached:
      say("mbk: the tasks go on without this process; 'mbk work {} --status' tells how far they are, and the same "
          "command collects what they did\n",
          where);
      carried.code = kFine;
      break;
    case batch::RunEnd::stopped:
      say("mbk: stopped; the same command goes on where it ended\n");
      carried.code = 128 + signal_that_came;
      break;
    default:
      say("mbk: {} of {} chunks could not be done; the logs stand in {}\n", report.state.given_up, report.state.chunks,
          folder.logs().string());
      carried.folder = std::move(folder);
      carried.code = kBadData;
  }
  return carried;
}

}  // namespace mbk::app
