#include "mbk/files/hdf5/file.h"

#include <fmt/format.h>

#include "mbk/files/hdf5/checksum.h"

namespace mbk::hdf5 {
namespace {

constexpr std::uint64_t kWorkPerByte = 4;       ///< of the memory that is allowed
constexpr std::uint64_t kStructureWeight = 16;  ///< structures are slower to read than numbers
constexpr std::uint64_t kObjectMemory = 512;    ///< [bytes], of a node of the tree

}  // namespace

tl::unexpected<Error> damaged(std::string what) {
  return bad_data(std::move(what), "the file is damaged or truncated: copy it again from where it was recorded");
}

Budget::Budget(const ReadLimits& limits)
    : limit_(limits.bytes),
      memory_(limits.bytes),
      available_(limits.available),
      work_(limits.bytes > kUndefined / kWorkPerByte ? kUndefined : limits.bytes * kWorkPerByte),
      objects_(limits.objects),
      max_objects_(limits.objects) {}

Result<void> Budget::keep(std::uint64_t count, std::uint64_t each) {
  std::uint64_t bytes = 0;
  if (!multiply(count, each, bytes) || bytes > memory_)
    return damaged("it claims more data than a file of this size can contain");
  if (bytes > available_) {
    spent_ = true;
    const auto gigabytes = [](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(1u << 30u); };
    return bad_data(fmt::format("it needs {:.2f} GiB of memory, but {:.2f} GiB are available", gigabytes(bytes),
                                gigabytes(available_)),
                    "close other programs, or split the recording into numbered parts");
  }
  memory_ -= bytes;
  available_ -= bytes;
  return {};
}

Result<void> Budget::borrow(std::uint64_t bytes) const {
  if (bytes > limit_) return damaged("it claims more data than a file of this size can contain");
  return {};
}

Result<void> Budget::work(std::uint64_t bytes) {
  spent_ = spent_ || bytes > work_;
  if (spent_) return damaged("its structures contain a reference loop");
  work_ -= bytes;
  return {};
}

Result<void> Budget::object(std::uint64_t path_size) {
  if (objects_-- <= 0) {
    spent_ = true;
    return bad_data(fmt::format("it contains more than {} objects", max_objects_), "split the file");
  }
  return keep(1, kObjectMemory + 2 * path_size);
}

Result<Bytes> File::from(std::uint64_t address, std::uint64_t least, std::string_view what) {
  if (address > bytes.size() || least > bytes.size() - address) {
    return damaged(address == kUndefined ? fmt::format("{} is missing", what)
                                         : fmt::format("{} at byte {} lies beyond the end", what, address));
  }
  MBK_TRY(budget.work(least > kUndefined / kStructureWeight ? kUndefined : least * kStructureWeight));
  return bytes.subspan(static_cast<std::size_t>(address));
}

Result<Bytes> File::block(std::uint64_t address, std::uint64_t size, std::string_view what) {
  const auto rest = MBK_TRY(from(address, size, what));
  return rest.first(static_cast<std::size_t>(size));
}

Result<Bytes> File::checked_block(std::uint64_t address, std::uint64_t size, std::string_view what) {
  const auto whole = MBK_TRY(block(address, size, what));
  if (!checksum_is_right(whole)) return damaged(fmt::format("{} at byte {} has a wrong checksum", what, address));
  return whole.first(whole.size() - kChecksumSize);
}

}  // namespace mbk::hdf5
