#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/experiment/console/console.h"
#include "mbk/experiment/session/conduct.h"

namespace mbk::console {

/// The operator at the page: it is shown all that happens, and asked what comes next.
class PageOperator : public session::Operator {
 public:
  /// @param console  outlives this    @param wait  the page begins the first trial, and is asked after each
  /// @param warn  takes a sentence about a note that looks as if it said who somebody is; the page is shown it too
  PageOperator(Console& console, bool wait, std::function<void(const std::string&)> warn)
      : console_(console), wait_(wait), warn_(std::move(warn)) {}

  /// Waits for the page, and shows it the robot of the first trial meanwhile; true at once where nobody is to wait.
  /// @returns  false: it would rather not
  [[nodiscard]] bool may_begin(session::Session& session, const session::Experiment& experiment);

  [[nodiscard]] std::unique_ptr<session::Watcher> begin(const session::Attempt& attempt) override;
  void motors(const safety::MotorsOff& motors) override;
  void idle(const session::IdleState& seen) override;
  /// What was noted while the trial ran.
  [[nodiscard]] std::vector<std::string> notes() override;
  void recorded(const session::TrialOutcome& outcome) override;

  /// Shows what it is worth, and keeps its notes.
  [[nodiscard]] Result<void> judged(const session::Performed& performed) override;

  /// Asks the page where it decides, resets the gate where that says so, and keeps notes meanwhile.
  [[nodiscard]] session::Next next(session::Session& session, const session::Performed& performed) override;

  /// Whether the page is asked what comes next: always where it is waited for, else where somebody has to be asked and
  /// a page is in control.
  [[nodiscard]] bool decides(const session::Performed& performed) const;

  /// Remarks go into the recording of the last trial, exclusions into those that they speak of.
  /// @fails  as session::annotate and set_metadata
  [[nodiscard]] Result<void> keep_notes();

  /// Of the last trial; empty before the first is recorded.
  [[nodiscard]] const std::filesystem::path& recording() const { return recording_; }

 private:
  void warn_of_names(std::string_view what, const std::string& text);

  Console& console_;
  bool wait_;
  std::function<void(const std::string&)> warn_;
  std::atomic<bool> motors_missing_{false};  // the last trial ended without the robot's word that its motors are off
  std::filesystem::path recording_;
};

}  // namespace mbk::console
