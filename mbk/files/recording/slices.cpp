#include "mbk/files/recording/slices.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "mbk/base/core/trimmed.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kTrialWord = "trial";
constexpr std::uint64_t kClearlyLonger = 4;  ///< times, so that a dimension is time without being called so

/// One entry of a slice.
std::optional<Index> entry_of(std::string_view text) {
  text = mbk::trimmed(text, " \t");
  if (text == ":") return SlicedSource::kAlong;
  if (text == kTrialWord) return SlicedSource::kTrial;
  Index number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  // 0 and negative numbers are not marks: they are out of range.
  if (error != std::errc() || stop != text.data() + text.size()) return std::nullopt;
  return number >= 1 ? std::optional(number) : std::nullopt;
}

/// The entries between the brackets of a slice.
std::optional<std::vector<Index>> entries_of(std::string_view text) {
  std::vector<Index> entries;
  bool marks = false;
  while (true) {
    const std::size_t end = std::min(text.find(','), text.size());
    const auto entry = entry_of(text.substr(0, end));
    if (!entry) return std::nullopt;
    marks = marks || *entry <= 0;
    entries.push_back(*entry);
    if (end == text.size()) break;
    text.remove_prefix(end + 1);
  }
  return marks ? std::optional(std::move(entries)) : std::nullopt;
}

std::string written(const std::string& name, const std::vector<Index>& at) {
  std::vector<std::string> entries;
  for (const Index one : at) {
    entries.push_back(one == SlicedSource::kAlong   ? ":"
                      : one == SlicedSource::kTrial ? std::string(kTrialWord)
                                                    : std::to_string(one));
  }
  return fmt::format("{}[{}]", name, fmt::join(entries, ","));
}

}  // namespace

std::size_t slice_ahead(std::string_view text) {
  if (text.empty() || (text.front() != '[' && text.front() != '(')) return 0;
  const auto end = text.find(text.front() == '[' ? ']' : ')');
  return end != text.npos && entries_of(text.substr(1, end - 1)) ? end + 1 : 0;
}

std::optional<SlicedSource> sliced_source(std::string_view source) {
  source = mbk::trimmed(source, " \t");
  if (!source.ends_with(']') && !source.ends_with(')')) return std::nullopt;
  const auto open = source.rfind(source.ends_with(']') ? '[' : '(');
  if (open == source.npos || slice_ahead(source.substr(open)) != source.size() - open) return std::nullopt;
  const std::string_view name = mbk::trimmed(source.substr(0, open), " \t");
  if (name.empty()) return std::nullopt;
  return SlicedSource{name, *entries_of(source.substr(open + 1, source.size() - open - 2))};
}

std::vector<std::uint64_t> dimensions_of(const Array& array) {
  if (!array.shape.empty()) return array.shape;
  return {static_cast<std::uint64_t>(array.values.rows()), static_cast<std::uint64_t>(array.values.cols())};
}

std::string shape_text(const Array& array) {
  return fmt::format("{}", fmt::join(dimensions_of(array), "×"));
}

Result<SlicePlan> plan_of(const Array& array, const SlicedSource& source) {
  const std::vector<std::uint64_t> sides = dimensions_of(array);
  const std::string what = fmt::format("'{}' is {}", array.name, shape_text(array));
  if (source.at.size() > sides.size()) {
    return bad_data(fmt::format("{}, but {} dimensions are given", what, source.at.size()),
                    fmt::format("give {}, as in {}", sides.size(), example_slice(array, 1)));
  }
  SlicePlan plan{source.at, sides.size(), std::nullopt};
  std::vector<std::size_t> along, trials;
  for (std::size_t d = 0; d < sides.size(); ++d) {
    if (d >= plan.at.size()) {
      plan.at.push_back(sides[d] == 1 ? 1 : SlicedSource::kTrial);  // free dimensions
    }
    if (plan.at[d] == SlicedSource::kAlong) along.push_back(d);
    if (plan.at[d] == SlicedSource::kTrial) trials.push_back(d);
    if (plan.at[d] > 0 && static_cast<std::uint64_t>(plan.at[d]) > sides[d]) {
      return bad_data(fmt::format("{}: index {} does not exist in dimension {}", what, plan.at[d], d + 1),
                      "count indices from 1");
    }
  }
  if (trials.size() > 1 || along.empty() || along.size() + trials.size() > 2) {
    return bad_data(fmt::format("{}: a slice needs one ':' for time and at most one free dimension", what),
                    fmt::format("write {}", example_slice(array, 1)));
  }
  const auto unclear = [&]() {
    return bad_data(fmt::format("{}, and its time dimension is ambiguous", what),
                    fmt::format("write ':' for time and 'trial' for trials, as in {}", example_slice(array, 1)));
  };
  if (along.size() == 2) {
    const bool first_is_longer = sides[along[0]] > sides[along[1]];
    if (!first_is_longer) std::swap(along[0], along[1]);
    if (sides[along[0]] < kClearlyLonger * sides[along[1]]) return unclear();
    trials = {along[1]};
  }
  plan.along = along.front();
  if (!trials.empty()) plan.trial = trials.front();
  const bool said = std::ranges::find(source.at, SlicedSource::kTrial) != source.at.end();
  if (plan.trial && !said) {  // then nothing may be longer than time
    for (const std::uint64_t side : sides) {
      if (side >= kClearlyLonger * sides[plan.along]) return unclear();
    }
  }
  return plan;
}

Slice slice_of(const Array& array, const SlicePlan& plan, Index trial) {
  const std::vector<std::uint64_t> sides = dimensions_of(array);
  std::vector<Index> strides(sides.size());
  Index stride = 1;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const std::size_t d = array.row_major ? sides.size() - 1 - k : k;
    strides[d] = stride;
    stride *= static_cast<Index>(sides[d]);
  }
  Slice slice{0, strides[plan.along], static_cast<Index>(sides[plan.along])};
  for (std::size_t d = 0; d < sides.size(); ++d) {
    if (d == plan.along) continue;
    slice.begin += strides[d] * ((d == plan.trial ? trial : plan.at[d]) - 1);
  }
  return slice;
}

std::string example_slice(const Array& array, Index channel) {
  const std::vector<std::uint64_t> sides = dimensions_of(array);
  const auto longest = static_cast<std::size_t>(std::ranges::max_element(sides) - sides.begin());
  std::vector<Index> at(sides.size(), 1);
  at[longest] = SlicedSource::kAlong;
  if (sides.size() == 2) {
    at[1 - longest] = channel;
    return written(array.name, at);
  }
  std::size_t shortest = longest == 0 ? 1 : 0, most = shortest;
  for (std::size_t d = 0; d < sides.size(); ++d) {
    if (d == longest) continue;
    if (sides[d] < sides[shortest]) shortest = d;
    if (sides[d] >= sides[most]) most = d;
  }
  at[most] = SlicedSource::kTrial;
  at[shortest] = shortest == most ? SlicedSource::kTrial : channel;
  return written(array.name, at);
}

}  // namespace mbk::recording
