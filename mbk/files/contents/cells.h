#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace mbk::recording {

// Numbers, times and texts in the cells of a table that is text.

/// The cell without the blanks and tabs around it, and then without the quotes around it.
[[nodiscard]] std::string_view without_quotes(std::string_view cell);

/// A number at the front of a text.
struct NumberAhead {
  double value = 0.0;
  std::size_t length = 0;  ///< number of characters; 0 if the text does not begin with such a number
};

/// The number of digits, with at most a sign and a point and no more of them than 64 bits hold, with which a text
/// begins: what most programs write. Its value to rounding.
/// @param end  of what can be read, which may reach beyond the text: eight characters are looked at together
[[nodiscard, gnu::always_inline]] inline NumberAhead plain_number_ahead(const char* begin, const char* end);

/// Digits with at most a sign and a point, at most what 64 bits hold. Nothing for any other cell.
[[nodiscard]] inline std::optional<double> plain_number(std::string_view cell) {
  const NumberAhead ahead = plain_number_ahead(cell.data(), cell.data() + cell.size());
  if (ahead.length == 0 || ahead.length != cell.size()) return std::nullopt;
  return ahead.value;
}

/// Any number with a decimal point, in quotes or not; NaN if the cell is empty or NaN ("nan", "-nan(ind)", "1.#QNAN");
/// nothing if it is not a number.
[[nodiscard]] std::optional<double> general_number(std::string_view cell);

/// The same, of a cell that is likely to be plain.
[[nodiscard]] inline std::optional<double> cell_number(std::string_view cell) {
  if (const auto plain = plain_number(cell)) return plain;
  return general_number(cell);
}

/// What a double leaves of the whole number in a cell (rest_of), written with digits alone or with a point and zeros; 0
/// where the cell holds none.
[[nodiscard]] std::int16_t rest_of_cell(std::string_view cell);

/// A number with a decimal comma and without a point, or without either.
struct CommaNumber {
  double value;
  bool has_comma;
  bool sure;  ///< the comma cannot stand between thousands: "0,5" or "1,2345", but not "1,234"
};
[[nodiscard]] std::optional<CommaNumber> comma_number(std::string_view cell);

/// A time of day, "10:15:30.123", or a date with one, "2024-03-01T10:15:30.123+01:00" (ISO 8601; a blank in place of
/// T; 2024/03/01 and 01.03.2024 are dates too); "3:15:30 PM", and then "3/1/2024 3:15:30 PM", in which the month goes
/// first.
struct Instant {
  std::optional<std::int64_t> day;  ///< since 1970-01-01; nothing if the cell contains no date
  double seconds;                   ///< since midnight, in universal time if the cell has a time zone
};
[[nodiscard]] std::optional<Instant> instant(std::string_view cell);

namespace decimal {

inline constexpr std::size_t kDigits = 19;  ///< that 64 bits hold, whichever they are

inline constexpr std::array<std::uint64_t, kDigits + 1> kPowers = [] {
  std::array<std::uint64_t, kDigits + 1> powers{1};
  for (std::size_t k = 1; k < powers.size(); ++k) powers[k] = 10 * powers[k - 1];
  return powers;
}();

__extension__ using Wide = unsigned __int128;

/// A power of ten with its first bit at the top, and 2^127 divided by that, rounded down.
struct Divisor {
  int down;
  std::uint64_t value, reciprocal;
};
inline constexpr std::array<Divisor, kDigits + 1> kDivisors = [] {
  std::array<Divisor, kDigits + 1> divisors{};
  for (std::size_t k = 0; k < divisors.size(); ++k) {
    const int down = std::countl_zero(kPowers[k]);
    const std::uint64_t value = kPowers[k] << static_cast<unsigned>(down);
    divisors[k] = {down, value, static_cast<std::uint64_t>(~Wide{0} / 2 / value)};
  }
  return divisors;
}();

/// digits / 10^decimals to rounding: 63 bits or more of the quotient, and whether anything is left of it, decide how it
/// is rounded. What the reciprocal gives of them is right or one too small, which seldom matters.
[[nodiscard, gnu::always_inline]] inline double quotient(std::uint64_t digits, std::size_t decimals) {
  if (digits == 0) return 0.0;
  const Divisor& by = kDivisors[decimals];
  const int up = std::countl_zero(digits);
  const std::uint64_t dividend = digits << static_cast<unsigned>(up);
  auto whole = static_cast<std::uint64_t>(Wide{dividend} * by.reciprocal >> 64U);
  // The bits behind the 53 that stay: where they are a half or just below, the others decide.
  const auto behind = static_cast<unsigned>(11 - std::countl_zero(whole));
  const std::uint64_t half = std::uint64_t{1} << (behind - 1), rest = whole & (2 * half - 1);
  if (rest == half || rest == half - 1) {
    const Wide exact = Wide{dividend} << 63U;
    whole = static_cast<std::uint64_t>(exact / by.value);
    whole |= static_cast<std::uint64_t>(Wide{whole} * by.value != exact);
  }
  // A bit less is a signed number, and its last one says whether anything is left.
  const auto rounded = static_cast<double>(static_cast<std::int64_t>(whole >> 1U | (whole & 1U)));
  return rounded * std::bit_cast<double>(static_cast<std::uint64_t>(1023 + by.down - up - 62) << 52U);
}

/// Eight characters as one number, the first lowest; beyond the end none is a digit.
[[nodiscard]] inline std::uint64_t eight_at(const char* at, const char* end) {
  std::uint64_t eight = 0;
  if (end - at >= 8) {
    std::memcpy(&eight, at, sizeof eight);
    if constexpr (std::endian::native == std::endian::big) eight = __builtin_bswap64(eight);
    return eight;
  }
  for (unsigned k = 0; at + k < end; ++k) eight |= std::uint64_t{static_cast<unsigned char>(at[k])} << 8 * k;
  return eight;
}

/// Digits with which a text begins.
struct Digits {
  std::size_t count = 0;  ///< above kDigits where there are more
  std::uint64_t value = 0;
};

[[nodiscard, gnu::always_inline]] inline Digits digits_at(const char* at, const char* end) {
  Digits all;
  for (const bool last : {false, false, true}) {
    std::uint64_t eight = eight_at(at + all.count, end) ^ 0x3030303030303030U;  // digits are 0 to 9
    const std::uint64_t others = (((eight & 0x7F7F7F7F7F7F7F7FU) + 0x7676767676767676U) | eight) & 0x8080808080808080U;
    const auto count = static_cast<unsigned>(std::countr_zero(others)) / 8;  // 8 where there is no other
    all.count += count;
    if (last && count == 8) break;
    // Zeros before them; then pairs, fours and all eight as one number each.
    eight = count == 8 ? eight : eight << (56 - 8 * count) << 8U;
    eight = 10 * eight + (eight >> 8U);
    eight = ((eight & 0x000000FF000000FFU) * 0x000F424000000064U +
             ((eight >> 16U) & 0x000000FF000000FFU) * 0x0000271000000001U) >>
            32U;
    all.value = kPowers[count] * all.value + eight;
    if (count < 8) break;
  }
  return all;
}

}  // namespace decimal

inline NumberAhead plain_number_ahead(const char* begin, const char* end) {
  const bool negative = begin != end && *begin == '-';
  const char* at = begin + (negative ? 1 : 0);
  const decimal::Digits whole = decimal::digits_at(at, end);
  at += whole.count;
  decimal::Digits part;
  if (at != end && *at == '.') {
    part = decimal::digits_at(at + 1, end);
    at += 1 + part.count;
  }
  const std::size_t count = (whole.count == 1 && whole.value == 0 ? 0 : whole.count) + part.count;
  if (whole.count + part.count == 0 || count > decimal::kDigits) return {};
  const double value = decimal::quotient(decimal::kPowers[part.count] * whole.value + part.value, part.count);
  return {negative ? -value : value, static_cast<std::size_t>(at - begin)};
}

}  // namespace mbk::recording
