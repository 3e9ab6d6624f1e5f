#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mbk {

inline constexpr double kExactWhole = 9007199254740992.0;  ///< 2^53: a double holds every whole number up to here

/// What a double leaves of a whole number: value - double(value). At most 1024 in size.
template <std::integral Whole>
[[nodiscard]] std::int16_t rest_of(Whole value) {
  __extension__ using Wide = __int128;
  if constexpr (sizeof(Whole) < 8) return 0;
  return static_cast<std::int16_t>(Wide{value} - static_cast<Wide>(static_cast<double>(value)));
}

/// What doubles leave of whole numbers above 2^53, in the order of these: number = double + rest. Takes no memory until
/// a double does not hold its number.
class Rests {
 public:
  /// @param at  index of the number; they may come in any order    @param count  of all numbers, or 0 where they are
  /// not known yet
  void put(std::size_t at, std::int16_t rest, std::size_t count = 0) {
    if (rest == 0 && at >= rests_.size()) return;
    if (at >= rests_.size()) rests_.resize(count > at ? count : at + 1);
    rests_[at] = rest;
  }
  [[nodiscard]] bool empty() const { return rests_.empty(); }
  [[nodiscard]] std::int16_t operator[](std::size_t at) const { return at < rests_.size() ? rests_[at] : 0; }

 private:
  std::vector<std::int16_t> rests_;
};

}  // namespace mbk
