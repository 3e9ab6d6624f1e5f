#include "mbk/files/contents/disk_pages.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <utility>

namespace mbk::recording {
namespace {

constexpr std::array kSignals = {&PreparedTrial::position,          &PreparedTrial::velocity,
                                 &PreparedTrial::acceleration,      &PreparedTrial::force_hand_on_robot,
                                 &PreparedTrial::force_sensitivity, &PreparedTrial::reference,
                                 &PreparedTrial::reference_motion};

std::uintptr_t page_size() {
  static const auto kSize = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  return kSize;
}

/// The whole pages among numbers.
struct Pages {
  std::uintptr_t begin, end;

  Pages(const double* first, Index count)
      : begin((address_of(first) + page_size() - 1) / page_size() * page_size()),
        end(address_of(first + count) / page_size() * page_size()) {}
  [[nodiscard]] bool empty() const { return begin >= end; }
  [[nodiscard]] std::size_t size() const { return end - begin; }

  static std::uintptr_t address_of(const double* number) { return reinterpret_cast<std::uintptr_t>(number); }
};

void* at(std::uintptr_t address) {
  return reinterpret_cast<void*>(address);  // NOLINT(performance-no-int-to-ptr): pages are counted in numbers
}

bool write_all(int descriptor, const char* from, std::size_t count, std::size_t offset) {
  for (std::size_t done = 0; done < count;) {
    const ssize_t wrote = ::pwrite(descriptor, from + done, count - done, static_cast<off_t>(offset + done));
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return false;
    done += static_cast<std::size_t>(wrote);
  }
  return true;
}

}  // namespace

DiskPages::~DiskPages() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool DiskPages::open() {
  if (descriptor_ >= 0 || failed_) return !failed_;
  const char* const chosen = std::getenv("TMPDIR");
  const char* const folder = chosen != nullptr && *chosen != '\0' ? chosen : "/var/tmp";
  descriptor_ = ::open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  failed_ = descriptor_ < 0;
  return !failed_;
}

Index DiskPages::take(double* first, Index count) {
  const Pages pages(first, count);
  if (pages.empty() || !open()) return 0;
  failed_ = !write_all(descriptor_, static_cast<const char*>(at(pages.begin)), pages.size(), size_) ||
            ::mmap(at(pages.begin), pages.size(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_FIXED, descriptor_,
                   static_cast<off_t>(size_)) == MAP_FAILED;
  if (failed_) return 0;
  size_ += pages.size();
  return static_cast<Index>((pages.end - Pages::address_of(first)) / sizeof(double));
}

DiskPages::Coming DiskPages::expect(double* first, Index count) {
  const Pages pages(first, count);
  Coming coming{first, count, 0, size_, !pages.empty() && open()};
  if (coming.on_disk) size_ += pages.size();
  return coming;
}

void DiskPages::add(Coming& coming, const double* from, Index count) {
  const Pages pages(coming.first, coming.count);
  const std::uintptr_t begin = Pages::address_of(coming.first + coming.come);
  const std::uintptr_t end = begin + static_cast<std::size_t>(count) * sizeof(double);
  const std::uintptr_t first = std::clamp(pages.begin, begin, end), last = std::clamp(pages.end, begin, end);
  if (coming.on_disk && first < last &&
      !write_all(descriptor_, reinterpret_cast<const char*>(from) + (first - begin), last - first,
                 coming.offset + (first - pages.begin))) {
    failed_ = true;
    arrived(coming);
  }
  // Numbers that do not fill a page, or all.
  double* const to = coming.first + coming.come;
  const Index before = coming.on_disk ? static_cast<Index>((first - begin) / sizeof(double)) : count;
  std::copy_n(from, before, to);
  if (coming.on_disk) {
    const auto behind = static_cast<Index>((last - begin) / sizeof(double));
    std::copy_n(from + behind, count - behind, to + behind);
  }
  coming.come += count;
}

void DiskPages::arrived(Coming& coming) {
  if (!std::exchange(coming.on_disk, false)) return;
  const Pages pages(coming.first, coming.count);
  const std::uintptr_t end = std::clamp(Pages::address_of(coming.first + coming.come), pages.begin, pages.end);
  const std::size_t written = end - pages.begin;
  std::size_t whole = written / page_size() * page_size();
  if (whole > 0 && ::mmap(at(pages.begin), whole, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_FIXED, descriptor_,
                          static_cast<off_t>(coming.offset)) == MAP_FAILED) {
    whole = 0;
  }
  if (!read_back(at(pages.begin + whole), written - whole, coming.offset + whole)) throw std::bad_alloc();
}

bool DiskPages::read_back(void* to, std::size_t count, std::size_t offset) const {
  for (std::size_t done = 0; done < count;) {
    const ssize_t got =
        ::pread(descriptor_, static_cast<char*>(to) + done, count - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    done += static_cast<std::size_t>(got);
  }
  return true;
}

void DiskPages::take(PreparedTrial& trial) {
  for (const auto signal : kSignals) take((trial.*signal).data(), (trial.*signal).size());
}

}  // namespace mbk::recording
