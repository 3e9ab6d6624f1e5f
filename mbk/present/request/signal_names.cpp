#include "mbk/present/request/signal_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "mbk/files/recording/channel_map.h"
#include "mbk/files/recording/channel_table.h"

namespace mbk::request {

Result<void> place_signals(ReadRequest& reading, std::span<const SignalName> signals) {
  const auto mapped = MBK_TRY(reading.channels.empty() ? Result<std::vector<recording::ChannelSource>>()
                                                       : recording::parse_channel_map(reading.channels));
  const auto in_map = [&](const std::string& name) {
    const auto meant = recording::kinds_called(name);
    return std::ranges::any_of(mapped, [&](const recording::ChannelSource& entry) {
      const auto kinds = recording::kinds_called(entry.channel);
      return std::ranges::find_first_of(meant, kinds) != meant.end();
    });
  };
  for (const SignalName& signal : signals) {
    if (signal.given.empty()) continue;
    const bool flipped = signal.given.front() == '-' && signal.sign != nullptr;
    const std::string name = signal.given.substr(flipped ? 1 : 0);
    const bool by_name = mapped.empty() && !recording::kinds_called(name).empty();
    if (by_name || in_map(name)) {
      signal.to = name;
      if (flipped) *signal.sign = -1.0;
      if (by_name) reading.options.requested.push_back(name);
      if (std::string_view(signal.channel) != "output") reading.options.commands.push_back(name);
      continue;
    }
    reading.channels += fmt::format("{}{}={}", reading.channels.empty() ? "" : ",", signal.channel, signal.given);
    signal.to = signal.channel;
  }
  return {};
}

std::string shown_name(const std::string& given) {
  const auto entry = recording::parse_channel_map("input=" + given);
  if (!entry) return given;
  return (entry->front().negate ? "−" : "") + entry->front().source;
}

}  // namespace mbk::request
