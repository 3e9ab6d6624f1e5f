#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "mbk/base/core/printable.h"

namespace mbk::app {

/// Writes a message to standard error, from any thread. Never throws; messages that could not be written are counted.
/// Unless a BackgroundMessages exists, the text is written before `say_text` returns.
void say_text(std::string_view text) noexcept;

/// Counts a message that could not be formatted for lack of memory.
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

/// As fmt::print(stderr, …). Text in `args`, such as a file name, cannot control a terminal; only `format` can.
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

/// Warns that `former` is a name from before 1.0, which is still read.
inline void say_former_name(std::string_view former, std::string_view now) noexcept {
  say("warning: {} is now {}; the former name goes with mbk 1.2\n", former, now);
}

/// Waits until every message is written, for at most this time; the rest is discarded and counted as lost.
/// @returns  whether every message was written
bool flush_messages(std::chrono::milliseconds longest = std::chrono::milliseconds(200)) noexcept;

/// Messages that standard error did not accept.
struct LostMessages {
  std::uint64_t count = 0;
  std::string why;  ///< of the last one: "No space left on device"
};

/// Those since the last call; flushes first.
[[nodiscard]] LostMessages take_lost_messages();

/// During its lifetime a separate thread writes the messages, so that an unread pipe, a terminal stopped by Ctrl-S or a
/// stalled disk blocks no other thread. Messages beyond the capacity of its queue are lost.
class BackgroundMessages {
 public:
  BackgroundMessages();
  BackgroundMessages(const BackgroundMessages&) = delete;
  BackgroundMessages& operator=(const BackgroundMessages&) = delete;
  ~BackgroundMessages();
};

}  // namespace mbk::app
