#include "fuzz/fuzz.h"
#include "mbk/files/ros/mcap.h"
#include "mbk/files/ros/test_ros.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  namespace mcap = recording::test::mcap;
  std::vector<std::string> files;
  for (const char* packing : {"", "zstd", "lz4"}) files.push_back(recording::test::wrench_file(packing, 3));
  files.push_back(mcap::file(mcap::channel(1, 0, "/js", "json") +
                             mcap::message(1, 5, R"({"force_x": 1.5, "deep": {"list": [1, 2]}})") +
                             mcap::message(1, 9, R"({"force_x": null, "deep": {"list": [1, 2]}})")));
  files.push_back(mcap::file(
      mcap::schema(1, "sensor_msgs/msg/JointState", "{}", "jsonschema") + mcap::channel(1, 1, "/js", "json") +
      mcap::message(1, 5, R"({"header": {"stamp": {"sec": "1"}}, "name": ["a", "b"], "position": ["1.5", 2]})") +
      mcap::message(1, 9, R"({"name": ["b", "a"], "position": [2, 1e9]})")));
  using recording::test::Message;
  const std::string joints =
      Message::cdr().header(9, 0, "a").add(1U).text("j").add(1U).add(2.0).add(0U).add(0U).bytes();
  files.push_back(mcap::file(mcap::schema(1, "sensor_msgs/msg/JointState", recording::test::kJoints2) +
                             mcap::channel(1, 1, "/js") + mcap::message(1, 5, joints) + mcap::message(1, 6, joints)));
  return files;
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = mbk::fuzz::bytes_of(data, size);
  if (mbk::recording::looks_like_mcap(bytes)) mbk::fuzz::check_decoded(mbk::recording::decode_mcap(bytes), size);
  return 0;
}
