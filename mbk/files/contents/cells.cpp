#include "mbk/files/contents/cells.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "mbk/base/core/rests.h"
#include "mbk/base/core/trimmed.h"

namespace mbk::recording {
namespace {

constexpr double kMinute = 60.0, kHour = 3600.0;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Takes `count` digits from the front of the text.
std::optional<int> take_digits(std::string_view& text, std::size_t count) {
  if (text.size() < count || !std::ranges::all_of(text.substr(0, count), is_digit)) return std::nullopt;
  int value = 0;
  for (const char c : text.substr(0, count)) value = 10 * value + (c - '0');
  text.remove_prefix(count);
  return value;
}

bool take(std::string_view& text, char c) {
  if (!text.starts_with(c)) return false;
  text.remove_prefix(1);
  return true;
}

/// One or two digits from the front of the text.
std::optional<int> take_day_digits(std::string_view& text) {
  const auto two = take_digits(text, 2);
  return two ? two : take_digits(text, 1);
}

/// "2024-03-01", "2024/03/01" or "01.03.2024" from the front of the text, as a day since 1970-01-01. What 01/03/2024
/// means depends on who wrote it; with AM or PM the month goes first.
std::optional<std::int64_t> take_date(std::string_view& text, bool twelve_hours) {
  using namespace std::chrono;  // NOLINT(google-build-using-namespace): its literals and calendar
  std::string_view rest = text;
  const std::size_t digits = rest.find_first_not_of("0123456789");
  const bool year_first = digits == 4 && (rest[4] == '-' || rest[4] == '/');
  const bool month_first = !year_first && twelve_hours && digits < 3 && rest[digits] == '/';
  const char sign = year_first ? rest[4] : month_first ? '/' : '.';
  auto first = year_first ? take_digits(rest, 4) : take_day_digits(rest);
  if (!first || !take(rest, sign)) return std::nullopt;
  auto m = take_day_digits(rest);
  if (!m || !take(rest, sign)) return std::nullopt;
  const auto last = year_first ? take_day_digits(rest) : take_digits(rest, 4);
  if (!last) return std::nullopt;
  if (month_first) std::swap(first, m);
  const year_month_day date{year(year_first ? *first : *last), month(static_cast<unsigned>(*m)),
                            day(static_cast<unsigned>(year_first ? *last : *first))};
  if (!date.ok()) return std::nullopt;
  text = rest;
  return sys_days(date).time_since_epoch().count();
}

/// "10:15:30.123" or "9:05:07,5" from the front of the text [s].
std::optional<double> take_clock(std::string_view& text) {
  const std::size_t hour_digits = text.size() > 1 && text[1] == ':' ? 1 : 2;
  const auto hours = take_digits(text, hour_digits);
  if (!hours || *hours > 23 || !take(text, ':')) return std::nullopt;
  const auto minutes = take_digits(text, 2);
  if (!minutes || *minutes > 59 || !take(text, ':')) return std::nullopt;
  const auto seconds = take_digits(text, 2);
  if (!seconds || *seconds > 60) return std::nullopt;  // 60: a leap second
  double fraction = 0.0;
  if (text.size() > 1 && (text[0] == '.' || text[0] == ',') && is_digit(text[1])) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789", 1), text.size());
    std::string decimal = "0." + std::string(text.substr(1, end - 1));
    fraction = general_number(decimal).value_or(0.0);
    text.remove_prefix(end);
  }
  return kHour * *hours + kMinute * *minutes + *seconds + fraction;
}

/// "Z", "+01:00", "-0530" or "+01" that is the whole text [s]; 0 if there is none.
std::optional<double> zone(std::string_view text) {
  if (text.empty() || text == "Z" || text == "z") return 0.0;
  const bool west = text.starts_with('-');
  if (!west && !text.starts_with('+')) return std::nullopt;
  text.remove_prefix(1);
  const auto hours = take_digits(text, 2);
  if (!hours || *hours > 14) return std::nullopt;
  double offset = kHour * *hours;
  if (!text.empty()) {
    take(text, ':');
    const auto minutes = take_digits(text, 2);
    if (!minutes || *minutes > 59 || !text.empty()) return std::nullopt;
    offset += kMinute * *minutes;
  }
  return west ? -offset : offset;
}

/// Whether the text ends in "PM" or in "AM", which are taken from it; nothing where it ends in neither.
std::optional<bool> take_half_of_day(std::string_view& text) {
  const std::size_t end = text.size();
  if (end < 3 || (text[end - 1] != 'M' && text[end - 1] != 'm')) return std::nullopt;
  const char half = text[end - 2];
  const bool before = half == 'A' || half == 'a', after = half == 'P' || half == 'p';
  if (!before && !after) return std::nullopt;
  text = mbk::trimmed(text.substr(0, end - 2));
  return after;
}

/// "1.#QNAN", "-1.#IND00", "1.#INF": not a number and infinity as programs of Windows wrote them until 2015.
std::optional<double> old_windows_number(std::string_view cell) {
  const bool negative = take(cell, '-');
  if (!take(cell, '1') || (!take(cell, '.') && !take(cell, ',')) || !take(cell, '#')) return std::nullopt;
  cell = cell.substr(0, cell.find_last_not_of('0') + 1);  // a format may ask for more digits
  for (const std::string_view none : {"QNAN", "SNAN", "IND"}) {
    if (cell == none) return std::numeric_limits<double>::quiet_NaN();
  }
  if (cell != "INF") return std::nullopt;
  return negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
}

}  // namespace

std::string_view without_quotes(std::string_view cell) {
  cell = mbk::trimmed(cell, " \t");
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
  return cell;
}

std::optional<double> general_number(std::string_view cell) {
  cell = without_quotes(cell);
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (cell.front() == '+') {
    cell.remove_prefix(1);
    if (cell.empty() || cell.front() == '-' || cell.front() == '+') return std::nullopt;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (end != cell.data() + cell.size()) return old_windows_number(cell);
  if (error == std::errc()) return value;
  if (error != std::errc::result_out_of_range) return std::nullopt;
  value = std::strtod(std::string(cell).c_str(), nullptr);  // too small is 0 or subnormal; too large is not a number
  if (std::isinf(value)) return std::nullopt;
  return value;
}

std::int16_t rest_of_cell(std::string_view cell) {
  cell = without_quotes(cell);
  if (const auto point = cell.find_first_of(".,"); point != cell.npos) {
    if (cell.find_first_not_of('0', point + 1) != cell.npos) return 0;
    cell = cell.substr(0, point);
  }
  take(cell, '+');
  const auto rest = [cell](auto whole) -> std::optional<std::int16_t> {
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), whole);
    if (error != std::errc() || end != cell.data() + cell.size()) return std::nullopt;
    return rest_of(whole);
  };
  const auto found = cell.starts_with('-') ? rest(std::int64_t{}) : rest(std::uint64_t{});
  return found.value_or(0);
}

std::optional<CommaNumber> comma_number(std::string_view cell) {
  cell = without_quotes(cell);
  if (cell.find('.') != cell.npos) return std::nullopt;
  const auto comma = cell.find(',');
  if (comma == cell.npos) {
    const auto value = general_number(cell);
    if (!value) return std::nullopt;
    return CommaNumber{*value, false, false};
  }
  constexpr std::size_t kThousands = 3;
  if (comma + 1 == cell.size() || !is_digit(cell[comma + 1]) || cell.find('"') != cell.npos) return std::nullopt;
  std::string with_point(cell);
  with_point[comma] = '.';
  const auto value = general_number(with_point);
  if (!value) return std::nullopt;
  const std::size_t first = cell.find_first_not_of("+-");
  const bool thousands = comma - first >= 1 && comma - first <= kThousands && cell[first] != '0' &&
                         cell.size() - comma - 1 == kThousands &&
                         cell.find_first_not_of("0123456789", comma + 1) == cell.npos;
  return CommaNumber{*value, true, !thousands};
}

std::optional<Instant> instant(std::string_view cell) {
  constexpr std::size_t kShortest = 7;  // 9:05:07
  cell = without_quotes(cell);
  if (cell.size() < kShortest || !is_digit(cell.front())) return std::nullopt;
  const std::optional<bool> afternoon = take_half_of_day(cell);
  Instant found{take_date(cell, afternoon.has_value()), 0.0};
  if (found.day) {
    if (cell.empty()) return afternoon ? std::nullopt : std::optional(found);
    if (!take(cell, 'T') && !take(cell, 't') && !take(cell, ' ')) return std::nullopt;
  }
  auto clock = take_clock(cell);
  if (!clock) return std::nullopt;
  if (afternoon) {
    constexpr double kNoon = 12.0 * kHour;
    if (*clock < kHour || *clock >= kNoon + kHour) return std::nullopt;
    *clock += (*clock >= kNoon ? -kNoon : 0.0) + (*afternoon ? kNoon : 0.0);
  }
  const auto offset = zone(mbk::trimmed(cell));
  if (!offset || (!found.day && !cell.empty())) return std::nullopt;
  found.seconds = *clock - *offset;
  return found;
}

}  // namespace mbk::recording
