#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "mbk/experiment/console/console.h"
#include "mbk/experiment/session/session.h"
#include "mbk/measure/measurement/measure.h"

namespace mbk::app {

struct ConsoleArguments {
  std::optional<bool> wanted;  ///< absent: at a terminal
  std::uint16_t port = 0;      ///< 0: any that is free
  bool wait = false;           ///< the page begins each trial
};

void add_console_options(CLI::App& command, ConsoleArguments& arguments);

/// How a trial is measured, while it runs and after it.
[[nodiscard]] measurement::Options measurement_options_of(const protocol::Trial& trial);

/// "median 4.3 µs, p99.9 …, worst …"
[[nodiscard]] std::string time_text(const realtime::CycleRecord& record);

enum class AfterTrial { next, repeat, end };

/// The console beside a run; every call is fine where there is none.
class RunConsole {
 public:
  /// Opens it where it is wanted, and prints its addresses.   @fails  as Console::open
  [[nodiscard]] static Result<RunConsole> open(const ConsoleArguments& arguments,
                                               const std::vector<protocol::Trial>& trials, session::Signals& signals);

  /// With --wait, waits for the page, and shows the robot of the first trial meanwhile.
  /// @returns  false where it would rather not
  [[nodiscard]] bool may_begin(session::Session& session, const protocol::Trial& first);

  [[nodiscard]] Result<void> begin(std::size_t index, const protocol::Trial& trial, const device::Facts& facts,
                                   const std::filesystem::path& target);
  void watch(std::span<const journal::Tick> ticks);

  /// What the robot said of its motors after a trial.
  void show_robot(const safety::MotorsOff& motors);
  /// What an IdleWatch is to call: the session and the page learn of the robot between trials.
  [[nodiscard]] std::function<void(const session::IdleState&)> watching(session::Session& session);

  /// @returns  what pages cost the loop, where there were any for a part of the time; else nothing
  [[nodiscard]] std::string finish(const session::TrialOutcome& outcome);

  /// Measures, and where there is a page that could open it makes the report too.   @fails  as measurement::measure
  [[nodiscard]] Result<Measurement> measured(const Recording& recording, const measurement::Options& options);

  /// Remarks go into the recording of the last trial.   @fails  as session::annotate
  [[nodiscard]] Result<void> keep_notes();

  /// Whether the page is asked what comes next.   @param doubtful  somebody has to be asked
  [[nodiscard]] bool decides(bool doubtful) const;
  [[nodiscard]] AfterTrial after_trial(session::Session& session, bool stopped);

  /// Stays while somebody looks.   @fails  as session::annotate
  [[nodiscard]] Result<void> end();

 private:
  std::unique_ptr<console::Console> console_;
  bool wait_ = false;
  std::filesystem::path last_;  // recording of the last trial; empty before the first
};

}  // namespace mbk::app
