#include "mbk/base/numeric/random.h"

#include <cmath>
#include <random>
#include <span>

namespace mbk::numeric {
namespace {

/// Renews all words of the Mersenne twister (Matsumoto and Nishimura 1998; 64 bits: Nishimura 2000) as std::mt19937_64
/// does, without its branch on a bit that is drawn at random, in which noise spent a third of its time.
void renew(std::span<std::uint64_t, 312> words) {
  constexpr std::uint64_t kLow = 0x7fffffff, kTwist = 0xb5026f5aa96619e9;
  constexpr std::size_t kAhead = 156;
  const auto twisted = [&](std::size_t here, std::size_t next, std::size_t ahead) {
    const std::uint64_t joined = (words[here] & ~kLow) | (words[next] & kLow);
    words[here] = words[ahead] ^ (joined >> 1U) ^ (kTwist & (0 - (joined & 1U)));
  };
  for (std::size_t k = 0; k < kAhead; ++k) twisted(k, k + 1, k + kAhead);
  for (std::size_t k = kAhead; k < words.size() - 1; ++k) twisted(k, k + 1, k - kAhead);
  twisted(words.size() - 1, 0, kAhead - 1);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint32_t stream) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), stream};
  std::array<std::uint32_t, 2 * kWords> halves;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  sequence.generate(halves.begin(), halves.end());
  for (std::size_t k = 0; k < kWords; ++k) words_[k] = halves[2 * k] | std::uint64_t{halves[2 * k + 1]} << 32U;
}

std::uint64_t Random::draw() {
  if (next_ == kWords) {
    renew(words_);
    next_ = 0;
  }
  std::uint64_t z = words_[next_++];
  z ^= (z >> 29U) & 0x5555555555555555U;
  z ^= (z << 17U) & 0x71d67fffeda60000U;
  z ^= (z << 37U) & 0xfff7eee000000000U;
  return z ^ (z >> 43U);
}

double Random::uniform() {
  return static_cast<double>(draw() >> 11) * 0x1p-53;
}

std::uint64_t Random::below(std::uint64_t count) {
  std::uint64_t drawn = draw();
  if (drawn < count) {                                 // hardly ever
    const std::uint64_t excess = (0 - count) % count;  // 2⁶⁴ mod count
    while (drawn < excess) drawn = draw();
  }
  return drawn % count;
}

double Random::normal() {
  for (;;) {
    const double u = 2.0 * uniform() - 1.0;
    const double v = 2.0 * uniform() - 1.0;
    const double s = u * u + v * v;
    if (s > 0.0 && s < 1.0) return u * std::sqrt(-2.0 * std::log(s) / s);
  }
}

}  // namespace mbk::numeric
