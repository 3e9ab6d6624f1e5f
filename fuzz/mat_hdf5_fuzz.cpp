// Any HDF5 file, of MATLAB or not, becomes a recording or is refused in one line.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "mbk/recording/annotations.h"
#include "mbk/recording/assemble.h"
#include "mbk/recording/hdf5_recording.h"
#include "mbk/recording/read.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto contents = mbk::recording::decode_hdf5(std::as_bytes(std::span(data, size)));
  if (contents) {
    mbk::recording::take_annotations(*contents);
    const auto recording = mbk::recording::assemble(*contents, {});
    if (!recording && recording.error().line().find('\n') != std::string::npos) std::abort();
  } else if (contents.error().line().find('\n') != std::string::npos) {
    std::abort();
  }
  return 0;
}
