#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "apps/mbk/options/engine_options.h"
#include "apps/mbk/commands/measure_units.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/progress.h"
#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/commands/study_jobs.h"
#include "apps/mbk/options/study_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/version.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/batch/job_events.h"
#include "mbk/batch/merge.h"

namespace mbk::app {
namespace {

struct StudyMeasureArguments {
  StudyArguments study;
  MeasuringArguments measuring;
  EngineArguments engine;
  bool again_failed = false, quiet = false;
};

/// How measuring ended, by the number of recordings.
struct Tally {
  int usable = 0, not_usable = 0;
  int failed = 0;  ///< the recording cannot be measured
  int unread = 0;  ///< its file cannot be had

  Tally& operator+=(const Tally& other) {
    usable += other.usable;
    not_usable += other.not_usable;
    failed += other.failed;
    unread += other.unread;
    return *this;
  }
};

/// Takes results in whatever order they come, and stores them in the order of their keys: many in one transaction, but
/// none waits for more than a second.
class ResultQueue {
 public:
  /// @param units  those that set() and done() speak of
  ResultQueue(store::Store& study, std::string key, store::Role role, std::vector<store::Unit> units = {})
      : study_(study), key_(std::move(key)), role_(role), units_(std::move(units)), results_(units_.size()) {}

  void set(int k, Result<store::UnitResult> result) { results_[static_cast<std::size_t>(k)] = std::move(result); }

  /// Called for each when it is there, never two at a time.
  void done(int k) {
    ready_.at(static_cast<std::size_t>(k)) = true;
    while (next_ < ready_.size() && ready_[next_]) {
      take(std::move(units_[next_]), std::move(*results_[next_]));
      results_[next_++].reset();
    }
    store_in_time();
  }

  /// One that comes in the order of the keys.
  void add(store::Unit unit, Result<store::UnitResult> result) {
    take(std::move(unit), std::move(result));
    store_in_time();
  }

  /// Everything that came is stored, or there is an error.
  void finish() {
    store();
    await();
  }

  std::optional<Error> error;         ///< results could not be stored
  std::atomic<bool> stopped = false;  ///< no more are asked for
  Tally tally;

 private:
  static constexpr std::ptrdiff_t kMany = 64;

  /// Beside whoever measures, who need not wait for the disk.
  void store() {
    await();
    last_ = std::chrono::steady_clock::now();
    if (waiting_units_.empty() || error) return;
    being_stored_ = std::async(std::launch::async, [this, units = std::exchange(waiting_units_, {}),
                                                    results = std::exchange(waiting_results_, {})] {
      return study_.save(key_, std::string(version()), units, results, role_);
    });
  }

  /// What is being stored is stored, or there is an error.
  void await() {
    if (!being_stored_.valid()) return;
    if (const auto saved = being_stored_.get(); !saved) {
      error = saved.error();
      stopped = true;
    }
  }

  void store_in_time() {
    const auto now = std::chrono::steady_clock::now();
    if (std::ssize(waiting_units_) >= kMany || now - last_ > std::chrono::seconds(1)) store();
  }

  void take(store::Unit unit, Result<store::UnitResult> result) {
    if (!result) {
      if (!stopped) std::ignore = report_error(result.error());
      ++tally.unread;
      return;
    }
    if (result->document.empty()) say("mbk: {}: {}\n", unit.file, result->reason);
    ++(result->usable ? tally.usable : result->document.empty() ? tally.failed : tally.not_usable);
    waiting_units_.push_back(std::move(unit));
    waiting_results_.push_back(std::move(*result));
  }

  store::Store& study_;
  std::string key_;
  store::Role role_;
  std::vector<store::Unit> units_;
  std::vector<std::optional<Result<store::UnitResult>>> results_;
  std::vector<bool> ready_ = std::vector<bool>(units_.size());
  std::size_t next_ = 0;
  std::vector<store::Unit> waiting_units_;
  std::vector<store::UnitResult> waiting_results_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::future<Result<int>> being_stored_;
};

/// Measures within this process, on several threads.
void measure_here(const Measuring& measuring, const std::filesystem::path& folder,
                  const std::vector<store::Unit>& units, const StudyMeasureArguments& arguments, ResultQueue& queue) {
  const int count = static_cast<int>(units.size());
  Progress progress(arguments.quiet);
  int done = 0;
  std::ignore = numeric::parallel_for(
      count, arguments.measuring.threads,
      [&](int k) -> Result<void> {
        const store::Unit& unit = units[static_cast<std::size_t>(k)];
        queue.set(k, queue.stopped ? bad_data("not measured") : measure_unit(measuring, folder, unit));
        return {};
      },
      [&](int k) {
        queue.done(k);
        progress.count(++done, count);
      });
  queue.finish();
}

int said_of(const Tally& tally, std::size_t count, std::optional<int> code = {}) {
  const std::string text = count == 0 ? "nothing new to measure\n"
                                      : fmt::format("{} measured: {} usable, {} not usable, {} could not be measured\n",
                                                    count, tally.usable, tally.not_usable, tally.failed + tally.unread);
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  if (code) return *code;
  if (tally.unread + tally.failed > 0) return kBadData;
  return tally.not_usable > 0 && tally.usable == 0 ? kNotUsable : kFine;
}

/// How long a recording takes is about how long it is.
Result<std::vector<double>> lengths_of(const store::Store& study, const std::vector<store::Unit>& units) {
  const auto recordings = MBK_TRY(study.recordings());
  std::map<std::pair<std::string, std::int64_t>, double> length;
  for (const store::StoredRecording& one : recordings) length[{one.sha256, one.part}] = one.duration_s;
  std::vector<double> lengths;
  for (const store::Unit& unit : units) lengths.push_back(std::max(length[{unit.sha256, unit.part}], 1.0));
  return lengths;
}

/// Stores what a job's shards hold, in the order of the keys.
Result<std::size_t> collect(const batch::JobFolder& folder, ResultQueue& queue) {
  const auto merged = batch::merge(folder, [&](batch::MergedUnit unit) -> Result<void> {
    auto key = MBK_TRY(unit_from(unit.key));
    Result<store::UnitResult> result = store::UnitResult();
    if (!unit.differing.empty()) {
      result = bad_data(
          fmt::format("{} gives another result than {}", unit.differing[1].string(), unit.differing[0].string()),
          "two machines measured it differently; nothing of it is stored", key.file);
    } else if (unit.failed) {
      result = bad_data(unit.payload);
    } else {
      result = result_from(unit.payload);
    }
    queue.add(std::move(key), std::move(result));
    if (queue.error) return tl::unexpected(*queue.error);
    return {};
  });
  queue.finish();
  if (queue.error) return tl::unexpected(*queue.error);
  if (!merged) return tl::unexpected(merged.error());
  return static_cast<std::size_t>(merged->results + merged->failed + merged->conflicts);
}

std::string sum_of(const std::string& text) {
  return recording::sha256(std::as_bytes(std::span(text)));
}

/// Measures as a job of many processes. A job that was begun before is finished first, with its own recordings.
int measure_as_job(store::Store& study, const GivenOptions& options, const std::shared_ptr<const Measuring>& measuring,
                   const StudyMeasureArguments& arguments) {
  Tally tally;
  std::size_t count = 0;
  const auto key = key_in(study, *measuring);
  if (!key) return report_error(key.error());
  const std::string options_sum = sum_of(measuring->key + '\n' + std::string(version()));
  constexpr std::size_t kDigits = 12;
  batch::JobRequest request{std::string(kMeasureKind), measure_specification(study.folder(), options, *measuring)};
  request.compute = measure_units(measuring, study.folder());
  request.folder = study.folder() / "jobs" / ("measure-" + options_sum.substr(0, kDigits));
  const std::filesystem::path job_folder = arguments.engine.folder.value_or(request.folder);
  while (true) {
    const auto units = study.pending(*key, std::string(version()), arguments.again_failed && count == 0);
    if (!units) return report_error(units.error());
    if (units->empty() && !batch::JobFolder::is_there(job_folder)) return said_of(tally, count);
    auto lengths = lengths_of(study, *units);
    if (!lengths) return report_error(lengths.error());
    request.title = fmt::format("mbk study measure, {}", counted(std::ssize(*units), "recording", "recordings"));
    request.keys.clear();
    for (const store::Unit& unit : *units) request.keys.push_back(unit_key(unit));
    request.weights = std::move(*lengths);
    const auto carried = carry_out(arguments.engine, request, arguments.quiet);
    if (!carried) return report_error(carried.error());
    if (!carried->folder) return *carried->code;
    ResultQueue queue(study, *key, arguments.study.role);
    const auto begin = std::chrono::steady_clock::now();
    const auto collected = collect(*carried->folder, queue);
    tally += queue.tally;
    if (!collected) return report_error(collected.error());
    batch::note_merged(*carried->folder,
                       std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    count += *collected;
    if (carried->code) return said_of(tally, count, carried->code);
    if (!arguments.engine.keep) {
      if (auto ok = keep_record(*carried->folder, study.folder()); !ok) return report_error(ok.error());
      if (auto ok = carried->folder->remove(); !ok) return report_error(ok.error());
    }
    // What could not be read is not tried again at once.
    if (arguments.engine.keep || tally.unread > 0) return said_of(tally, count);
  }
}

int run(Command command, const StudyMeasureArguments& arguments) {
  auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  auto options = default_options(*study);
  if (!options) return report_error(options.error());
  for (const auto& [name, values] : given_options(command)) (*options)[name] = values;
  const auto measuring = measuring_of(*options);
  if (!measuring) return report_error(measuring.error());
  if (arguments.engine.kind) return measure_as_job(*study, *options, *measuring, arguments);
  const auto key = key_in(*study, **measuring);
  if (!key) return report_error(key.error());
  const auto units = study->pending(*key, std::string(version()), arguments.again_failed);
  if (!units) return report_error(units.error());
  ResultQueue queue(*study, *key, arguments.study.role, *units);
  measure_here(**measuring, study->folder(), *units, arguments, queue);
  if (queue.error) return report_error(*queue.error);
  return said_of(queue.tally, units->size());
}

}  // namespace

Action add_study_measure(Command group) {
  auto arguments = std::make_shared<StudyMeasureArguments>();
  const Command command = group.add_command("measure", "what is new, or whose options or version changed");
  command.footer(
      "Examples:\n"
      "  mbk study measure\n"
      "      with the study's default options (mbk study defaults)\n"
      "  mbk study measure --mode reference\n"
      "      another analysis beside the first; 'mbk study list' shows both\n"
      "  mbk study measure --again-failed\n"
      "  mbk study measure --engine slurm --tasks 40\n"
      "      as a job array on the cluster, 40 tasks at a time; the results are the same to the byte\n\n"
      "The options are those of 'mbk measure'; one that is given takes the place of the study's default. Each\n"
      "result is stored under the recording's hash, the options and the version of mbk. An interrupted run is\n"
      "taken up where it ended; the results are the same for any number of threads.\n\n"
      "Exit codes: 0 fine, 2 wrong usage, 3 a recording could not be measured, 4 none of the new results is usable.");
  add_study_and_role(command, arguments->study);
  command.add_flag("--again-failed", arguments->again_failed, "try again what could not be measured");
  command.add_flag("--quiet", arguments->quiet, "no progress on standard error");
  add_measuring_options(command, arguments->measuring);
  add_engine_options(command, arguments->engine);
  command.get_option("--threads").description("recordings measured at a time (as many as there are cores)");
  return [command, arguments] { return run(command, *arguments); };
}

}  // namespace mbk::app
