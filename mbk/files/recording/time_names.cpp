#include "mbk/files/recording/time_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "mbk/files/recording/channel_table.h"

namespace mbk::recording {
namespace time_names {

/// Names of time in small letters, without blanks and signs.
constexpr auto kNames = std::to_array<std::string_view>(
    {"time", "timestamp", "timestamps", "tout", "elapsed", "elapsedtime", "timeelapsed", "zeit", "zeitstempel",
     "datetime", "dateandtime", "unixtime", "epochtime", "simtime", "rosbagtimestamp", "seconds"});

char small(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
}

bool is_alphanumeric(char c) {
  return (small(c) >= 'a' && small(c) <= 'z') || (c >= '0' && c <= '9');
}

std::string squeezed(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    if (is_alphanumeric(c)) letters += small(c);
  }
  return letters;
}

std::string_view name_in(const Contents& contents, const Array& array) {
  const std::string_view name = array.name;
  return contents.table ? name : name.substr(name.find_last_of("./") + 1);
}

bool is_called_time(std::string_view name) {
  const auto kinds = parse_column_name(name).kinds;
  return std::ranges::any_of(kinds, [](const ChannelKind* kind) { return kind->name == "time"; });
}

/// Whether a name without its unit is one of `kNames`.
bool is_other_name(std::string_view name) {
  const auto is_known = [](std::string_view base) { return std::ranges::find(kNames, squeezed(base)) != kNames.end(); };
  const Unit* const unit = parse_column_name(name).unit;
  if (unit != nullptr && unit->dimension != Dimension::time) return false;
  if (is_known(name)) return true;
  const auto end = name.find_first_of("([") != name.npos ? name.find_first_of("([") : name.find_last_of("_ ,/");
  return unit != nullptr && end != name.npos && is_known(name.substr(0, end));
}

/// Whether a word of the name is one of time: "t" of "t_robot", "stamp" of "header.stamp", "Time" of "SensorTime".
bool speaks_of_time(std::string_view name) {
  constexpr auto kWords = std::to_array<std::string_view>(
      {"t", "time", "timestamp", "timestamps", "stamp", "tout", "zeit", "zeitstempel", "clock", "elapsed"});
  std::string word;
  const auto is_word = [&] { return std::ranges::find(kWords, word) != kWords.end(); };
  for (std::size_t k = 0; k < name.size(); ++k) {
    const bool camel = k > 0 && small(name[k - 1]) == name[k - 1] && small(name[k]) != name[k];
    if (!is_alphanumeric(name[k]) || camel) {
      if (is_word()) return true;
      word.clear();
    }
    if (is_alphanumeric(name[k])) word += small(name[k]);
  }
  return is_word();
}

Index size_of(const Array& array) {
  const bool vector = !array.is_block() && std::min(array.values.rows(), array.values.cols()) == 1;
  return vector && !array.obstacle ? array.values.size() : 0;
}

/// How an array runs on; `step` is 0 where it does not.
struct Run {
  double span = 0.0, step = 0.0;  ///< `step`: the smallest above zero
};
Run run_of(const Array& array) {
  constexpr double kMaxGaps = 10.0;  // a column that jumps more than it runs is a duration or a counter of something
  const Index size = size_of(array);
  const double* const values = array.values.data();
  double smallest = std::numeric_limits<double>::infinity(), largest = 0.0;
  for (Index k = 1; k < size; ++k) {
    const double step = values[k] - values[k - 1];
    if (!(step >= 0.0)) return {};
    if (step > 0.0) smallest = std::min(smallest, step);
    largest = std::max(largest, step);
  }
  const double span = size > 1 ? values[size - 1] - values[0] : 0.0;
  const bool runs = size > 2 && largest < std::max(0.5 * span, kMaxGaps * span / static_cast<double>(size));
  return runs && std::isfinite(span) ? Run{span, smallest} : Run{};
}

const Unit* said_unit(const Contents& contents, const Array& array) {
  const Unit* const unit =
      array.unit.empty() ? parse_column_name(name_in(contents, array)).unit : find_unit(array.unit);
  if (unit != nullptr) return unit->dimension == Dimension::time ? unit : nullptr;
  return array.values.size() > 0 ? unit_since_1970(array.values.data()[0]) : nullptr;
}

/// The difference of the other time from the first; "" if they agree.
std::string difference(const Contents& contents, const Array& one, const Unit* unit, const Array& other) {
  const double scale = unit != nullptr ? unit->to_si(1.0) : 1.0;
  const Run first = run_of(one), second = run_of(other);
  if (first.step == 0.0 || second.step == 0.0) return {};
  const double span = first.span * scale;
  const Unit* other_unit = said_unit(contents, other);
  double other_scale = other_unit != nullptr ? other_unit->to_si(1.0) : 1.0;
  if (other_unit == nullptr) {  // the one that fits best
    const auto misfit = [&](double factor) { return std::abs(std::log(factor * second.span / span)); };
    for (const double factor : {1.0, 1e-3, 1e-6, 1e-9}) {
      if (misfit(factor) < misfit(other_scale)) other_scale = factor;
    }
  }
  const double *const a = one.values.data(), *const b = other.values.data();
  const auto intervals = static_cast<double>(one.values.size() - 1);
  double apart = 0.0;
  for (Index k = 1; k < one.values.size(); ++k) {
    apart = std::max(apart, std::abs((b[k] - b[0]) * other_scale - (a[k] - a[0]) * scale));
  }
  constexpr double kRounding = 1.001;
  const double other_span = second.span * other_scale;
  const double allowed = std::max({span / intervals, first.step * scale, second.step * other_scale});
  if (apart <= kRounding * allowed) return {};
  constexpr double kOtherRate = 0.01;
  if (std::abs(other_span - span) > kOtherRate * span) {
    return fmt::format("'{}' has {:.4g} Hz, but '{}' has {:.4g} Hz", other.name, intervals / other_span, one.name,
                       intervals / span);
  }
  return fmt::format("'{}' differs from '{}' by up to {:.3g} ms", other.name, one.name, 1e3 * apart);
}

}  // namespace time_names

const Unit* unit_since_1970(double stamp) {
  constexpr double kEarliest = 1e9, kLatest = 4e9;  // [s]
  for (const std::string_view name : {"s", "ms", "us", "ns"}) {
    const Unit* const unit = find_unit(name);
    if (const double seconds = unit->to_si(stamp); seconds > kEarliest && seconds < kLatest) return unit;
  }
  return nullptr;
}

Result<void> name_time(Contents& contents) {
  using namespace time_names;  // NOLINT(google-build-using-namespace): of this file
  if (!contents.clocks.empty()) return {};
  std::vector<Array*> called;
  for (Array& array : contents.arrays) {
    const std::string_view name = name_in(contents, array);
    if (is_called_time(array.means.empty() ? name : std::string_view(array.means))) return {};
    if (!array.means.empty() || !is_other_name(name)) continue;
    const bool words = array.obstacle && contents.table && contents.rate_hz == 0.0;
    const auto as_long = [&](const Array& other) {
      return &other != &array && std::max(other.values.rows(), other.values.cols()) == size_of(array);
    };
    const bool runs = size_of(array) > 1 && std::ranges::any_of(contents.arrays, as_long);
    if (words || runs) called.push_back(&array);
  }
  if (called.empty()) return {};
  Array& time = *called.front();
  const Unit* const unit = said_unit(contents, time);
  for (const Array* other : called) {
    if (other == &time || other->obstacle || time.obstacle || size_of(*other) != size_of(time)) continue;
    if (const std::string differs = difference(contents, time, unit, *other); !differs.empty()) {
      return bad_data(fmt::format("'{}' and '{}' could both be the time: {}", time.name, other->name, differs),
                      fmt::format("select one, as in --channels \"time={}\" or \"time={}\"", time.name, other->name));
    }
  }
  const bool by_size =
      unit != nullptr && time.unit.empty() && parse_column_name(name_in(contents, time)).unit == nullptr;
  contents.notes.push_back(
      fmt::format("'{}' was read as the time{}", time.name,
                  by_size ? fmt::format(", in {} since 1970 because its values are large", unit->name) : ""));
  if (unit != nullptr) time.unit = unit->name;
  time.means = "time";
  return {};
}

std::vector<const Array*> possible_times(const Contents& contents) {
  using namespace time_names;  // NOLINT(google-build-using-namespace): of this file
  std::vector<const Array*> possible;
  for (const Array& array : contents.arrays) {
    if (size_of(array) > 2 && speaks_of_time(name_in(contents, array)) && run_of(array).step > 0.0) {
      possible.push_back(&array);
    }
  }
  return possible;
}

std::vector<std::string> other_times(const Contents& contents, const Array& time, const Unit* unit) {
  using namespace time_names;  // NOLINT(google-build-using-namespace): of this file
  std::vector<std::string> notes;
  for (const Array* other : possible_times(contents)) {
    if (other == &time || other->clock != time.clock || size_of(*other) != size_of(time)) continue;
    if (const std::string differs = difference(contents, time, unit, *other); !differs.empty()) {
      notes.push_back(
          fmt::format("time is '{}'; {} (use --channels \"time={}\" to select that)", time.name, differs, other->name));
    }
  }
  return notes;
}

}  // namespace mbk::recording
