#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>

#include "mbk/base/core/printable.h"

namespace mbk::recording {

/// Bytes of a file with their byte order. The caller checks offsets with `holds`.
struct ByteView {
  std::span<const std::byte> bytes;
  bool swapped = false;  ///< the file's byte order is not this processor's

  [[nodiscard]] std::size_t size() const { return bytes.size(); }
  [[nodiscard]] bool holds(std::uint64_t offset, std::uint64_t count) const {
    return offset <= bytes.size() && count <= bytes.size() - offset;
  }
  [[nodiscard]] ByteView part(std::size_t offset, std::size_t count) const {
    return {bytes.subspan(offset, count), swapped};
  }
  [[nodiscard]] std::string text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

  /// The text of a fixed-width field up to the first NUL.
  [[nodiscard]] std::string padded_text() const { return text().c_str(); }

  template <class Value>
  [[nodiscard]] Value at(std::size_t offset) const {
    std::byte raw[sizeof(Value)];
    std::memcpy(raw, bytes.data() + offset, sizeof raw);
    if (swapped) std::reverse(raw, raw + sizeof raw);
    Value value;
    std::memcpy(&value, raw, sizeof value);
    return value;
  }

  /// `count` numbers stored as Stored, as doubles.
  template <class Stored>
  void copy_doubles(std::size_t count, double* out) const {
    if constexpr (std::is_same_v<Stored, double>) {
      if (!swapped) {
        if (count > 0) std::memcpy(out, bytes.data(), count * sizeof(double));
        return;
      }
    }
    for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<double>(at<Stored>(i * sizeof(Stored)));
  }
};

}  // namespace mbk::recording
