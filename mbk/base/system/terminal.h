#pragma once

#include <chrono>
#include <cstddef>

/// Standard input, output and error, by their numbers 0 to 2.
namespace mbk::system {

inline constexpr int kInput = 0, kOutput = 1, kError = 2;

[[nodiscard]] bool is_terminal(int descriptor);
[[nodiscard]] std::size_t terminal_columns(int descriptor);  ///< 0 where nobody says
[[nodiscard]] bool shows_colours(int descriptor);            ///< of a terminal

/// To be called at the beginning of main, before anything is opened.
/// - Closed descriptors 0 to 2 are opened, so that no file that is opened later takes their number and receives
///   standard output or standard error. Reading from them finds the end, writing fails.
/// - Writing to a pipe without reader or to a file of maximum size returns an error (EPIPE, EFBIG) instead of a signal
///   that ends the program.
/// - What is written is UTF-8, byte by byte.
/// @returns  false: a descriptor is closed and cannot be opened
[[nodiscard]] bool prepare_streams() noexcept;

/// Until what is written to the descriptor need not wait, at most so long.   @returns  false: it still has to
[[nodiscard]] bool wait_for_room(int descriptor, std::chrono::milliseconds longest) noexcept;

/// Ends the program as one that writes to a pipe that nobody reads, so that shells see the cause; where programs do not
/// end so it returns.
void end_without_reader() noexcept;

}  // namespace mbk::system
