#include "mbk/files/hdf5/checksum.h"

#include <algorithm>
#include <bit>

namespace mbk::hdf5 {
namespace {

std::uint32_t word_at(Bytes bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = std::min(bytes.size(), at + 4); i-- > at;) {
    word = word << 8u | std::to_integer<std::uint32_t>(bytes[i]);
  }
  return word;
}

}  // namespace

std::uint32_t lookup3(Bytes bytes) {
  using std::rotl;
  std::uint32_t a = 0xdeadbeefU + static_cast<std::uint32_t>(bytes.size());
  std::uint32_t b = a;
  std::uint32_t c = a;
  if (bytes.empty()) return c;
  while (bytes.size() > 12) {
    a += word_at(bytes, 0);
    b += word_at(bytes, 4);
    c += word_at(bytes, 8);
    a = (a - c) ^ rotl(c, 4), c += b;
    b = (b - a) ^ rotl(a, 6), a += c;
    c = (c - b) ^ rotl(b, 8), b += a;
    a = (a - c) ^ rotl(c, 16), c += b;
    b = (b - a) ^ rotl(a, 19), a += c;
    c = (c - b) ^ rotl(b, 4), b += a;
    bytes = bytes.subspan(12);
  }
  a += word_at(bytes, 0);
  b += word_at(bytes, 4);
  c += word_at(bytes, 8);
  c = (c ^ b) - rotl(b, 14);
  a = (a ^ c) - rotl(c, 11);
  b = (b ^ a) - rotl(a, 25);
  c = (c ^ b) - rotl(b, 16);
  a = (a ^ c) - rotl(c, 4);
  b = (b ^ a) - rotl(a, 14);
  c = (c ^ b) - rotl(b, 24);
  return c;
}

std::uint32_t fletcher32(Bytes bytes) {
  constexpr std::size_t kBlock = 360;  ///< words whose sums do not overflow 32 bits
  std::uint32_t sum1 = 0;
  std::uint32_t sum2 = 0;
  const auto fold = [](std::uint32_t sum) { return (sum & 0xFFFFU) + (sum >> 16u); };
  for (std::size_t i = 0; i < bytes.size();) {
    for (std::size_t k = 0; k < kBlock && i < bytes.size(); ++k, i += 2) {
      const auto low = i + 1 < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + 1]) : 0U;
      sum1 += std::to_integer<std::uint32_t>(bytes[i]) << 8u | low;
      sum2 += sum1;
    }
    sum1 = fold(sum1);
    sum2 = fold(sum2);
  }
  return fold(sum2) << 16u | fold(sum1);
}

bool checksum_is_right([[maybe_unused]] Bytes block) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  return block.size() >= kChecksumSize;
#else
  if (block.size() < kChecksumSize) return false;
  const Bytes body = block.first(block.size() - kChecksumSize);
  return Cursor(block.subspan(body.size())).dword() == lookup3(body);
#endif
}

}  // namespace mbk::hdf5
