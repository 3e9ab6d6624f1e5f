#include "apps/mbk/memory.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace mbk::app {
namespace {

[[maybe_unused]] bool keeps_large_blocks = false;

}  // namespace

void prefer_large_pages() {
#if defined(__GLIBC__) && defined(MADV_HUGEPAGE)
  constexpr std::uintptr_t kPage = std::uintptr_t{2} << 20, kArena = std::uintptr_t{64} << 20;
  // What is larger goes back when it is freed: columns of hours, not what a file of a minute is unpacked to, in whose
  // place signals can stand later.
  mallopt(M_MMAP_THRESHOLD, 16 << 20);
  keeps_large_blocks = true;
  mallopt(M_TRIM_THRESHOLD, 128 << 20);
  mallopt(M_TOP_PAD, static_cast<int>(kArena));
  const auto end_of_heap = [] { return reinterpret_cast<std::uintptr_t>(sbrk(0)); };
  const std::uintptr_t before = end_of_heap();
  void* volatile some = std::malloc(kPage);  // here the heap grows by the arena
  std::free(some);
  const std::uintptr_t begin = (before + kPage - 1) / kPage * kPage, end = end_of_heap();
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);  // only advice: it may fail
#endif
}

void give_back_large_blocks() {
#if defined(__GLIBC__)
  if (keeps_large_blocks) mallopt(M_MMAP_THRESHOLD, 5 << 20);
#endif
}

}  // namespace mbk::app
