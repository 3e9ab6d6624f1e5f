#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "mbk/base/core/printable.h"

namespace mbk::app {

/// What the program says on standard error goes through here, from any thread. Nothing throws; what could not be
/// written is counted. Outside of a BackgroundMessages it is written before `say_text` returns.
void say_text(std::string_view text) noexcept;

/// One that could not even be put together: there is no memory for it.
void count_lost_message() noexcept;

/// Text as `printable_lines` shows it, anything else as it is.
template <class Arg>
[[nodiscard]] auto shown_argument(const Arg& arg) {
  if constexpr (std::is_convertible_v<const Arg&, std::string_view>) {
    return printable_lines(arg);
  } else {
    return arg;
  }
}

/// As fmt::print(stderr, …). Text among `args`, such as the name of a file, cannot drive a terminal: what the program
/// itself says to one stands in `format`.
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) noexcept {
  try {
    const auto print = [&](const auto&... shown) {
      say_text(fmt::vformat(fmt::string_view(format), fmt::make_format_args(shown...)));
    };
    print(shown_argument(args)...);
  } catch (...) {
    count_lost_message();
  }
}

/// Waits until everything said is written, at most so long; what is not written then never will be, and counts as lost.
/// @returns  whether all is written
bool flush_messages(std::chrono::milliseconds longest = std::chrono::milliseconds(200)) noexcept;

/// Messages that standard error did not take.
struct LostMessages {
  std::uint64_t count = 0;
  std::string why;  ///< the last one's reason: "No space left on device"
};

/// Since it was last asked; flushes before.
[[nodiscard]] LostMessages take_lost_messages();

/// While it lives, a thread of its own writes the messages, so that a pipe that nobody reads, a terminal that is held
/// by Ctrl-S or a disk that stalls keeps nobody else waiting: a queue takes so many, and more are lost.
class BackgroundMessages {
 public:
  BackgroundMessages();
  BackgroundMessages(const BackgroundMessages&) = delete;
  BackgroundMessages& operator=(const BackgroundMessages&) = delete;
  ~BackgroundMessages();
};

}  // namespace mbk::app
