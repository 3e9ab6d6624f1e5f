#include "mbk/measure/analyse/channel_cure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "mbk/files/recording/channel_map.h"

namespace mbk::analyse {
namespace {

/// Entries of --channels, one after the other; no text as soon as one cannot be written.
class Map {
 public:
  void add(std::string_view alias, const ChannelOrigin& origin, bool negate, std::string_view unit, double gain) {
    if (origin.source.empty() || origin.source.find_first_of(",:") != std::string::npos) {
      possible_ = false;
      return;
    }
    std::string_view source = origin.source;
    const bool minus = source.starts_with('-');
    if (minus) source.remove_prefix(1);
    // value = ±gain·name + offset, and all of it times the gain and the sign that cure it.
    const auto read = recording::readings(source).back();
    const double total = read.gain * gain, offset = read.offset * gain * (negate ? -1.0 : 1.0);
    if (!text_.empty()) text_ += ',';
    text_ += fmt::format("{}={}{}", alias, minus != negate ? "-" : "", read.name);
    if (std::abs(total - 1.0) > 1e-12) text_ += fmt::format("*{:.12g}", total);
    if (offset != 0.0) text_ += fmt::format("{:+.12g}", offset);
    const std::string_view in = unit.empty() ? std::string_view(origin.unit) : unit;
    if (!in.empty()) text_ += fmt::format(":{}", in);
  }

  [[nodiscard]] std::optional<std::string> text() const {
    if (!possible_ || text_.empty()) return std::nullopt;
    const auto plain = [](unsigned char c) {
      return std::isalnum(c) != 0 ||
             std::string_view("_.,:=*+/@-").find(static_cast<char>(c)) != std::string_view::npos;
    };
    const bool bare = std::ranges::all_of(text_, plain);
    if (!bare && text_.find('\'') != text_.npos) return std::nullopt;
    return "--channels " + (bare ? text_ : "'" + text_ + "'");
  }

 private:
  std::string text_;
  bool possible_ = true;
};

const ChannelOrigin* origin_of(const Recording& recording, const QuantityChannels& quantity, int axes, int axis) {
  const Channel* const channel = recording.find(quantity.name(axes, axis));
  return channel == nullptr ? nullptr : &channel->origin;
}

void add_time(const Recording& recording, std::string_view unit, Map& map) {
  if (recording.time_origin.source.empty()) return;
  map.add("time", recording.time_origin, false, unit, 1.0);
}

}  // namespace

std::string name_of(const Channel& channel) {
  return channel.origin.alias.empty() ? channel.name : channel.origin.alias;
}

std::string name_of(const Recording& recording, const QuantityChannels& quantity, int axes, int axis) {
  const Channel* const channel = recording.find(quantity.name(axes, axis));
  return channel == nullptr ? std::string(quantity.name(axes, axis)) : name_of(*channel);
}

std::optional<std::string> cured_channels(const Recording& recording, int axes, const ChannelCure& cure) {
  Map map;
  add_time(recording, cure.time_unit, map);
  for (const auto& [quantity, cures] :
       {std::pair{kPositionChannels, &cure.position}, std::pair{kForceChannels, &cure.force}}) {
    for (int axis = 0; axis < axes; ++axis) {
      const AxisCure& one = (*cures)[static_cast<std::size_t>(axis)];
      const ChannelOrigin* const here = origin_of(recording, quantity, axes, axis);
      const ChannelOrigin* const from = origin_of(recording, quantity, axes, one.from);
      if (here == nullptr || from == nullptr) return std::nullopt;
      map.add(here->alias, *from, one.negate, one.unit, one.gain);
    }
  }
  for (const QuantityChannels& quantity : {kReferenceChannels, kAccelerationChannels}) {
    for (int axis = 0; axis < axes; ++axis) {
      const auto* origin = origin_of(recording, quantity, axes, axis);
      if (origin == nullptr) continue;
      const bool reference = quantity.one_axis == kReferenceChannels.one_axis;
      map.add(origin->alias, *origin, false, reference ? cure.reference_unit : "", 1.0);
    }
  }
  return map.text();
}

std::optional<std::string> channels_of_axis(const Recording& recording, int axis) {
  Map map;
  add_time(recording, "", map);
  for (const QuantityChannels& quantity : {kPositionChannels, kForceChannels, kReferenceChannels}) {
    const ChannelOrigin* const origin = origin_of(recording, quantity, 2, axis);
    if (origin == nullptr) continue;
    // A name of two axes that is read as one axis keeps the unit that its channel has.
    const std::string_view alias = quantity.one_axis == kPositionChannels.one_axis ? "x"
                                   : quantity.one_axis == kForceChannels.one_axis  ? "F"
                                                                                   : "xr";
    const std::string& unit = recording.find(quantity.name(2, axis))->unit;
    map.add(alias, *origin, false, origin->unit.empty() ? unit : "", 1.0);
  }
  const auto text = map.text();
  return text ? std::optional("--axes 1 " + *text) : std::nullopt;
}

}  // namespace mbk::analyse
