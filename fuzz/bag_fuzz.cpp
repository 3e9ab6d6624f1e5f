#include "fuzz/fuzz.h"
#include "mbk/files/ros/bag.h"
#include "mbk/files/ros/test_ros.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  std::vector<std::string> files;
  for (const char* packing : {"none", "bz2", "lz4"}) files.push_back(recording::test::wrench_bag(packing, 3));
  namespace bag = recording::test::bag;
  using recording::test::Message;
  files.push_back(bag::file(
      bag::connection(0, "/v", "lab/V", "time at\nuint8[] data\nstring[2] words\nfloat32[3] a") +
      bag::message(
          0, 1, 0,
          Message::ros1().add(1U).add(2U).text("ab").text("c").text("d").add(1.0F).add(2.0F).add(3.0F).bytes())));
  return files;
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = mbk::fuzz::bytes_of(data, size);
  if (mbk::recording::looks_like_bag(bytes)) mbk::fuzz::check_decoded(mbk::recording::decode_bag(bytes), size);
  return 0;
}
