// Any bytes whatever are read as HDF5 or refused: within the memory that was allowed, and in one line.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "mbk/hdf5/read.h"
#include "mbk/recording/file_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = std::as_bytes(std::span(data, size));
  const auto root = mbk::hdf5::read(file, {.bytes = mbk::recording::largest_claim(size)});
  if (!root && (root.error().message.empty() || root.error().kind != mbk::ErrorKind::data)) std::abort();
  return 0;
}
