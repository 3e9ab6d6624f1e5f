#pragma once

#include <fmt/format.h>

#include <chrono>
#include <string>
#include <string_view>

#include "apps/mbk/caller.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/terminal.h"
#include "mbk/base/system/terminal.h"

namespace mbk::app {

/// Reports progress and the remaining time on standard error: nothing in the first second, then at most once a second;
/// in a pipe or file at most once every ten per cent. A caller in the process is notified every time, and may stop the
/// work.   For one thread at a time.
class Progress {
 public:
  /// @param what  printed before the count: "coverage: "
  explicit Progress(bool quiet, std::string_view what = "") : quiet_(quiet), what_(what) {}

  /// "what3 of 8: name, about 40 s left".
  void count(int done, int of, std::string_view name = "") {
    const double fraction = of > 0 ? static_cast<double>(done) / of : 0.0;
    if (Caller* const caller = Caller::current(); caller != nullptr) {
      caller->reached(fmt::format("{}{}", what_, name), fraction);
      return;
    }
    if (of < 2 || !due(fraction)) return;
    say("{}{} of {}{}{}{}\n", what_, done, of, name.empty() ? "" : ": ", name, left(fraction));
  }

  /// Fraction of a single task: "what40 %".
  void reached(double fraction) {
    if (Caller* const caller = Caller::current(); caller != nullptr) {
      caller->reached(what_, fraction);
      return;
    }
    if (due(fraction)) say("{}{:.0f} %{}\n", what_, 100.0 * fraction, left(fraction));
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;

  bool due(double fraction) {
    if (fraction < said_) {  // another part begins
      said_ = 0.0;
      begun_ = Clock::now();
    }
    if (quiet_ || Clock::now() - last_ < std::chrono::seconds(1)) return false;
    constexpr double kStep = 0.1;
    if (!terminal_ && fraction < said_ + kStep) return false;
    last_ = Clock::now();
    said_ = fraction;
    return true;
  }

  /// The remaining time at the pace so far, if it is more than a moment and enough has been done to estimate it.
  [[nodiscard]] std::string left(double fraction) const {
    constexpr double kEnough = 0.05, kMoment = 5.0, kMinute = 60.0, kMinutes = 2.0 * kMinute;
    if (fraction < kEnough) return "";
    const double seconds = Seconds(Clock::now() - begun_).count() * (1.0 - fraction) / fraction;
    if (seconds < kMoment) return "";
    return seconds < kMinutes ? fmt::format(", about {:.0f} s left", seconds)
                              : fmt::format(", about {:.0f} min left", seconds / kMinute);
  }

  bool quiet_, terminal_ = terminal_at(system::kError).there;
  std::string what_;
  double said_ = 0.0;
  Clock::time_point begun_ = Clock::now(), last_ = begun_;
};

}  // namespace mbk::app
