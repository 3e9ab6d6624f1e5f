// Any bytes are read as HDF5 or rejected with a one-line error, within the permitted memory.

#include "fuzz/fuzz.h"
#include "fuzz/hdf5_seeds.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/hdf5/read_hdf5.h"
#include "mbk/files/recording/encode.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  return {recording::encode_hdf5(small_recording()).value(), recording::encode_mat_hdf5(small_recording()).value(),
          hdf5_of_others()};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto root = mbk::hdf5::read(mbk::fuzz::bytes_of(data, size), {.bytes = mbk::recording::largest_claim(size)});
  if (!root) {
    mbk::fuzz::require_error(root.error());
    mbk::fuzz::require(root.error().kind == mbk::ErrorKind::data, "the error names the file");
  }
  return 0;
}
