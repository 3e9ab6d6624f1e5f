#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace mbk::journal {

static_assert(std::endian::native == std::endian::little);

inline constexpr std::string_view kMagic = "MBKJRNL2", kMagic1 = "MBKJRNL1";

inline constexpr std::uint32_t kHeader = 1, kTicks = 2, kEnding = 3;  // kinds of blocks
inline constexpr std::uint32_t kLargestBlock = 1U << 24U;             // bytes of a payload

/// What every block begins with.
struct BlockHead {
  std::array<char, 8> mark = kMark;  ///< where a block may begin
  std::uint64_t trial = 0;           ///< drawn by lot: a block of another journal has another
  std::uint64_t next_tick = 0;       ///< number of its first tick, or of the next one to come
  std::uint32_t kind = 0;
  std::uint32_t bytes = 0;     ///< of the payload
  std::uint32_t number = 0;    ///< of the block, from 0
  std::uint32_t checksum = 0;  ///< CRC-32 of what stands before it, and of the payload

  static constexpr std::array<char, 8> kMark = {'\x9E', 'M', 'b', 'k', 'B', 'l', 'k', '\x02'};
};
static_assert(sizeof(BlockHead) == 40 && offsetof(BlockHead, checksum) == 36);

/// The same of format 1.
struct BlockHead1 {
  std::uint32_t kind = 0, bytes = 0;
  std::uint32_t checksum = 0;  ///< CRC-32 of the two before it, and of the payload
  std::uint32_t zero = 0;
};
static_assert(sizeof(BlockHead1) == 16 && offsetof(BlockHead1, checksum) == 8);

}  // namespace mbk::journal
