#include "mbk/files/ros/bag.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/ros/forward_bytes.h"
#include "mbk/files/ros/topics.h"

namespace mbk::recording {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers of bags are little-endian");

constexpr std::string_view kAnyMagic = "#ROSBAG V";
constexpr std::uint64_t kLargestHeader = std::uint64_t{4} << 20;
constexpr std::uint64_t kNanoseconds = 1'000'000'000;

/// The kinds of records.
enum class Operation : std::uint8_t { message = 2, bag = 3, index = 4, chunk = 5, chunk_info = 6, connection = 7 };

/// "name=value" pairs, each behind its length.
class Pairs {
 public:
  static std::optional<Pairs> of(std::span<const std::byte> bytes) {
    Pairs pairs;
    while (!bytes.empty()) {
      std::uint32_t size = 0;
      if (bytes.size() < sizeof size) return std::nullopt;
      std::memcpy(&size, bytes.data(), sizeof size);
      bytes = bytes.subspan(sizeof size);
      if (size > bytes.size()) return std::nullopt;
      const std::string_view pair(reinterpret_cast<const char*>(bytes.data()), size);
      const std::size_t middle = pair.find('=');
      if (middle == pair.npos) return std::nullopt;
      pairs.values_.insert_or_assign(std::string(pair.substr(0, middle)), std::string(pair.substr(middle + 1)));
      bytes = bytes.subspan(size);
    }
    return pairs;
  }
  [[nodiscard]] std::string text(std::string_view name) const {
    const auto found = values_.find(name);
    return found == values_.end() ? std::string() : found->second;
  }
  template <class Number>
  [[nodiscard]] std::optional<Number> number(std::string_view name) const {
    const auto found = values_.find(name);
    if (found == values_.end() || found->second.size() != sizeof(Number)) return std::nullopt;
    Number value{};
    std::memcpy(&value, found->second.data(), sizeof value);
    return value;
  }

 private:
  std::map<std::string, std::string, std::less<>> values_;
};

class BagDecoder {
 public:
  /// @param size  of all bytes
  BagDecoder(ForwardBytes& bytes, std::uint64_t size) : bytes_(bytes), size_(size), topics_(size) {}

  Result<Contents> run() {
    const auto magic = MBK_TRY(bytes_.take(kBagMagic.size()));
    const std::string begin(reinterpret_cast<const char*>(magic.data()), magic.size());
    if (begin != kBagMagic) {
      return bad_data(fmt::format("bag version '{}' is not supported", begin.substr(kAnyMagic.size())),
                      "convert it to version 2.0 with 'rosbag fix'");
    }
    while (!cut_ && bytes_.position() < size_) {
      MBK_TRY(take_record(bytes_, size_ - bytes_.position(), false));
    }
    MBK_TRY(bytes_.skip(size_ - bytes_.position()));
    Contents contents = topics_.contents("ROS 1 bag", false);
    for (std::string& note : notes_) contents.notes.push_back(std::move(note));
    return contents;
  }

 private:
  [[nodiscard]] std::string place() const { return fmt::format("byte {}", bytes_.position()); }

  [[nodiscard]] tl::unexpected<Error> odd(std::string_view record) const {
    return bad_data(fmt::format("a {} record is malformed", record), std::string(kCopyAgain), place());
  }

  Result<void> ends_within(std::uint64_t at, bool in_chunk) {
    if (in_chunk) return odd("chunk");
    cut_ = true;
    notes_.push_back(fmt::format("the file is truncated: it ends within a record; it was read up to byte {}", at));
    return {};
  }

  /// A length; nothing where the bytes end before it.
  static Result<std::optional<std::uint32_t>> take_length(ForwardBytes& from) {
    const auto bytes = MBK_TRY(from.take(sizeof(std::uint32_t)));
    if (bytes.size() < sizeof(std::uint32_t)) return std::nullopt;
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data(), sizeof length);
    return length;
  }

  /// One record, of the file or of a chunk.
  /// @param left  bytes there
  Result<void> take_record(ForwardBytes& from, std::uint64_t left, bool in_chunk) {
    constexpr std::uint64_t kLengths = 2 * sizeof(std::uint32_t);
    const std::uint64_t at = bytes_.position();
    const auto header_size = MBK_TRY(take_length(from));
    if (!header_size || left < kLengths || *header_size > left - kLengths) return ends_within(at, in_chunk);
    if (*header_size > kLargestHeader) return odd("bag");
    const auto header = MBK_TRY(from.take(*header_size));
    if (header.size() < *header_size) return odd("chunk");
    const auto pairs = Pairs::of(header);
    if (!pairs) return odd("bag");
    const auto size = MBK_TRY(take_length(from));
    if (!size || *size > left - kLengths - *header_size) return ends_within(at, in_chunk);
    switch (static_cast<Operation>(pairs->number<std::uint8_t>("op").value_or(0))) {
      case Operation::message:
        return take_message(from, *pairs, *size);
      case Operation::connection:
        return take_connection(from, *pairs, *size);
      case Operation::chunk:
        if (in_chunk) break;
        return take_chunk(*pairs, *size);
      case Operation::bag:
        MBK_TRY(take_bag_header(*pairs));
        break;
      case Operation::index:
      case Operation::chunk_info:
        break;
    }
    return leave_out(from, *size);
  }

  Result<void> leave_out(ForwardBytes& from, std::uint64_t length) const {
    const auto all = MBK_TRY(from.skip(length));
    if (!all) return odd("chunk");
    return {};
  }

  Result<void> take_bag_header(const Pairs& pairs) {
    if (!pairs.text("encryptor").empty()) {
      return bad_data(fmt::format("the bag is encrypted with '{}'", pairs.text("encryptor")),
                      "decrypt it with 'rosbag decrypt'");
    }
    if (pairs.number<std::uint64_t>("index_pos").value_or(0) == 0) {
      notes_.emplace_back("the bag was not closed and has no index; all of its contents were read");
    }
    return {};
  }

  Result<void> take_connection(ForwardBytes& from, const Pairs& pairs, std::uint32_t size) {
    const auto id = pairs.number<std::uint32_t>("conn");
    if (!id || size > kLargestHeader) return odd("connection");
    const auto data = MBK_TRY(from.take(size));
    const auto said = data.size() == size ? Pairs::of(data) : std::nullopt;
    if (!said) return odd("connection");
    topics_.add(*id, {pairs.text("topic"), said->text("type"), "ros1", "ros1msg", said->text("message_definition")});
    return {};
  }

  Result<void> take_message(ForwardBytes& from, const Pairs& pairs, std::uint32_t size) {
    const auto connection = pairs.number<std::uint32_t>("conn");
    const auto time = pairs.number<std::uint64_t>("time");
    if (!connection || !time) return odd("message");
    if (!topics_.wants(*connection) || size > kLargestMessage) {
      topics_.leave_out(*connection);
      return leave_out(from, size);
    }
    const auto message = MBK_TRY(from.take(size));
    if (message.size() < size) return odd("message");
    const std::uint64_t seconds = *time & 0xFFFFFFFFU, nanoseconds = *time >> 32;
    return topics_.message(*connection, seconds * kNanoseconds + nanoseconds, message);
  }

  Result<void> take_chunk(const Pairs& pairs, std::uint32_t packed_size) {
    const std::string where = place();
    const std::string called = pairs.text("compression");
    const auto size = pairs.number<std::uint32_t>("size");
    if (!size) return odd("chunk");
    if (called != "none" && called != "lz4" && called != "bz2") {
      return bad_data(fmt::format("a chunk is compressed with '{}', which is not supported", called),
                      "compress it with bz2 or lz4, or not at all ('rosbag compress')", where);
    }
    PartOfBytes chunk(bytes_, packed_size);
    const auto records = unpacked(called == "lz4"   ? Packing::lz4
                                  : called == "bz2" ? Packing::bz2
                                                    : Packing::none,
                                  chunk);
    while (records->position() < *size) {
      if (auto ok = take_record(*records, *size - records->position(), true); !ok) {
        return tl::unexpected(ok.error().where.empty() ? ok.error().in(where) : ok.error());
      }
    }
    const auto more = records->take(1);
    if (!more) return tl::unexpected(more.error().in(where));
    if (!more->empty()) return bad_data("a chunk is longer than its stated size", std::string(kCopyAgain), where);
    return leave_out(chunk, chunk.left());
  }

  ForwardBytes& bytes_;
  std::uint64_t size_;
  bool cut_ = false;
  Topics topics_;
  std::vector<std::string> notes_;
};

}  // namespace

bool looks_like_bag(std::span<const std::byte> begin) {
  return begin.size() >= kBagMagic.size() && std::memcmp(begin.data(), kAnyMagic.data(), kAnyMagic.size()) == 0;
}

Result<Contents> decode_bag(std::span<const std::byte> file) {
  GivenBytes bytes(file);
  return BagDecoder(bytes, file.size()).run();
}

Result<Contents> decode_bag(FileInPassing& file) {
  PassingBytes bytes(file);
  return BagDecoder(bytes, file.size()).run();
}

}  // namespace mbk::recording
