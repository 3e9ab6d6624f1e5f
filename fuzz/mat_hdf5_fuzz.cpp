// Any HDF5 file, of MATLAB or not, becomes a recording or is refused in one line.

#include "fuzz/fuzz.h"
#include "fuzz/hdf5_seeds.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/hdf5_recording.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  return {recording::encode_hdf5(small_recording()).value(), recording::encode_mat_hdf5(small_recording()).value(),
          hdf5_of_others()};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mbk::fuzz::check_decoded(mbk::recording::decode_hdf5(mbk::fuzz::bytes_of(data, size)), size);
  return 0;
}
