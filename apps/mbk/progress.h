#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

namespace mbk::app {

/// Says on standard error how far the work is: nothing in the first second, then no more than once a second.
/// For one thread at a time.
class Progress {
 public:
  /// @param what  goes before the count: "coverage: "
  Progress(int total, bool quiet, std::string_view what = "") : total_(total), quiet_(quiet), what_(what) {}

  /// One more is done: "what3 of 8: name".
  void finished(std::string_view name = "") {
    ++done_;
    if (quiet_ || total_ < 2 || Clock::now() - last_ < std::chrono::seconds(1)) return;
    last_ = Clock::now();
    fmt::print(stderr, "{}{} of {}{}{}\n", what_, done_, total_, name.empty() ? "" : ": ", name);
  }

  /// A share of the one that is under way: "what40 %".
  void reached(double fraction) {
    if (quiet_ || Clock::now() - last_ < std::chrono::seconds(1)) return;
    last_ = Clock::now();
    fmt::print(stderr, "{}{:.0f} %\n", what_, 100.0 * fraction);
  }

 private:
  using Clock = std::chrono::steady_clock;
  int total_, done_ = 0;
  bool quiet_;
  std::string what_;
  Clock::time_point last_ = Clock::now();
};

}  // namespace mbk::app
