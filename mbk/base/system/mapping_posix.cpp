#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include "mbk/base/system/mapping.h"

namespace mbk::system {
namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

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
  return left_of(limit.rlim_cur, number_in("/proc/self/statm", 0) * page_size());
}

void* mapped(std::size_t count, int how) {
  constexpr std::size_t kLargePage = std::size_t{2} << 20;
  void* const room = ::mmap(nullptr, count, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | how, -1, 0);
  if (room == MAP_FAILED) return nullptr;
  ::madvise(room, count / kLargePage * kLargePage, MADV_HUGEPAGE);  // only advice: it may fail
  return room;
}

}  // namespace

std::uint64_t available_memory() {
  const std::uint64_t group =
      left_of(number_in("/sys/fs/cgroup/memory.max", kUnlimited), number_in("/sys/fs/cgroup/memory.current", 0));
  return std::min({available_to_the_system(), group, left_of_address_space()});
}

std::size_t page_size() {
  static const auto kSize = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  return kSize;
}

void* map_memory(std::size_t count) {
  return mapped(count, 0);
}

void* reserve_memory(std::size_t count) {
  return mapped(count, MAP_NORESERVE);
}

void unmap_memory(void* room, std::size_t count) {
  ::munmap(room, count);
}

void forget_memory(void* from, std::size_t count) {
  ::madvise(from, count, MADV_DONTNEED);
}

bool move_memory(void* from, void* to, std::size_t count) {
  constexpr int kHow = MREMAP_MAYMOVE | MREMAP_FIXED | MREMAP_DONTUNMAP;
  return ::mremap(from, count, count, kHow, to) != MAP_FAILED;
}

bool map_file_over(void* at, std::size_t count, const OpenFile& file, std::uint64_t place) {
  return ::mmap(at, count, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_FIXED, file.number(), static_cast<off_t>(place)) !=
         MAP_FAILED;
}

}  // namespace mbk::system
