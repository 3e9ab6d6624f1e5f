#include "mbk/base/realtime/thread_setup.h"

// Windows keeps no real time.
namespace mbk::realtime {

bool lock_memory() noexcept {
  return false;
}

void unlock_memory() noexcept {}

ThreadSetup prepare_thread(int /*priority*/) {
  ThreadSetup setup;
  setup.refused = "Windows has no real-time scheduling; run experiments on Linux";
  return setup;
}

}  // namespace mbk::realtime
