#pragma once

#include <cstdint>
#include <random>

namespace mbk::numeric {

/// Random numbers that are the same on every platform. The C++ standard fixes every bit of std::mt19937_64 and
/// std::seed_seq, which these are of, but not of its distributions, so they are written out here. Streams of one seed
/// are independent: adding noise to one signal leaves every other signal as it was.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint32_t stream = 0);

  /// Uniform on [0, 1): the top 53 bits of a draw, times 2⁻⁵³.
  double uniform();

  /// Uniform on [low, high].
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Uniform on {0, …, count − 1}; draws that would favour the small numbers are rejected. count > 0.
  std::uint64_t below(std::uint64_t count);

  /// Standard normal by Marsaglia's polar method (1964): u, v uniform on (−1, 1) with 0 < s = u² + v² < 1, then
  ///   u √(−2 ln s / s)
  /// Its partner v √(…) is dropped. The last digit is that of the platform's logarithm.
  double normal();

 private:
  std::mt19937_64 draw_;
};

}  // namespace mbk::numeric
