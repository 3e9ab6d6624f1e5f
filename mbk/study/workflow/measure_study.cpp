#include "mbk/study/workflow/measure_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "mbk/base/core/counted.h"
#include "mbk/base/core/version.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/batch/merge.h"
#include "mbk/study/workflow/measure_units.h"
#include "mbk/study/workflow/rounding.h"

namespace mbk::workflow {
namespace {

/// Takes results in whatever order they come, and stores them in the order of their keys: many in one transaction, but
/// none waits for more than a second.
class ResultQueue {
 public:
  /// @param units  those that set() and done() speak of
  ResultQueue(store::Store& study, std::string key, const MeasureListener& listener,
              std::vector<store::Unit> units = {})
      : study_(study), key_(std::move(key)), listener_(listener), units_(std::move(units)), results_(units_.size()) {}

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
      return study_.save(key_, std::string(version()), units, results, listener_.role);
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
      if (!stopped) listener_.unread(result.error());
      ++tally.unread;
      return;
    }
    if (result->document.empty()) {
      listener_.failed(unit, result->reason);
    } else if (!result->usable) {
      listener_.not_usable(unit, result->reason);
    }
    ++(result->usable ? tally.usable : result->document.empty() ? tally.failed : tally.not_usable);
    waiting_units_.push_back(std::move(unit));
    waiting_results_.push_back(std::move(*result));
  }

  store::Store& study_;
  std::string key_;
  const MeasureListener& listener_;
  std::vector<store::Unit> units_;
  std::vector<std::optional<Result<store::UnitResult>>> results_;
  std::vector<bool> ready_ = std::vector<bool>(units_.size());
  std::size_t next_ = 0;
  std::vector<store::Unit> waiting_units_;
  std::vector<store::UnitResult> waiting_results_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::future<Result<int>> being_stored_;
};

/// How long a recording takes is about how long it is.
Result<std::vector<double>> lengths_of(const store::Store& study, const std::vector<store::Unit>& units) {
  const auto recordings = MBK_TRY(study.recordings());
  std::map<std::pair<std::string, std::int64_t>, double> length;
  for (const store::StoredRecording& one : recordings) length[{one.sha256, one.part}] = one.duration_s;
  std::vector<double> lengths;
  for (const store::Unit& unit : units) lengths.push_back(std::max(length[{unit.sha256, unit.part}], 1.0));
  return lengths;
}

/// Measures the results of this version again, and holds them against what is stored. They are the same to the last
/// byte on the same machine; on others they are the same but for rounding.
class Repeater {
 public:
  Repeater(const store::Store& study, unsigned threads, const std::function<void(int, int)>& progress,
           store::CheckReport& report)
      : study_(study), threads_(threads), progress_(progress), report_(report) {}

  Result<void> repeat_all() {
    const auto analyses = MBK_TRY(study_.analyses());
    for (const store::Analysis& analysis : analyses) {
      MBK_TRY(repeat(analysis));
    }
    return {};
  }

 private:
  Result<void> repeat(const store::Analysis& analysis) {
    const auto units = MBK_TRY(study_.measured(analysis.number));
    if (units.empty()) return {};
    const std::string count = counted(std::ssize(units), "result", "results");
    if (analysis.version != version()) {
      report_.notes.push_back(fmt::format("{} of analysis {} not repeated: made by mbk {}, this is {}", count,
                                          analysis.number, analysis.version, version()));
      return {};
    }
    const auto options = MBK_TRY(options_from_json(analysis.options));
    if (names_files(options)) {
      report_.notes.push_back(
          fmt::format("{} of analysis {} not repeated: they depend on a file (--robot, --sensor) that a study does not "
                      "keep",
                      count, analysis.number));
      return {};
    }
    const auto measuring = MBK_TRY(measuring_of(options));
    return repeat(analysis, *measuring, units);
  }

  Result<void> repeat(const store::Analysis& analysis, const Measuring& measuring,
                      const std::vector<store::Unit>& units) {
    std::vector<std::string> problems(units.size());
    int done = 0, rounded = 0;
    MBK_TRY(numeric::parallel_for(
        static_cast<int>(units.size()), threads_,
        [&](int k) -> Result<void> {
          const store::Unit& unit = units[static_cast<std::size_t>(k)];
          const auto again = measure_unit(measuring, study_.folder(), unit);
          std::string& problem = problems[static_cast<std::size_t>(k)];
          if (!again) {
            problem = again.error().line();
            return {};
          }
          const std::scoped_lock lock(mutex_);
          const auto stored = MBK_TRY(study_.document(unit, analysis.number));
          if (stored == again->document) return {};
          if (same_but_for_rounding(stored, again->document)) {
            ++rounded;
          } else {
            problem = fmt::format("{}: measuring it again gives a different result (analysis {})", unit.file,
                                  analysis.number);
          }
          return {};
        },
        [&](int) { progress_(++done, static_cast<int>(units.size())); }));
    if (rounded > 0) {
      report_.notes.push_back(fmt::format("{} of analysis {} the same but for rounding: made on another machine",
                                          counted(rounded, "result", "results"), analysis.number));
    }
    for (std::string& problem : problems) {
      if (problem.empty()) {
        ++report_.repeated;
      } else {
        report_.problems.push_back(std::move(problem));
      }
    }
    return {};
  }

  const store::Store& study_;
  unsigned threads_;
  const std::function<void(int, int)>& progress_;
  store::CheckReport& report_;
  std::mutex mutex_;  ///< the store is for one thread at a time
};

}  // namespace

Tally& Tally::operator+=(const Tally& other) {
  usable += other.usable;
  not_usable += other.not_usable;
  failed += other.failed;
  unread += other.unread;
  return *this;
}

Result<Tally> measure_units_here(store::Store& study, const std::string& key, const Measuring& measuring,
                                 const std::vector<store::Unit>& units, unsigned threads,
                                 const MeasureListener& listener) {
  ResultQueue queue(study, key, listener, units);
  const int count = static_cast<int>(units.size());
  int done = 0;
  std::ignore = numeric::parallel_for(
      count, threads,
      [&](int k) -> Result<void> {
        const store::Unit& unit = units[static_cast<std::size_t>(k)];
        queue.set(k, queue.stopped ? bad_data("not measured") : measure_unit(measuring, study.folder(), unit));
        return {};
      },
      [&](int k) {
        queue.done(k);
        listener.progress(++done, count);
      });
  queue.finish();
  if (queue.error) return tl::unexpected(*queue.error);
  return queue.tally;
}

Result<batch::JobRequest> measure_request(const store::Store& study, const OptionTexts& given,
                                          const std::shared_ptr<const Measuring>& measuring,
                                          const std::vector<store::Unit>& units) {
  auto lengths = MBK_TRY(lengths_of(study, units));
  batch::JobRequest request;
  request.kind = kMeasureKind;
  request.specification = measure_specification(study.folder(), given, *measuring);
  request.title = fmt::format("mbk study measure, {}", counted(std::ssize(units), "recording", "recordings"));
  for (const store::Unit& unit : units) request.keys.push_back(unit_key(unit));
  request.weights = std::move(lengths);
  request.compute = measure_units(measuring, study.folder());
  request.folder =
      study.folder() / "jobs" / batch::job_name(request.kind, measuring->key + '\n' + std::string(version()));
  return request;
}

Result<Tally> collect_job(store::Store& study, const std::string& key, const batch::JobFolder& job,
                          const MeasureListener& listener) {
  ResultQueue queue(study, key, listener);
  const auto merged = batch::merge(job, [&](batch::MergedUnit unit) -> Result<void> {
    auto stored = MBK_TRY(unit_from(unit.key));
    Result<store::UnitResult> result = store::UnitResult();
    if (!unit.differing.empty()) {
      result = bad_data(
          fmt::format("{} gives a different result from {}", unit.differing[1].string(), unit.differing[0].string()),
          "two computers measured it differently, so nothing is stored; compare the programs and the files",
          stored.file);
    } else if (unit.failed) {
      result = bad_data(unit.payload);
    } else {
      result = result_from(unit.payload);
    }
    queue.add(std::move(stored), std::move(result));
    if (queue.error) return tl::unexpected(*queue.error);
    return {};
  });
  queue.finish();
  if (queue.error) return tl::unexpected(*queue.error);
  if (!merged) return tl::unexpected(merged.error());
  return queue.tally;
}

Result<void> repeat_results(const store::Store& study, unsigned threads, const std::function<void(int, int)>& progress,
                            store::CheckReport& report) {
  return Repeater(study, threads, progress, report).repeat_all();
}

}  // namespace mbk::workflow
