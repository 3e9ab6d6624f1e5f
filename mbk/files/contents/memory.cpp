#include "mbk/files/contents/memory.h"

#include <fmt/format.h>

#include "mbk/base/system/mapping.h"

namespace mbk::recording {
namespace {

constexpr std::uint64_t kSmall = std::uint64_t{64} << 20;  ///< not worth asking for

}  // namespace

Result<void> check_memory(std::uint64_t bytes) {
  if (bytes <= kSmall) return {};
  const std::uint64_t available = system::available_memory();
  if (bytes <= available) return {};
  const auto gigabytes = [](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(1u << 30u); };
  return bad_data(fmt::format("it needs {:.2f} GiB of memory, but {:.2f} GiB are available", gigabytes(bytes),
                              gigabytes(available)),
                  "close other programs, or split the recording into numbered parts");
}

}  // namespace mbk::recording
