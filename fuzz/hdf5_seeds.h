#pragma once

// HDF5 files with features that mbk does not write: tables, arrays in elements, LZF, links to links.

#include <cstdint>
#include <string>
#include <string_view>

namespace mbk::fuzz {

/// A little-endian number with the given number of bytes.
inline std::string field(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i & 0xFFu);
  return text;
}

/// A message of an object header of version 1.
inline std::string message(int type, std::string body) {
  body.resize((body.size() + 7) / 8 * 8);
  return field(static_cast<std::uint64_t>(type), 2) + field(body.size(), 2) + field(0, 4) + body;
}

inline std::string object_header(const std::string& messages, int count) {
  return field(1, 1) + field(0, 1) + field(static_cast<std::uint64_t>(count), 2) + field(1, 4) +
         field(messages.size(), 4) + field(0, 4) + messages;
}

inline std::string link_to(const std::string& name, int kind, const std::string& target) {
  return message(0x06, field(1, 1) + field(8, 1) + field(static_cast<std::uint64_t>(kind), 1) + field(name.size(), 1) +
                           name + target);
}

/// A group with a table of four rows (time, an array of two, a text), an LZF chunk, and links of every kind.
inline std::string hdf5_of_others() {
  using namespace std::string_literals;
  const std::string real =
      "\x11\x20\x3F\0"s + field(8, 4) + field(0, 2) + field(64, 2) + "\x34\x0B\0\x34"s + field(1023, 4);
  const std::string pair = "\x3A\0\0\0"s + field(16, 4) + field(1, 1) + field(2, 4) + real;
  const std::string text = "\x13\0\0\0"s + field(4, 4);
  const std::string row = "\x36\3\0\0"s + field(28, 4) + "time\0\0"s + real + "q\0\x08"s + pair + "mode\0\x18"s + text;
  const auto space = [](std::uint64_t count) { return message(1, "\1\1\0\0\0\0\0\0"s + field(count, 8)); };

  constexpr std::uint64_t kRoot = 96, kRootSize = 16 + 6 * 48, kTable = kRoot + kRootSize, kTableSize = 256;
  constexpr std::uint64_t kPacked = kTable + kTableSize, kPackedSize = 192, kData = kPacked + kPackedSize;
  const auto padded = [](std::string part, std::uint64_t size) {
    part.resize(static_cast<std::size_t>(size));
    return part;
  };
  const std::string links = link_to("log", 0, field(kTable, 8)) + link_to("lzf", 0, field(kPacked, 8)) +
                            link_to("again", 1, field(4, 2) + "/log") + link_to("self", 1, field(5, 2) + "/self") +
                            link_to("far", 64, field(7, 2) + "\0a.h5\0/x\0"s) + link_to("up", 0, field(kRoot, 8));
  const std::string table = space(4) + message(3, row) + message(8, "\3\1"s + field(kData, 8) + field(4 * 28, 8));
  const std::string chunk = "\x07" + field(0x3FF0'0000'0000'0000, 8) + "\xE0\x0F\x07"s;  // 8 bytes, then 22 repeated
  const std::string packed =
      space(4) + message(3, real) + message(11, "\2\1"s + field(32000, 2) + field(0, 2) + field(0, 2) + field(0, 2)) +
      message(8, "\4\2\2\2\1\4\x08\1"s + field(chunk.size(), 8) + field(0, 4) + field(kData + 112, 8));
  std::string data(112, '\1');
  data += padded(chunk, 32);
  const std::string body = padded(object_header(links, 6), kRootSize) + padded(object_header(table, 3), kTableSize) +
                           padded(object_header(packed, 4), kPackedSize) + data;
  return "\x89HDF\r\n\x1A\n\0\0\0\0\0\x08\x08\0\4\0\x10\0"s + field(0, 4) + field(0, 8) + field(~0ull, 8) +
         field(96 + body.size(), 8) + field(~0ull, 8) + field(0, 8) + field(kRoot, 8) + field(0, 24) + body;
}

}  // namespace mbk::fuzz
