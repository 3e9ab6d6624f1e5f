#include "fuzz/fuzz.h"
#include "mbk/files/contents/test_bytes.h"
#include "mbk/files/recording/mat_level4.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  using namespace recording::test;
  const Matrix column = Vector::LinSpaced(8, 0.0, 0.007);
  return {mat4("logs", logs(4)), mat4("logs", logs(4), true),
          mat4("t", column) + mat4("x", column) + mat4("Fx", column),
          mat4("time", column, true) + mat4("hand_x_mm", column, true)};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mbk::fuzz::check_decoded(mbk::recording::decode_mat_level4(mbk::fuzz::bytes_of(data, size)), size);
  return 0;
}
