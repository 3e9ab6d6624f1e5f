#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "apps/mbk/caller.h"
#include "apps/mbk/messages.h"

namespace mbk::app {

/// Says on standard error how far the work is: nothing in the first second, then no more than once a second. A caller
/// in the process is told every time, and may stop it.   For one thread at a time.
class Progress {
 public:
  /// @param what  goes before the count: "coverage: "
  explicit Progress(bool quiet, std::string_view what = "") : quiet_(quiet), what_(what) {}

  /// "what3 of 8: name".
  void count(int done, int of, std::string_view name = "") {
    if (Caller* const caller = Caller::current(); caller != nullptr) {
      caller->reached(fmt::format("{}{}", what_, name), of > 0 ? static_cast<double>(done) / of : 0.0);
      return;
    }
    if (of < 2 || !due()) return;
    say("{}{} of {}{}{}\n", what_, done, of, name.empty() ? "" : ": ", name);
  }

  /// A share of the one that is under way: "what40 %".
  void reached(double fraction) {
    if (Caller* const caller = Caller::current(); caller != nullptr) {
      caller->reached(what_, fraction);
      return;
    }
    if (due()) say("{}{:.0f} %\n", what_, 100.0 * fraction);
  }

 private:
  using Clock = std::chrono::steady_clock;
  bool due() {
    if (quiet_ || Clock::now() - last_ < std::chrono::seconds(1)) return false;
    last_ = Clock::now();
    return true;
  }

  bool quiet_;
  std::string what_;
  Clock::time_point last_ = Clock::now();
};

}  // namespace mbk::app
