#include "mbk/files/hdf5/object_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <set>

#include "mbk/files/hdf5/checksum.h"

namespace mbk::hdf5 {
namespace {

constexpr unsigned kSharedFlag = 0x02;

/// A segment of messages that is still to be read.
struct Segment {
  std::uint64_t address;
  std::uint64_t size;
};

class HeaderReader {
 public:
  explicit HeaderReader(File& file) : file_(file) {}
  ObjectHeader header;

  Result<void> read(std::uint64_t address) {
    const auto start = MBK_TRY(file_.from(address, 16, "an object header"));
    Cursor in = file_.cursor(start);
    const bool is_new = Cursor(start).is("OHDR");
    MBK_TRY(is_new ? read_new(in, address) : read_old(in, address));
    while (!segments_.empty()) {
      const Segment next = segments_.front();
      segments_.pop_front();
      if (!seen_.insert(next.address).second) return damaged("an object header refers to itself as its continuation");
      const auto block =
          MBK_TRY(is_new ? file_.checked_block(next.address, next.size, "an object header's continuation")
                         : file_.block(next.address, next.size, "an object header's continuation"));
      Cursor messages = file_.cursor(block);
      if (is_new && !messages.is("OCHK")) return damaged("an object header's continuation is broken");
      MBK_TRY(is_new ? new_messages(messages) : old_messages(messages));
    }
    return {};
  }

 private:
  Result<void> read_old(Cursor& in, std::uint64_t address) {
    const int version = in.byte();
    in.skip(1);
    messages_left_ = in.word();
    in.skip(4);  // references to the object
    const std::uint64_t size = in.dword();
    if (version != 1) return damaged(fmt::format("there is no object header at byte {}", address));
    segments_.push_back({address + 16, size});
    return {};
  }

  Result<void> read_new(Cursor& in, std::uint64_t address) {
    in.skip(4);
    const int version = in.byte();
    const unsigned flags = in.byte();
    if (version != 2) return damaged(fmt::format("object header version {} is unknown", version));
    if ((flags & 0x20u) != 0) in.skip(16);  // times
    if ((flags & 0x10u) != 0) in.skip(4);   // limits of compact attributes
    ordered_ = (flags & 0x04u) != 0;
    const std::uint64_t size = in.number(std::size_t{1} << (flags & 3u));
    if (!in.ok() || size > in.left()) return damaged("an object header extends beyond the end of the file");
    const std::size_t prefix = in.at();
    const auto block = MBK_TRY(file_.checked_block(address, prefix + size + kChecksumSize, "an object header"));
    Cursor messages = file_.cursor(block.subspan(prefix));
    return new_messages(messages);
  }

  Result<void> old_messages(Cursor& in) {
    while (in.left() >= 8 && messages_left_ > 0) {
      --messages_left_;
      const auto type = static_cast<MessageType>(in.word());
      const std::uint64_t size = in.word();
      const unsigned flags = in.byte();
      in.skip(3);
      MBK_TRY(add({type, (flags & kSharedFlag) != 0, in.take(size)}, in.ok()));
    }
    return {};
  }

  Result<void> new_messages(Cursor& in) {
    const std::size_t prefix = ordered_ ? 6 : 4;
    while (in.left() >= prefix) {
      const auto type = static_cast<MessageType>(in.byte());
      const std::uint64_t size = in.word();
      const unsigned flags = in.byte();
      if (ordered_) in.skip(2);
      MBK_TRY(add({type, (flags & kSharedFlag) != 0, in.take(size)}, in.ok()));
    }
    return {};
  }

  Result<void> add(const Message& message, bool whole) {
    if (!whole) return damaged("a message of an object header is longer than the header");
    if (message.type != MessageType::continuation) {
      header.messages.push_back(message);
      return {};
    }
    Cursor in = file_.cursor(message.body);
    const std::uint64_t address = in.address();
    const std::uint64_t size = in.length();
    if (!in.ok()) return damaged("an object header's continuation is broken");
    segments_.push_back({address, size});
    return {};
  }

  File& file_;
  std::deque<Segment> segments_;
  std::set<std::uint64_t> seen_;
  int messages_left_ = 0;  ///< version 1
  bool ordered_ = false;   ///< version 2: every message says when it was made
};

}  // namespace

const Message* ObjectHeader::find(MessageType type) const {
  const auto found = std::ranges::find(messages, type, &Message::type);
  return found == messages.end() ? nullptr : &*found;
}

Result<ObjectHeader> read_object_header(File& file, std::uint64_t address) {
  HeaderReader reader(file);
  MBK_TRY(reader.read(address));
  return std::move(reader.header);
}

Result<Bytes> shared_body(File& file, MessageType type, Bytes body) {
  Cursor in = file.cursor(body);
  const int version = in.byte();
  const int how = in.byte();
  if (version == 1) in.skip(6);
  const bool in_heap = version == 3 && how == 1;
  if (version < 1 || version > 3 || in_heap) {
    return bad_data("a message is shared in an unsupported way", "write the file without shared messages");
  }
  const std::uint64_t address = in.address();
  if (!in.ok()) return damaged("a shared message is broken");
  const auto header = MBK_TRY(read_object_header(file, address));
  const Message* const found = header.find(type);
  if (found == nullptr || found->shared) return damaged("a shared message is missing from its place");
  return found->body;
}

}  // namespace mbk::hdf5
