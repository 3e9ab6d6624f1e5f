// Loaded under a program (LD_PRELOAD), it lets one of its threads crash: in the MBK_CRASH_AFTERth call of the function
// MBK_CRASH_IN, by MBK_CRASH: pointer, stack, abort or terminate. Where MBK_SLEEPLESS is set,
// a sleep up to a time returns at once.
#include <dlfcn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>

namespace {

// NOLINTNEXTLINE(misc-no-recursion): it is to have no end
int overflow(const volatile char* before, int depth) {
  volatile char some[4096];
  some[0] = *before;
  return depth < 0 ? 0 : overflow(some, depth + 1) + some[0];
}

void crash() {
  const char* const how = std::getenv("MBK_CRASH");
  if (how == nullptr) return;
  if (std::strcmp(how, "pointer") == 0) {
    volatile int* volatile nowhere = nullptr;
    *nowhere = 1;
  }
  if (std::strcmp(how, "stack") == 0) overflow(how, 0);
  if (std::strcmp(how, "terminate") == 0) std::terminate();
  std::abort();
}

/// The handler of a crash may call what crashed.
void count(const char* function) {
  static std::atomic<long> calls{0};
  const char* const where = std::getenv("MBK_CRASH_IN");
  const char* const after = std::getenv("MBK_CRASH_AFTER");
  if (where == nullptr || after == nullptr || std::strcmp(where, function) != 0) return;
  if (++calls == std::atol(after)) crash();
}

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" ssize_t sendto(int socket, const void* bytes, size_t size, int flags, const sockaddr* to, socklen_t length) {
  static const auto function = real<decltype(&sendto)>("sendto");
  count("sendto");
  return function(socket, bytes, size, flags, to, length);
}

extern "C" int fdatasync(int descriptor) {
  static const auto function = real<decltype(&fdatasync)>("fdatasync");
  count("fdatasync");
  return function(descriptor);
}

extern "C" int clock_nanosleep(clockid_t clock, int flags, const timespec* until, timespec* left) {
  static const auto function = real<decltype(&clock_nanosleep)>("clock_nanosleep");
  static const bool sleepless = std::getenv("MBK_SLEEPLESS") != nullptr;
  return sleepless && flags == TIMER_ABSTIME ? 0 : function(clock, flags, until, left);
}
