#pragma once

#include <string>

namespace mbk::realtime {

/// What the operating system granted to the calling thread.
struct ThreadSetup {
  bool fifo = false;           ///< scheduled first in, first out, before everything that is not
  bool locked_memory = false;  ///< no page of the process is ever fetched from disk
  std::string refused;         ///< what was refused, why, and what would allow it; empty where nothing was
};

/// Fetches and locks the memory of the process, at the priority of the caller: it may take a tenth of a second, for
/// which a thread that goes before others would hold a processor. @returns whether it is locked; why not is said by
/// prepare_thread
bool lock_memory() noexcept;

/// Asks for locked memory for the process, then for SCHED_FIFO at `priority` (1–99) for the calling thread, and touches
/// the stack so that it is there. What is refused is said, never an error: a simulation needs neither.
[[nodiscard]] ThreadSetup prepare_thread(int priority = 80);

}  // namespace mbk::realtime
