#pragma once

// Bytes of MCAP files, bags and messages that the tests write themselves.

#include <bzlib.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/files/contents/test_bytes.h"

namespace mbk::recording::test {

inline const std::string kLineOfTypes = "\n" + std::string(80, '=') + "\n";

inline std::string zstd_packed(std::string_view bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1));
  return packed;
}

inline std::string lz4_packed(std::string_view bytes) {
  std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  return packed;
}

inline std::string bz2_packed(std::string_view bytes) {
  std::string packed(bytes.size() + bytes.size() / 50 + 600, '\0'), copy(bytes);
  auto size = static_cast<unsigned>(packed.size());
  BZ2_bzBuffToBuffCompress(packed.data(), &size, copy.data(), static_cast<unsigned>(copy.size()), 9, 0, 0);
  packed.resize(size);
  return packed;
}

/// Fields behind each other, aligned where it is CDR.
class Message {
 public:
  static Message cdr(bool big_endian = false) {
    Message message;
    message.bytes_ = {'\0', static_cast<char>(big_endian ? 0 : 1), '\0', '\0'};
    message.cdr_ = true;
    message.big_endian_ = big_endian;
    return message;
  }
  static Message ros1() { return {}; }

  template <class Number>
  Message& add(Number value) {
    while (cdr_ && bytes_.size() % sizeof value != 4 % sizeof value) bytes_ += '\0';
    bytes_ += raw(value, big_endian_);
    return *this;
  }
  Message& text(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size() + (cdr_ ? 1 : 0)));
    bytes_ += text;
    if (cdr_) bytes_ += '\0';
    return *this;
  }
  /// std_msgs/Header
  Message& header(std::uint32_t seconds, std::uint32_t nanoseconds, std::string_view frame) {
    if (!cdr_) add(std::uint32_t{7});  // seq
    return add(seconds).add(nanoseconds).text(frame);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  bool cdr_ = false, big_endian_ = false;
};

/// Records of an MCAP file.
namespace mcap {

inline std::string counted(std::string_view text) {
  return raw(static_cast<std::uint32_t>(text.size())) + std::string(text);
}
inline std::string record(int kind, std::string_view content) {
  return static_cast<char>(kind) + raw(std::uint64_t{content.size()}) + std::string(content);
}
inline std::string schema(std::uint16_t id, std::string_view name, std::string_view text,
                          std::string_view encoding = "ros2msg") {
  return record(3, raw(id) + counted(name) + counted(encoding) + counted(text));
}
inline std::string channel(std::uint16_t id, std::uint16_t schema, std::string_view topic,
                           std::string_view encoding = "cdr") {
  return record(4, raw(id) + raw(schema) + counted(topic) + counted(encoding) + counted(""));
}
/// @param time  [ns]
inline std::string message(std::uint16_t channel, std::uint64_t time, std::string_view data) {
  return record(5, raw(channel) + raw(std::uint32_t{0}) + raw(time) + raw(time) + std::string(data));
}
inline std::uint32_t crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}
inline std::string chunk(std::string_view records, std::string_view packing, std::uint32_t sum) {
  const std::string packed = packing == "zstd"  ? zstd_packed(records)
                             : packing == "lz4" ? lz4_packed(records)
                                                : std::string(records);
  return record(6, raw(std::uint64_t{0}) + raw(std::uint64_t{0}) + raw(std::uint64_t{records.size()}) + raw(sum) +
                       counted(packing) + raw(std::uint64_t{packed.size()}) + packed);
}
/// @param records  from the header to the last of the data
inline std::string file(std::string_view records) {
  const std::string magic = "\x89MCAP0\r\n";
  return magic + record(1, counted("ros2") + counted("of a test")) + std::string(records) +
         record(15, raw(std::uint32_t{0})) +
         record(2, raw(std::uint64_t{0}) + raw(std::uint64_t{0}) + raw(std::uint32_t{0})) + magic;
}

}  // namespace mcap

/// Records of a bag.
namespace bag {

using Pairs = std::vector<std::pair<std::string, std::string>>;

inline std::string pairs(const Pairs& all) {
  std::string bytes;
  for (const auto& [name, value] : all) bytes += mcap::counted(name + "=" + value);
  return bytes;
}
inline std::string record(int operation, const Pairs& header, std::string_view data) {
  Pairs all = header;
  all.emplace_back("op", std::string(1, static_cast<char>(operation)));
  return mcap::counted(pairs(all)) + mcap::counted(data);
}
inline std::string connection(std::uint32_t id, const std::string& topic, const std::string& type,
                              const std::string& definition) {
  return record(7, {{"conn", raw(id)}, {"topic", topic}},
                pairs({{"topic", topic}, {"type", type}, {"md5sum", "0"}, {"message_definition", definition}}));
}
inline std::string message(std::uint32_t connection, std::uint32_t seconds, std::uint32_t nanoseconds,
                           std::string_view data) {
  return record(2, {{"conn", raw(connection)}, {"time", raw(seconds) + raw(nanoseconds)}}, data);
}
inline std::string chunk(std::string_view records, const std::string& packing) {
  const std::string packed = packing == "bz2"   ? bz2_packed(records)
                             : packing == "lz4" ? lz4_packed(records)
                                                : std::string(records);
  return record(5, {{"compression", packing}, {"size", raw(static_cast<std::uint32_t>(records.size()))}}, packed);
}
inline std::string file(std::string_view records, std::uint64_t index = 4117) {
  const std::string header =
      record(3, {{"index_pos", raw(index)}, {"conn_count", raw(1)}, {"chunk_count", raw(1)}}, "");
  return "#ROSBAG V2.0\n" + header + std::string(records);
}

}  // namespace bag

// Definitions as recorders write them.

inline const std::string kHeader2 = kLineOfTypes +
                                    "MSG: std_msgs/Header\n# when and where\nbuiltin_interfaces/Time stamp\n"
                                    "string frame_id" +
                                    kLineOfTypes + "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
inline const std::string kWrench2 = "# A wrench\nstd_msgs/Header header\nWrench wrench" + kLineOfTypes +
                                    "MSG: geometry_msgs/Wrench\nVector3  force\nVector3  torque" + kLineOfTypes +
                                    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z" + kHeader2;
inline const std::string kPose2 = "std_msgs/Header header\nPose pose" + kLineOfTypes +
                                  "MSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation" + kLineOfTypes +
                                  "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z" + kLineOfTypes +
                                  "MSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1" +
                                  kHeader2;
inline const std::string kJoints2 =
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort" + kHeader2;
inline const std::string kWrench1 = "Header header\nWrench wrench" + kLineOfTypes +
                                    "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n" + kLineOfTypes +
                                    "MSG: geometry_msgs/Wrench\nVector3  force\nVector3  torque\n" + kLineOfTypes +
                                    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

inline Message wrench(Message message, std::uint32_t seconds, std::uint32_t nanoseconds, double x, double y,
                      std::string_view frame = "tool0") {
  message.header(seconds, nanoseconds, frame).add(x).add(y);
  for (int rest = 0; rest < 4; ++rest) message.add(0.25);
  return message;
}

/// /ft at 1 kHz from 1 700 000 000 s on, force_x = k, force_y = −k/2, in chunks that are packed so.
inline std::string wrench_file(std::string_view packing, int count = 20) {
  std::string records = mcap::schema(1, "geometry_msgs/msg/WrenchStamped", kWrench2) + mcap::channel(1, 1, "/ft");
  for (int k = 0; k < count; ++k) {
    const auto nanoseconds = static_cast<std::uint32_t>(k * 1'000'000);
    records += mcap::message(1, 1'700'000'000'000'000'000U + nanoseconds + 5000,
                             wrench(Message::cdr(), 1'700'000'000, nanoseconds, k, -k / 2.0).bytes());
  }
  return mcap::file(mcap::chunk(records, packing, mcap::crc(records)));
}

/// The same, as a bag.
inline std::string wrench_bag(const std::string& packing, int count = 20) {
  const std::string connection = bag::connection(0, "/ft", "geometry_msgs/WrenchStamped", kWrench1);
  std::string records = connection;
  for (int k = 0; k < count; ++k) {
    const auto nanoseconds = static_cast<std::uint32_t>(k * 1'000'000);
    records += bag::message(0, 1'700'000'000, nanoseconds + 5000,
                            wrench(Message::ros1(), 1'700'000'000, nanoseconds, k, -k / 2.0).bytes());
  }
  return bag::file(bag::chunk(records, packing) + bag::record(4, {{"ver", raw(1)}}, "index") + connection +
                   bag::record(6, {{"ver", raw(1)}}, "chunk info"));
}

}  // namespace mbk::recording::test
