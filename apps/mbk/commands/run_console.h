#pragma once

#include <memory>
#include <optional>
#include <string>

#include "apps/mbk/terminal/command.h"
#include "mbk/experiment/console/console.h"
#include "mbk/experiment/console/page_operator.h"
#include "mbk/experiment/session/conduct.h"

namespace mbk::app {

struct ConsoleArguments {
  std::optional<bool> requested;  ///< absent: at a terminal
  std::uint16_t port = 0;         ///< 0: any that is free
  bool wait = false;              ///< the page starts each trial
  std::string texts;              ///< of the participant's page: ready ones, or a file; empty: "en"
};

void add_console_options(Command command, ConsoleArguments& arguments);

/// "median 4.3 µs, p99.9 …, worst …"
[[nodiscard]] std::string time_text(const realtime::CycleRecord& record);

/// The console of a run; every call is valid without one.
class RunConsole {
 public:
  /// Opens it if requested, and prints its addresses.   @fails  as Console::open
  [[nodiscard]] static Result<RunConsole> open(const ConsoleArguments& arguments, const session::Experiment& experiment,
                                               session::LoopFlags& flags);

  /// The operator at the page; null if there is none.
  [[nodiscard]] console::PageOperator* page() const { return page_.get(); }

  /// @returns  loop times of the last trial with and without open pages, if there were both; otherwise nothing
  [[nodiscard]] std::string times_text() const;

  /// Measures, and also writes the report if there is a page to show it.   @fails  as measurement::measure
  [[nodiscard]] Result<Measurement> measured(const Recording& recording) const;

  /// Waits until its pages are closed.   @fails  as session::annotate
  [[nodiscard]] Result<void> end() const;

 private:
  std::unique_ptr<console::Console> console_;
  std::unique_ptr<console::PageOperator> page_;
};

}  // namespace mbk::app
