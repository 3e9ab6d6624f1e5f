#include "apps/mbk/terminal/memory.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

// mallinfo2 is there from glibc 2.33 on.
#if defined(__GLIBC__) && defined(MADV_HUGEPAGE)
#if __GLIBC_PREREQ(2, 33)
#define MBK_LARGE_PAGES
#endif
#endif

namespace mbk::app {
namespace {

[[maybe_unused]] void* volatile untouched = nullptr;  ///< before the first large page; nobody frees it

}  // namespace

void prefer_large_pages() {
#ifdef MBK_LARGE_PAGES
  constexpr std::uintptr_t kPage = std::uintptr_t{2} << 20, kArena = std::uintptr_t{64} << 20;
  // What is larger goes back when it is freed: columns of hours, not what a file of a minute is unpacked to, in whose
  // place signals can stand later.
  mallopt(M_MMAP_THRESHOLD, 16 << 20);
  mallopt(M_TRIM_THRESHOLD, 128 << 20);
  mallopt(M_TOP_PAD, static_cast<int>(kArena));
  const auto end_of_heap = [] { return reinterpret_cast<std::uintptr_t>(sbrk(0)); };
  // One block that nobody touches reaches from where the heap is free, by which it grows by the arena, to where its
  // first large page begins: so all that follows stands in large pages, and but for the last one fills them. The word
  // that the heap keeps before what is free stands before that page, too: a page of which a part is there cannot be a
  // large one. A block takes a word more than is asked for, and two are left before that page.
  constexpr std::uintptr_t kWord = sizeof(std::size_t);
  const std::uintptr_t before = end_of_heap(), free = before - mallinfo2().keepcost;
  const std::uintptr_t begin = (before / kPage + 1) * kPage;
  untouched = std::malloc(begin - free - 3 * kWord);
  const std::uintptr_t end = end_of_heap();
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);  // only advice: it may fail
#endif
}

void give_back_large_blocks() {
#ifdef MBK_LARGE_PAGES
  if (untouched != nullptr) mallopt(M_MMAP_THRESHOLD, 5 << 20);
#endif
}

}  // namespace mbk::app
