#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "mbk/base/core/result.h"

namespace mbk::hdf5 {

using Bytes = std::span<const std::byte>;

/// Marks a sentence about a file as one that its bytes contradict.
[[nodiscard]] tl::unexpected<Error> damaged(std::string what);

/// The address of something that is not there, whatever the size of addresses.
inline constexpr std::uint64_t kUndefined = ~std::uint64_t{0};

/// How many bytes addresses and lengths take, as the superblock says.
struct Sizes {
  std::size_t address = 8;
  std::size_t length = 8;
};

/// The least number of bytes that holds numbers up to `largest`.
[[nodiscard]] constexpr std::size_t bytes_for(std::uint64_t largest) {
  return largest == 0 ? 1 : (static_cast<std::size_t>(std::bit_width(largest)) - 1) / 8 + 1;
}

[[nodiscard]] constexpr bool multiply(std::uint64_t a, std::uint64_t b, std::uint64_t& product) {
  return !__builtin_mul_overflow(a, b, &product);
}

/// Reads on and on in a block of little-endian fields. Beyond the end every field is 0 and `ok` turns false, so that
/// one question after a structure answers for all of its fields.
class Cursor {
 public:
  explicit Cursor(Bytes bytes, Sizes sizes = {}) : bytes_(bytes), sizes_(sizes) {}

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] Sizes sizes() const { return sizes_; }

  /// The next `count` bytes; none where fewer are left.
  Bytes take(std::uint64_t count) {
    if (count > left()) {
      ok_ = false;
      at_ = bytes_.size();
      return {};
    }
    const Bytes taken = bytes_.subspan(at_, static_cast<std::size_t>(count));
    at_ += taken.size();
    return taken;
  }
  void skip(std::uint64_t count) { take(count); }

  /// An unsigned number of 0 to 8 bytes.
  std::uint64_t number(std::size_t bytes) {
    std::uint64_t value = 0;
    const Bytes taken = take(bytes);
    for (std::size_t i = taken.size(); i-- > 0;) value = value << 8u | std::to_integer<std::uint64_t>(taken[i]);
    return value;
  }
  std::uint8_t byte() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t word() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t dword() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t length() { return number(sizes_.length); }
  std::uint64_t address() {
    const std::uint64_t value = number(sizes_.address);
    const std::uint64_t all_ones = sizes_.address >= 8 ? kUndefined : (std::uint64_t{1} << 8 * sizes_.address) - 1;
    return value == all_ones ? kUndefined : value;
  }
  /// Whether the next bytes are these.
  bool is(std::string_view signature) {
    const Bytes taken = take(signature.size());
    return taken.size() == signature.size() && std::memcmp(taken.data(), signature.data(), taken.size()) == 0;
  }
  /// Text up to the NUL that ends it, which must be there.
  std::string text() {
    const Bytes rest = bytes_.subspan(at_);
    const void* const nul = rest.empty() ? nullptr : std::memchr(rest.data(), 0, rest.size());
    if (nul == nullptr) {
      ok_ = false;
      return {};
    }
    const auto size = static_cast<std::size_t>(static_cast<const std::byte*>(nul) - rest.data());
    std::string found(reinterpret_cast<const char*>(rest.data()), size);
    at_ += size + 1;
    return found;
  }

 private:
  Bytes bytes_;
  Sizes sizes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

inline std::string text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace mbk::hdf5
