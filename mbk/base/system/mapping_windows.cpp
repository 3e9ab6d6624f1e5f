#include <limits>

#include "mbk/base/system/mapping.h"
#include "mbk/base/system/windows_api.h"

namespace mbk::system {

std::uint64_t available_memory() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  return GlobalMemoryStatusEx(&status) != 0 ? status.ullAvailPhys : std::numeric_limits<std::uint64_t>::max();
}

std::size_t page_size() {
  SYSTEM_INFO information{};
  GetSystemInfo(&information);
  return information.dwPageSize;
}

void* map_memory(std::size_t count) {
  return VirtualAlloc(nullptr, count, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);
}

void* reserve_memory(std::size_t count) {
  return map_memory(count);
}

void unmap_memory(void* room, std::size_t /*count*/) {
  VirtualFree(room, 0, MEM_RELEASE);
}

void forget_memory(void* from, std::size_t count) {
  VirtualFree(from, count, MEM_DECOMMIT);
}

bool move_memory(void* /*from*/, void* /*to*/, std::size_t /*count*/) {
  return false;
}

bool map_file_over(void* /*at*/, std::size_t /*count*/, const OpenFile& /*file*/, std::uint64_t /*place*/) {
  return false;
}

}  // namespace mbk::system
