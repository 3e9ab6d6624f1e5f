#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "mbk/base/realtime/thread_setup.h"

namespace mbk::realtime {
namespace {

void touch_stack() {
  std::array<volatile std::byte, 256 * 1024> pages;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  for (std::size_t i = 0; i < pages.size(); i += 4096) pages[i] = std::byte{0};
}

}  // namespace

bool lock_memory() noexcept {
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
}

void unlock_memory() noexcept {
  munlockall();
}

ThreadSetup prepare_thread(int priority) {
  ThreadSetup setup;
  const auto refuse = [&](const char* what, int error, const char* remedy) {
    setup.refused += fmt::format("{}{}: {}; {}", setup.refused.empty() ? "" : ". ", what, std::strerror(error), remedy);
  };
  setup.locked_memory = lock_memory();  // while it takes long, nobody else is kept from running
  const int not_locked = errno;
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters); error == 0) {
    setup.fifo = true;
  } else {
    refuse("no real-time scheduling (SCHED_FIFO)", error,
           "give the user 'rtprio 90' in /etc/security/limits.d, or the program CAP_SYS_NICE");
  }
  if (!setup.locked_memory) {
    refuse("memory is not locked", not_locked, "give the user 'memlock unlimited' in /etc/security/limits.d");
  }
  touch_stack();
  return setup;
}

}  // namespace mbk::realtime
