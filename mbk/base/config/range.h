#pragma once

#include <string>

namespace mbk::config {

/// The allowed range of a number, in the unit of its key.
struct Range {
  enum class Kind { any, above, at_least, between, within };
  Kind kind = Kind::any;
  double low = 0.0;
  double high = 0.0;

  [[nodiscard]] bool holds(double value) const;
  /// "choose a value above 0": what to do about a value outside the range.
  [[nodiscard]] std::string remedy() const;
};

[[nodiscard]] constexpr Range any() {
  return {};
}
/// value > low
[[nodiscard]] constexpr Range above(double low) {
  return {Range::Kind::above, low};
}
/// value ≥ low
[[nodiscard]] constexpr Range at_least(double low) {
  return {Range::Kind::at_least, low};
}
/// low ≤ value ≤ high
[[nodiscard]] constexpr Range between(double low, double high) {
  return {Range::Kind::between, low, high};
}
/// low < value < high
[[nodiscard]] constexpr Range within(double low, double high) {
  return {Range::Kind::within, low, high};
}

}  // namespace mbk::config
