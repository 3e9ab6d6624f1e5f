#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace mbk::hdf5 {

/// No object: every bit set.
inline constexpr std::uint64_t kNoAddress = ~std::uint64_t{0};

/// Bytes that grow, least significant byte first, as HDF5 wants them; and the places in them where the address of an
/// object still has to go.
class Output {
 public:
  std::string bytes;
  std::vector<std::pair<std::size_t, std::string>> references;  ///< place of 8 bytes, path of the object

  template <class Number>
  void put(Number number) {
    auto value = static_cast<std::make_unsigned_t<Number>>(number);
    for (std::size_t i = 0; i < sizeof value; ++i) {
      bytes += static_cast<char>(value & 0xFFu);
      if constexpr (sizeof value > 1) value = static_cast<decltype(value)>(value >> 8u);
    }
  }
  void put_u8(unsigned value) { put(static_cast<std::uint8_t>(value)); }
  void put_u16(std::size_t value) { put(static_cast<std::uint16_t>(value)); }
  void put_u32(std::size_t value) { put(static_cast<std::uint32_t>(value)); }
  void put_u64(std::uint64_t value) { put(value); }
  void put_text(std::string_view text) { bytes += text; }
  void put_zeros(std::size_t count) { bytes.append(count, '\0'); }

  void put_reference(std::string path) {
    references.emplace_back(bytes.size(), std::move(path));
    put_u64(0);
  }

  /// Zeros up to a multiple of 8, where most things of HDF5 have to begin.
  void align() { put_zeros((8 - bytes.size() % 8) % 8); }

  void append(Output more) {
    for (auto& [place, path] : more.references) references.emplace_back(bytes.size() + place, std::move(path));
    bytes += more.bytes;
  }

  /// Appends something where it may begin; its address.
  std::uint64_t place(Output content) {
    align();
    const std::uint64_t address = bytes.size();
    append(std::move(content));
    return address;
  }

  void overwrite_u64(std::size_t place, std::uint64_t value) {
    Output eight;
    eight.put_u64(value);
    bytes.replace(place, 8, eight.bytes);
  }
};

}  // namespace mbk::hdf5
