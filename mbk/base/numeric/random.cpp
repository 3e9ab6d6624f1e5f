#include "mbk/base/numeric/random.h"

#include <cmath>
#include <random>

namespace mbk::numeric {
namespace {

std::mt19937_64 generator(std::uint64_t seed, std::uint32_t stream) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), stream};
  return std::mt19937_64(sequence);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint32_t stream) : draw_(generator(seed, stream)) {}

double Random::uniform() {
  return static_cast<double>(draw_() >> 11) * 0x1p-53;
}

std::uint64_t Random::below(std::uint64_t count) {
  std::uint64_t drawn = draw_();
  if (drawn < count) {                                 // hardly ever
    const std::uint64_t excess = (0 - count) % count;  // 2⁶⁴ mod count
    while (drawn < excess) drawn = draw_();
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
