#include "mbk/files/c3d/c3d_words.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mbk::recording {
namespace {

constexpr double kHalfRange = 32768.0;  ///< of a word

/// A channel with its words read as signed or unsigned.
struct Reading {
  double offset = 0.0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  double step = 0.0, last = 0.0;  ///< step: the largest between two samples

  void add(double value) {
    if (!std::isfinite(value)) return;
    if (low <= high) step = std::max(step, std::abs(value - last));
    low = std::min(low, value);
    high = std::max(high, value);
    last = value;
  }
  [[nodiscard]] bool within_reach() const {
    return !(low <= high) || std::max(std::abs(low - offset), std::abs(high - offset)) <= kHalfRange;
  }
};

}  // namespace

double signed_word(double word) {
  return word >= kHalfRange ? word - 2 * kHalfRange : word;
}

bool words_are_unsigned(const C3dStored& stored, bool said) {
  Reading as_unsigned{stored.offset}, as_signed{stored.offset_is_word ? signed_word(stored.offset) : stored.offset};
  for (const double value : stored.values) {
    as_unsigned.add(value);
    as_signed.add(stored.words ? signed_word(value) : value);
  }
  const Reading& here = said ? as_unsigned : as_signed;
  const Reading& other = said ? as_signed : as_unsigned;
  const bool usual_offset = said ? other.offset < 0.0 && other.offset >= -kHalfRange / 2   // zero drift
                                 : std::abs(other.offset - kHalfRange) <= kHalfRange / 2;  // mid-range
  const bool out_of_reach = !here.within_reach() && other.within_reach() && other.step <= here.step && usual_offset;
  // Small steps over a wide range: not a switch that toggles between both ends of the range.
  const bool wraps = here.step >= kHalfRange && other.step <= kHalfRange / 4 && other.high - other.low > kHalfRange / 2;
  return out_of_reach || wraps ? !said : said;
}

}  // namespace mbk::recording
