#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <string_view>

#include "apps/mbk/caller.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/terminal.h"

namespace mbk::app {

/// Says on standard error how far the work is, and where it takes longer how long it will take: nothing in the first
/// second, then no more than once a second; in a pipe or a file no more than once in ten per cent. A caller in the
/// process is told every time, and may stop it.   For one thread at a time.
class Progress {
 public:
  /// @param what  goes before the count: "coverage: "
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

  /// A share of the one that is under way: "what40 %".
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

  /// As long as what is left takes at the pace so far, where that is more than a moment and enough was done to tell.
  [[nodiscard]] std::string left(double fraction) const {
    constexpr double kEnough = 0.05, kMoment = 5.0, kMinute = 60.0, kMinutes = 2.0 * kMinute;
    if (fraction < kEnough) return "";
    const double seconds = Seconds(Clock::now() - begun_).count() * (1.0 - fraction) / fraction;
    if (seconds < kMoment) return "";
    return seconds < kMinutes ? fmt::format(", about {:.0f} s left", seconds)
                              : fmt::format(", about {:.0f} min left", seconds / kMinute);
  }

  bool quiet_, terminal_ = terminal_at(STDERR_FILENO).there;
  std::string what_;
  double said_ = 0.0;
  Clock::time_point begun_ = Clock::now(), last_ = begun_;
};

}  // namespace mbk::app
