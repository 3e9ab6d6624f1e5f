#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace mbk::numeric {

/// Random numbers that are the same on every platform. The C++ standard fixes every bit of std::mt19937_64 and
/// std::seed_seq, but not of its distributions, so these are written out here. Streams of one seed are independent:
/// adding noise to one signal leaves every other signal as it was.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint32_t stream = 0) {
    std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), stream};
    engine_.seed(sequence);
  }

  /// Uniform on [0, 1): the top 53 bits of a draw, times 2⁻⁵³.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  /// Uniform on [low, high].
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Uniform on {0, …, count − 1}; draws that would favour the small numbers are rejected. count > 0.
  std::uint64_t below(std::uint64_t count) {
    std::uint64_t draw = engine_();
    if (draw < count) {                                  // hardly ever
      const std::uint64_t excess = (0 - count) % count;  // 2⁶⁴ mod count
      while (draw < excess) draw = engine_();
    }
    return draw % count;
  }

  /// Standard normal by Marsaglia's polar method (1964): u, v uniform on (−1, 1) with 0 < s = u² + v² < 1, then
  ///   u √(−2 ln s / s)
  /// Its partner v √(…) is dropped. The last digit is that of the platform's logarithm.
  double normal() {
    for (;;) {
      const double u = 2.0 * uniform() - 1.0;
      const double v = 2.0 * uniform() - 1.0;
      const double s = u * u + v * v;
      if (s > 0.0 && s < 1.0) return u * std::sqrt(-2.0 * std::log(s) / s);
    }
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace mbk::numeric
