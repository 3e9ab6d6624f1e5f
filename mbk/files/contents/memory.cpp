#include "mbk/files/contents/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace mbk::recording {
namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kSmall = std::uint64_t{64} << 20;  ///< not worth asking for

/// The number that a file of the system begins with; a text such as "max" is none.
std::uint64_t number_in(const char* file, std::uint64_t otherwise) {
  std::ifstream stream(file);
  std::uint64_t value = 0;
  return stream >> value ? value : otherwise;
}

std::uint64_t available_to_the_system() {
  std::ifstream stream("/proc/meminfo");
  for (std::string name, unit; stream >> name;) {
    std::uint64_t kilobytes = 0;
    if (!(stream >> kilobytes)) break;
    if (name == "MemAvailable:") return kilobytes * 1024;
    std::getline(stream, unit);
  }
  return kUnlimited;
}

std::uint64_t left_of(std::uint64_t limit, std::uint64_t used) {
  return limit == kUnlimited ? kUnlimited : limit - std::min(limit, used);
}

std::uint64_t left_of_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return left_of(limit.rlim_cur, number_in("/proc/self/statm", 0) * page);
}

}  // namespace

std::uint64_t available_memory() {
  const std::uint64_t group =
      left_of(number_in("/sys/fs/cgroup/memory.max", kUnlimited), number_in("/sys/fs/cgroup/memory.current", 0));
  return std::min({available_to_the_system(), group, left_of_address_space()});
}

Result<void> check_memory(std::uint64_t bytes) {
  if (bytes <= kSmall) return {};
  const std::uint64_t available = available_memory();
  if (bytes <= available) return {};
  const auto gigabytes = [](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(1u << 30u); };
  return bad_data(fmt::format("it needs {:.2f} GiB of memory, but {:.2f} GiB are available", gigabytes(bytes),
                              gigabytes(available)),
                  "close other programs, or split the recording into numbered parts");
}

}  // namespace mbk::recording
