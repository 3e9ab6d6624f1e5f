#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "mbk/files/recording/read.h"

namespace mbk::recording {
namespace {

/// log_10.mat: stem "log_", number 10.
struct Part {
  std::filesystem::path file;
  std::string stem;
  std::uint64_t number = 0;
};

Result<Part> parse_part(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  const auto digits = name.find_last_not_of("0123456789") + 1;  // 0 where all are digits
  Part part{file, (file.parent_path() / name.substr(0, digits)).string(), 0};
  const auto [end, error] = std::from_chars(name.data() + digits, name.data() + name.size(), part.number);
  if (digits == name.size() || error != std::errc()) {
    return bad_usage(fmt::format("'{}' has no number at the end of its name", file.filename().string()),
                     "name the parts of one recording log_1.mat, log_2.mat, … or read each file separately");
  }
  return part;
}

/// The parts in the order of their numbers, without one missing.
Result<std::vector<Part>> ordered(const std::vector<std::filesystem::path>& files) {
  std::vector<Part> parts;
  for (const auto& file : files) {
    auto part = MBK_TRY(parse_part(file));
    parts.push_back(std::move(part));
  }
  std::ranges::sort(parts, {}, &Part::number);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const Part& before = parts[i - 1];
    const Part& part = parts[i];
    if (part.stem != before.stem) {
      return bad_data(
          fmt::format("'{}' and '{}' are not parts of one recording", before.file.string(), part.file.string()),
          "read the recordings separately");
    }
    if (part.number == before.number) {
      return bad_data(fmt::format("part {} is given twice", part.number), "name each part once", part.file.string());
    }
    if (part.number != before.number + 1) {
      return bad_data(fmt::format("part {} is missing between '{}' and '{}'", before.number + 1, before.file.string(),
                                  part.file.string()),
                      "add it, or read the parts before and after it separately");
    }
  }
  return parts;
}

/// The channels and units of two parts, compared; nothing where they are the same.
Result<void> check_same_channels(const Recording& first, const Recording& part) {
  const auto describe = [](const Recording& recording) {
    std::vector<std::string> names;
    for (const Channel& channel : recording.channels) {
      names.push_back(channel.unit.empty() ? channel.name : fmt::format("{} [{}]", channel.name, channel.unit));
      if (!channel.origin.joint.empty()) names.back() += fmt::format(" of '{}'", channel.origin.joint);
    }
    std::ranges::sort(names);
    return fmt::format("{}", fmt::join(names, ", "));
  };
  const std::string expected = describe(first);
  const std::string found = describe(part);
  if (expected == found) return {};
  return bad_data(fmt::format("the channels are {}, but those of the first part are {}", found, expected),
                  "select the same channels with --channels");
}

Result<void> check_time_runs_on(const Recording& before, const Recording& part) {
  const double last = before.time[before.samples() - 1];
  const double first = part.time[0];
  if (first > last) return {};
  const double interval = part.samples() > 1 ? part.time[1] - part.time[0] : 0.0;
  if (std::abs(first) <= 1.5 * std::abs(interval)) {
    return bad_data(fmt::format("time restarts at {} s after {} s in the previous part", first, last),
                    "read it separately, as its own record");
  }
  return bad_data(
      fmt::format("time is not continuous: this part begins at {} s, the previous part ends at {} s", first, last),
      "check the order of the parts, or read each separately");
}

void append(Vector& values, const Vector& more) {
  Vector joined(values.size() + more.size());
  joined << values, more;
  values = std::move(joined);
}

void append(Recording& joined, Recording&& part) {
  append(joined.time, part.time);
  for (Channel& channel : joined.channels) append(channel.values, part.find(channel.name)->values);
  joined.events.insert(joined.events.end(), part.events.begin(), part.events.end());
  for (const auto& [key, value] : part.metadata) {
    const auto [entry, added] = joined.metadata.try_emplace(key, value);
    if (added || entry->second == value) continue;
    joined.notes.push_back(
        fmt::format("metadata '{}' differs between the parts: '{}' was kept, not '{}'", key, entry->second, value));
  }
  joined.sources.insert(joined.sources.end(), part.sources.begin(), part.sources.end());
  for (std::string& note : part.notes) {
    if (std::ranges::find(joined.notes, note) == joined.notes.end()) joined.notes.push_back(std::move(note));
  }
}

/// [Hz], of recordings whose time was made from a rate.
Result<double> common_rate(const Recording& before, const Recording& part, const ReadOptions& options) {
  if (options.rate) return options.rate->value;
  const auto rate = [](const Recording& recording) {
    const Index last = recording.samples() - 1;
    return last > 0 ? static_cast<double>(last) / (recording.time[last] - recording.time[0]) : 0.0;
  };
  const double earlier = rate(before), later = rate(part);
  if (earlier == 0.0 && later == 0.0) {
    return bad_data("the parts have one sample each, so their rate is unknown", "pass the sample rate (--rate 1000)");
  }
  if (earlier > 0.0 && later > 0.0 && std::abs(earlier - later) > 1e-6 * earlier) {
    return bad_data(fmt::format("this part has {:.6g} Hz, the previous parts {:.6g} Hz", later, earlier),
                    "give only parts of one recording");
  }
  return earlier > 0.0 ? earlier : later;
}

}  // namespace

Result<Recording> read_parts(std::vector<std::filesystem::path> files, const ReadOptions& options) {
  if (files.empty()) return bad_usage("no file was given", "give the parts of the recording");
  const auto parts = MBK_TRY(ordered(files));

  auto joined = read(parts.front().file, options);
  if (!joined) return joined;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::string name = parts[i].file.string();
    auto part = MBK_TRY(read(parts[i].file, options));
    if (auto ok = check_same_channels(*joined, part); !ok) return tl::unexpected(ok.error().in(name));
    if (part.time_from_rate) {
      const auto rate = common_rate(*joined, part, options);
      if (!rate) return tl::unexpected(rate.error().in(name));
      const auto offset = static_cast<double>(joined->samples());
      const auto last = static_cast<double>(part.samples() - 1);
      part.time = Vector::LinSpaced(part.samples(), offset, offset + last) / *rate;
      for (Event& event : part.events) event.time += offset / *rate;
    }
    if (part.time_zero != 0.0 && joined->time_zero != 0.0) {
      const double later = part.time_zero - joined->time_zero;
      part.time.array() += later;
      for (Event& event : part.events) event.time += later;
    }
    if (auto ok = check_time_runs_on(*joined, part); !ok) return tl::unexpected(ok.error().in(name));
    append(*joined, std::move(part));
  }
  if (parts.size() > 1) joined->notes.push_back(fmt::format("{} parts were joined", parts.size()));
  return joined;
}

}  // namespace mbk::recording
