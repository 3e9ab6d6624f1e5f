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

/// The console beside a run; every call is fine where there is none.
class RunConsole {
 public:
  /// Opens it where it is wanted, and prints its addresses.   @fails  as Console::open
  [[nodiscard]] static Result<RunConsole> open(const ConsoleArguments& arguments, const session::Experiment& experiment,
                                               session::LoopFlags& flags);

  /// Who decides there; null where there is none.
  [[nodiscard]] console::PageOperator* page() const { return page_.get(); }

  /// @returns  what pages cost the loop in the last trial, where there were any for a part of the time; else nothing
  [[nodiscard]] std::string times_text() const;

  /// Measures, and where there is a page that could open it makes the report too.   @fails  as measurement::measure
  [[nodiscard]] Result<Measurement> measured(const Recording& recording) const;

  /// Stays while somebody looks.   @fails  as session::annotate
  [[nodiscard]] Result<void> end() const;

 private:
  std::unique_ptr<console::Console> console_;
  std::unique_ptr<console::PageOperator> page_;
};

}  // namespace mbk::app
