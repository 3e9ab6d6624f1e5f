#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mbk::recording {

// Numbers, times and texts in the cells of a table that is text.

/// The cell without the blanks and tabs around it, and then without the quotes around it.
[[nodiscard]] std::string_view without_quotes(std::string_view cell);

/// digits / 10^decimals to rounding, where both fit into 64 bits: the quotient to 63 bits or more, and whether anything
/// is left of it, decide how it is rounded.
[[nodiscard]] inline double quotient(std::uint64_t digits, std::size_t decimals) {
  constexpr std::array<std::uint64_t, 20> kPowers = [] {
    std::array<std::uint64_t, 20> powers{1};
    for (std::size_t k = 1; k < powers.size(); ++k) powers[k] = 10 * powers[k - 1];
    return powers;
  }();
  if (digits == 0) return 0.0;
  __extension__ using Wide = unsigned __int128;
  const int up = std::countl_zero(digits), down = std::countl_zero(kPowers[decimals]);
  const Wide dividend = Wide{digits << static_cast<unsigned>(up)} << 63U;
  const std::uint64_t divisor = kPowers[decimals] << static_cast<unsigned>(down);
  const auto whole = static_cast<std::uint64_t>(dividend / divisor);
  const bool rest = Wide{whole} * divisor != dividend;
  const auto power_of_two = std::bit_cast<double>(static_cast<std::uint64_t>(1023 + down - up - 63) << 52U);
  return static_cast<double>(whole | static_cast<std::uint64_t>(rest)) * power_of_two;
}

/// Digits with at most a sign and a point, no more of them than 64 bits hold: what most programs write. Their value to
/// rounding. Nothing where a cell holds anything else.
[[nodiscard]] inline std::optional<double> plain_number(std::string_view cell) {
  constexpr std::uint64_t kExact = std::uint64_t{1} << 53;
  constexpr std::size_t kLongest = 20;  // a point and 19 digits
  constexpr std::array kPowers = {1e0, 1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7, 1e8,
                                  1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16};
  const bool negative = cell.starts_with('-');
  if (negative) cell.remove_prefix(1);
  if (cell.size() > kLongest) return std::nullopt;
  std::uint64_t digits = 0;
  std::size_t point = cell.size();
  for (std::size_t k = 0; k < cell.size(); ++k) {
    const auto digit = static_cast<unsigned>(cell[k] - '0');
    if (digit <= 9) {
      digits = 10 * digits + digit;
    } else if (cell[k] == '.' && point == cell.size()) {
      point = k;
    } else {
      return std::nullopt;
    }
  }
  const std::size_t decimals = point == cell.size() ? 0 : cell.size() - point - 1;
  const bool any = decimals > 0 || point > 0;
  if (!any || (point == cell.size() && point == kLongest)) return std::nullopt;
  // Where both are exact, one division rounds once (Clinger 1990).
  const bool exact = digits <= kExact && decimals < kPowers.size();
  const double value = exact ? static_cast<double>(digits) / kPowers[decimals] : quotient(digits, decimals);
  return negative ? -value : value;
}

/// Any number with a decimal point, in quotes or not; NaN where the cell is empty; nothing where it is not a number.
[[nodiscard]] std::optional<double> general_number(std::string_view cell);

/// The same, of a cell that is likely to be plain.
[[nodiscard]] inline std::optional<double> cell_number(std::string_view cell) {
  if (const auto plain = plain_number(cell)) return plain;
  return general_number(cell);
}

/// A number with a decimal comma and without a point, or without either.
struct CommaNumber {
  double value;
  bool has_comma;
  bool sure;  ///< the comma cannot stand between thousands: "0,5" or "1,2345", but not "1,234"
};
[[nodiscard]] std::optional<CommaNumber> comma_number(std::string_view cell);

/// A time of day, "10:15:30.123", or a date with one, "2024-03-01T10:15:30.123+01:00" (ISO 8601; a blank in place of
/// T).
struct Instant {
  std::optional<std::int64_t> day;  ///< since 1970-01-01; nothing where the cell holds no date
  double seconds;                   ///< since midnight, of universal time where the cell says a time zone
};
[[nodiscard]] std::optional<Instant> instant(std::string_view cell);

}  // namespace mbk::recording
