#include "mbk/files/recording/channel_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "mbk/files/recording/channel_table.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kExample =
    "write CHANNEL=[-]SOURCE[*GAIN][+OFFSET][:UNIT], as in --channels x=2:mm,y=3,Fx=-10,Fy=v*8.1-0.5";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The number that begins `text`, "12", ".5" or "-1e-3", and the text after it; nothing if none begins there.
std::optional<std::pair<double, std::string_view>> leading_number(std::string_view text) {
  const std::string_view digits = text.substr(text.starts_with('-') ? 1 : 0);
  if (digits.empty() || std::string_view("0123456789.").find(digits.front()) == digits.npos) return std::nullopt;
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return std::pair(value, trimmed(text.substr(static_cast<std::size_t>(stop - text.data()))));
}

/// The value of "+1.5" or "-1.5" and nothing more.
std::optional<double> signed_number(std::string_view text) {
  if (text.empty() || (text.front() != '+' && text.front() != '-')) return std::nullopt;
  const auto number = leading_number(trimmed(text.substr(1)));
  if (!number || !number->second.empty() || std::signbit(number->first)) return std::nullopt;
  return text.front() == '-' ? -number->first : number->first;
}

Result<ChannelSource> parse_entry(std::string_view entry) {
  const auto equals = entry.find('=');
  if (equals == entry.npos) {
    return bad_usage(fmt::format("channel entry '{}' has no '='", entry), std::string(kExample));
  }
  const std::string_view name = trimmed(entry.substr(0, equals));
  std::string_view source = trimmed(entry.substr(equals + 1));

  const auto kinds = kinds_called(name);
  if (kinds.empty()) {
    return bad_usage(fmt::format("unknown channel '{}'", name),
                     fmt::format("did you mean '{}'?", nearest_channel_name(name)));
  }
  ChannelSource result;
  const std::string emg = kinds.front()->name == "emg" ? emg_channel(name) : "";
  result.channel = !emg.empty() ? emg : kinds.size() == 1 ? kinds.front()->name : kinds.front()->alias;

  if (source.starts_with('-')) {
    result.negate = true;
    source = trimmed(source.substr(1));
  }
  // Text other than a unit may belong to a name, as in "Arm:Hand.x"; `assemble` knows the names.
  if (const auto colon = source.rfind(':'); colon != source.npos && find_unit(trimmed(source.substr(colon + 1)))) {
    result.unit = trimmed(source.substr(colon + 1));
    source = trimmed(source.substr(0, colon));
    const Unit& unit = *find_unit(result.unit);
    if (std::ranges::none_of(kinds, [&](const ChannelKind* kind) { return kind->accepts(unit); })) {
      std::vector<Dimension> possible;
      for (const ChannelKind* kind : kinds)
        possible.insert(possible.end(), kind->measures.begin(), kind->measures.end());
      return bad_data(fmt::format("channel {} cannot have the unit {}", name, result.unit),
                      fmt::format("use one of {}", unit_names(possible)));
    }
  }
  if (source.empty()) {
    return bad_usage(fmt::format("channel entry '{}' has no source", entry), std::string(kExample));
  }
  result.source = source;
  return result;
}

/// The length of the brackets that begin a text, in which commas part no entries; 0 where none do.
std::size_t brackets_ahead(std::string_view text) {
  if (text.front() != '[' && text.front() != '(') return 0;
  const auto end = text.find(text.front() == '[' ? ']' : ')');
  return end == text.npos || text.substr(0, end).find('=') != text.npos ? 0 : end + 1;
}

}  // namespace

std::vector<SourceReading> readings(std::string_view source) {
  std::vector<SourceReading> ways{{source}};
  const auto add = [&](std::string_view name, double gain, double offset) {
    name = trimmed(name);
    if (!name.empty()) ways.push_back({name, gain, offset});
  };
  for (std::size_t i = 1; i < source.size(); ++i) {
    if (const auto offset = signed_number(source.substr(i))) {
      add(source.substr(0, i), 1.0, *offset);
      break;  // what follows is the exponent of this number
    }
  }
  const auto star = source.rfind('*');
  if (star == source.npos) return ways;
  const auto gain = leading_number(trimmed(source.substr(star + 1)));
  if (!gain) return ways;
  const auto offset = gain->second.empty() ? std::optional(0.0) : signed_number(gain->second);
  if (offset) add(source.substr(0, star), gain->first, *offset);
  return ways;
}

std::optional<CountedSource> counted_source(std::string_view source) {
  source = trimmed(source);
  const auto open = source.rfind('[');
  if (!source.ends_with(']') || open == source.npos) return std::nullopt;
  CountedSource counted{trimmed(source.substr(0, open))};
  const std::string_view number = trimmed(source.substr(open + 1, source.size() - open - 2));
  const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), counted.number);
  if (counted.name.empty() || error != std::errc() || stop != number.data() + number.size()) return std::nullopt;
  return counted;
}

Result<std::vector<ChannelSource>> parse_channel_map(std::string_view text) {
  std::vector<ChannelSource> map;
  for (std::size_t begin = 0; begin <= text.size();) {
    std::size_t end = begin;
    while (end < text.size() && text[end] != ',') end += std::max<std::size_t>(brackets_ahead(text.substr(end)), 1);
    auto entry = MBK_TRY(parse_entry(trimmed(text.substr(begin, end - begin))));
    if (std::ranges::find(map, entry.channel, &ChannelSource::channel) != map.end()) {
      return bad_usage(fmt::format("channel {} is named twice", entry.channel), "name each channel once");
    }
    map.push_back(std::move(entry));
    begin = end + 1;
  }
  return map;
}

}  // namespace mbk::recording
