#pragma once

#include <string>

namespace mbk::realtime {

/// What the operating system granted to the calling thread.
struct ThreadSetup {
  bool fifo = false;           ///< scheduled first in, first out, before all other threads
  bool locked_memory = false;  ///< no page of the process is ever fetched from disk
  std::string refused;         ///< what was refused, why, and what would allow it; empty if nothing was
};

/// Fetches and locks the memory of the process, at the priority of the caller: this may take a tenth of a second,
/// during which a real-time thread would occupy a processor. @returns whether it is locked; prepare_thread reports why
/// not
bool lock_memory() noexcept;
/// What of it was locked may leave it again.
void unlock_memory() noexcept;

/// Asks for locked memory for the process, then for SCHED_FIFO at `priority` (1–99) for the calling thread, and touches
/// the stack so that it is in memory. Refusals are reported, never an error: a simulation needs neither.
[[nodiscard]] ThreadSetup prepare_thread(int priority = 80);

}  // namespace mbk::realtime
