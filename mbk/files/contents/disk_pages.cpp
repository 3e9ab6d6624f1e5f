#include "mbk/files/contents/disk_pages.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <span>
#include <utility>

#include "mbk/base/system/mapping.h"

namespace mbk::recording {
namespace {

constexpr std::array kSignals = {&PreparedTrial::position,          &PreparedTrial::velocity,
                                 &PreparedTrial::acceleration,      &PreparedTrial::force_hand_on_robot,
                                 &PreparedTrial::force_sensitivity, &PreparedTrial::reference,
                                 &PreparedTrial::reference_motion};

/// The whole pages among numbers.
struct Pages {
  std::uintptr_t begin, end;

  Pages(const double* first, Index count)
      : begin((address_of(first) + system::page_size() - 1) / system::page_size() * system::page_size()),
        end(address_of(first + count) / system::page_size() * system::page_size()) {}
  [[nodiscard]] bool empty() const { return begin >= end; }
  [[nodiscard]] std::size_t size() const { return end - begin; }

  static std::uintptr_t address_of(const double* number) { return reinterpret_cast<std::uintptr_t>(number); }
};

void* at(std::uintptr_t address) {
  return reinterpret_cast<void*>(address);  // NOLINT(performance-no-int-to-ptr): pages are counted in numbers
}

bool write_all(const system::OpenFile& file, const char* from, std::size_t count, std::size_t offset) {
  return system::write_all_at(file.number(), std::as_bytes(std::span(from, count)), offset) == 0;
}

}  // namespace

bool DiskPages::open() {
  if (file_ || failed_) return !failed_;
  const char* const chosen = std::getenv("TMPDIR");
  file_ = system::open_unnamed(chosen != nullptr && *chosen != '\0' ? chosen : "/var/tmp");
  failed_ = !file_;
  return !failed_;
}

Index DiskPages::take(double* first, Index count) {
  const Pages pages(first, count);
  if (pages.empty() || !open()) return 0;
  failed_ = !write_all(file_, static_cast<const char*>(at(pages.begin)), pages.size(), size_) ||
            !system::map_file_over(at(pages.begin), pages.size(), file_, size_);
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
      !write_all(file_, reinterpret_cast<const char*>(from) + (first - begin), last - first,
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
  std::size_t whole = written / system::page_size() * system::page_size();
  if (whole > 0 && !system::map_file_over(at(pages.begin), whole, file_, coming.offset)) whole = 0;
  if (!read_back(at(pages.begin + whole), written - whole, coming.offset + whole)) throw std::bad_alloc();
}

bool DiskPages::read_back(void* to, std::size_t count, std::size_t offset) const {
  for (std::size_t done = 0; done < count;) {
    const auto got = system::read_some_at(file_.number(), static_cast<char*>(to) + done, count - done, offset + done);
    if (got <= 0) return false;
    done += static_cast<std::size_t>(got);
  }
  return true;
}

void DiskPages::take(PreparedTrial& trial) {
  for (const auto signal : kSignals) take((trial.*signal).data(), (trial.*signal).size());
}

}  // namespace mbk::recording
