#pragma once

// How much of some numbers is in memory, as the kernel counts it.

#include <fcntl.h>
#include <unistd.h>

#include <cstdint>
#include <optional>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::recording::test {

/// Pages in memory among those on which the numbers stand; nothing where the kernel does not say.
inline std::optional<Index> pages_in_memory(const Eigen::Ref<const Vector>& numbers) {
  const int map = ::open("/proc/self/pagemap", O_RDONLY | O_CLOEXEC);
  if (map < 0) return std::nullopt;
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(numbers.data()) / page,
                       end = reinterpret_cast<std::uintptr_t>(numbers.data() + numbers.size()) / page;
  std::optional<Index> present = 0;
  for (std::uintptr_t at = begin; at < end && present; ++at) {
    std::uint64_t entry = 0;
    if (::pread(map, &entry, sizeof entry, static_cast<off_t>(at * sizeof entry)) != sizeof entry) {
      present.reset();
    } else {
      *present += (entry >> 63U) != 0 ? 1 : 0;
    }
  }
  ::close(map);
  return present;
}

}  // namespace mbk::recording::test
