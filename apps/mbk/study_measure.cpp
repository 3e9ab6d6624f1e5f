#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <tuple>

#include "apps/mbk/messages.h"
#include "apps/mbk/option_checks.h"
#include "apps/mbk/progress.h"
#include "apps/mbk/study_commands.h"
#include "apps/mbk/study_options.h"
#include "mbk/base/core/version.h"
#include "mbk/base/numeric/parallel.h"

namespace mbk::app {
namespace {

struct StudyMeasureArguments {
  StudyArguments study;
  MeasuringArguments measuring;
  bool again_failed = false, quiet = false;
};

/// Takes results in whatever order they come, and stores them in the order of their keys: many in one transaction, but
/// none waits for more than a second.
class ResultQueue {
 public:
  ResultQueue(store::Store& study, const Measuring& measuring, const std::vector<store::Unit>& units, store::Role role)
      : study_(study), measuring_(measuring), units_(units), role_(role), results_(units.size()) {}

  void set(int k, Result<store::UnitResult> result) { results_[static_cast<std::size_t>(k)] = std::move(result); }

  /// Called for each when it is there, never two at a time.
  void done(int k) {
    ready_.at(static_cast<std::size_t>(k)) = true;
    while (next_ < ready_.size() && ready_[next_]) take(next_++);
    const auto now = std::chrono::steady_clock::now();
    if (std::ssize(waiting_units_) >= kMany || now - last_ > std::chrono::seconds(1)) store();
  }

  void store() {
    last_ = std::chrono::steady_clock::now();
    if (waiting_units_.empty() || error) return;
    const auto saved = study_.save(measuring_.key, std::string(version()), waiting_units_, waiting_results_, role_);
    if (!saved) {
      error = saved.error();
      stopped = true;
    }
    waiting_units_.clear();
    waiting_results_.clear();
  }

  std::optional<Error> error;         ///< results could not be stored
  std::atomic<bool> stopped = false;  ///< no more are asked for
  int usable = 0, not_usable = 0, failed = 0, unread = 0;

 private:
  static constexpr std::ptrdiff_t kMany = 64;

  void take(std::size_t k) {
    Result<store::UnitResult>& result = *results_[k];
    if (!result) {
      if (!stopped) std::ignore = report_error(result.error());
      ++unread;
      return;
    }
    if (result->document.empty()) say("mbk: {}: {}\n", units_[k].file, result->reason);
    ++(result->usable ? usable : result->document.empty() ? failed : not_usable);
    waiting_units_.push_back(units_[k]);
    waiting_results_.push_back(std::move(*result));
    results_[k].reset();
  }

  store::Store& study_;
  const Measuring& measuring_;
  const std::vector<store::Unit>& units_;
  store::Role role_;
  std::vector<std::optional<Result<store::UnitResult>>> results_;
  std::vector<bool> ready_ = std::vector<bool>(units_.size());
  std::size_t next_ = 0;
  std::vector<store::Unit> waiting_units_;
  std::vector<store::UnitResult> waiting_results_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

int run(const CLI::App& command, const StudyMeasureArguments& arguments) {
  auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  auto options = default_options(*study);
  if (!options) return report_error(options.error());
  for (const auto& [name, values] : given_options(command)) (*options)[name] = values;
  const auto measuring = measuring_of(*options);
  if (!measuring) return report_error(measuring.error());
  const auto units = study->pending((*measuring)->key, std::string(version()), arguments.again_failed);
  if (!units) return report_error(units.error());

  const int count = static_cast<int>(units->size());
  ResultQueue queue(*study, **measuring, *units, arguments.study.role);
  Progress progress(arguments.quiet);
  int done = 0;
  std::ignore = numeric::parallel_for(
      count, arguments.measuring.threads,
      [&](int k) -> Result<void> {
        const store::Unit& unit = (*units)[static_cast<std::size_t>(k)];
        queue.set(k, queue.stopped ? bad_data("not measured") : measure_unit(**measuring, study->folder(), unit));
        return {};
      },
      [&](int k) {
        queue.done(k);
        progress.count(++done, count);
      });
  queue.store();
  if (queue.error) return report_error(*queue.error);
  std::string text = count == 0 ? "nothing new to measure\n"
                                : fmt::format("{} measured: {} usable, {} not usable, {} could not be measured\n",
                                              count, queue.usable, queue.not_usable, queue.failed + queue.unread);
  if (auto ok = Output().write(text); !ok) return report_error(ok.error());
  if (queue.unread + queue.failed > 0) return kBadData;
  return queue.not_usable > 0 && queue.usable == 0 ? kNotUsable : kFine;
}

}  // namespace

Action add_study_measure(CLI::App& group) {
  auto arguments = std::make_shared<StudyMeasureArguments>();
  CLI::App* command = add_command(group, "measure", "what is new, or whose options or version changed");
  command->footer(
      "Examples:\n"
      "  mbk study measure\n"
      "      with the study's default options (mbk study defaults)\n"
      "  mbk study measure --mode reference\n"
      "      another analysis beside the first; 'mbk study list' shows both\n"
      "  mbk study measure --again-failed\n\n"
      "The options are those of 'mbk measure'; one that is given takes the place of the study's default. Each\n"
      "result is stored under the recording's hash, the options and the version of mbk. An interrupted run is\n"
      "taken up where it ended; the results are the same for any number of threads.\n\n"
      "Exit codes: 0 fine, 2 wrong usage, 3 a recording could not be measured, 4 none of the new results is usable.");
  add_study_and_role(*command, arguments->study);
  command->add_flag("--again-failed", arguments->again_failed, "try again what could not be measured");
  command->add_flag("--quiet", arguments->quiet, "no progress on standard error");
  add_measuring_options(*command, arguments->measuring);
  command->get_option("--threads")->description("recordings measured at a time (as many as there are cores)");
  return [command, arguments] { return run(*command, *arguments); };
}

}  // namespace mbk::app
