#include "fuzz/fuzz.h"
#include "mbk/files/xdf/test_xdf.h"
#include "mbk/files/xdf/xdf.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  using recording::test::raw, recording::test::Xdf;
  std::vector<std::string> files;
  for (const char* format : {"int8", "int16", "int32", "int64", "float32", "double64"}) {
    files.push_back(recording::test::small_xdf(format).bytes());
  }
  Xdf reset;
  reset.header("<version>1.0</version><datetime>2024-05-14T10:00:00+0200</datetime>");
  reset.stream(1, "S", "int8", 1, 10, "<synchronization><can_drop_samples>true</can_drop_samples></synchronization>");
  reset.stream(2, "T", "int8", 1, 10).stream(3, "M", "string", 2, 0, Xdf::labels({{"a", ""}, {"b", "V"}}));
  for (const double begin : {900.0, 3.0}) {
    for (int k = 0; k < 4; ++k) {
      for (const std::uint32_t id : {1u, 2u}) {
        reset.samples(id, {Xdf::stamped(begin + k) + "a", Xdf::unstamped() + "b"}).offset(id, begin + k, 50.0 - begin);
      }
    }
  }
  reset.samples(3, {Xdf::stamped(4) + Xdf::text("go") + Xdf::text("")}).boundary();
  reset.offset(2, 99.0, 7.0).append("\x07 damage").boundary().chunk(9, "new").footer(1, 16).footer(2, 12).footer(3, 1);
  files.push_back(reset.bytes());
  // A clock that is set twice, drifts unevenly and whose samples are out of order.
  Xdf set;
  set.header().stream(1, "S", "int64", 1, 10);
  for (const int second : {0, 1, 3, 2, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23}) {
    const double ahead = 1e-4 * second * second + (second > 7 ? 0.5 : 0.0) - (second > 15 ? 0.3 : 0.0);
    std::vector<std::string> samples;
    for (int k = 0; k < 10; ++k)
      samples.push_back(Xdf::stamped(second + k / 10.0 + ahead) + raw(std::int64_t{1} << 60));
    set.samples(1, samples).offset(1, second + ahead, -ahead);
  }
  files.push_back(set.bytes());
  return files;
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = mbk::fuzz::bytes_of(data, size);
  if (mbk::recording::looks_like_xdf(bytes)) mbk::fuzz::check_decoded(mbk::recording::decode_xdf(bytes), size);
  return 0;
}
