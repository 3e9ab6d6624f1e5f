#include "mbk/files/recording/annotations.h"

#include <fmt/format.h>

#include <algorithm>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/byte_view.h"
#include "mbk/files/recording/channel_table.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kMetadataPrefix = "metadata.";

template <class Named>
const Named* find(const std::vector<Named>& all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &Named::name);
  return found == all.end() ? nullptr : &*found;
}

void take_events(Contents& contents) {
  const Array* time = find(contents.arrays, "events.time");
  const Array* value = find(contents.arrays, "events.value");
  const Text* name = find(contents.texts, "events.name");
  if (time == nullptr || value == nullptr || name == nullptr) return;
  const auto count = static_cast<Index>(name->lines.size());
  const auto fits = [count](const Array& array) {
    return array.values.size() == count && std::min(array.values.rows(), array.values.cols()) == 1;
  };
  if (!fits(*time) || !fits(*value)) return;
  const Unit* const unit = find_unit(time->unit.empty() ? "s" : time->unit);
  if (unit == nullptr || unit->dimension != Dimension::time) return;
  for (Index k = 0; k < count; ++k) {
    contents.events.push_back({unit->to_si(time->values.reshaped()[k]), name->lines[static_cast<std::size_t>(k)],
                               value->values.reshaped()[k]});
  }
  std::erase_if(contents.arrays,
                [](const Array& array) { return array.name == "events.time" || array.name == "events.value"; });
  std::erase_if(contents.texts, [](const Text& text) { return text.name == "events.name"; });
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

}  // namespace

std::string several_lines_note(std::string_view key, std::size_t lines) {
  return fmt::format("metadata '{}' has {} lines; they were joined with '; '", key, lines);
}

std::string unit_key(std::string_view channel) {
  return fmt::format("unit_{}", channel);
}

std::string joint_key(std::string_view channel) {
  return fmt::format("joint_of_{}", channel);
}

bool is_matlab_name(std::string_view name) {
  const auto inner = [](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name.size() <= kLongestMatlabName && is_letter(name.front()) &&
         std::ranges::all_of(name, inner);
}

void take_annotations(Contents& contents) {
  take_events(contents);
  for (Text& text : contents.texts) {
    if (text.name.starts_with(kMetadataPrefix)) {
      const std::string key = text.name.substr(kMetadataPrefix.size());
      contents.metadata[key] = fmt::format("{}", fmt::join(text.lines, "; "));
      if (text.lines.size() > 1) contents.notes.push_back(several_lines_note(key, text.lines.size()));
    } else {
      contents.notes.push_back(fmt::format("variable '{}' is text and was ignored", text.name));
    }
  }
  contents.texts.clear();
}

std::map<std::string, std::string> metadata_with_joints(const Recording& recording) {
  std::map<std::string, std::string> metadata = recording.metadata;
  for (const Channel& channel : recording.channels) {
    if (!channel.origin.joint.empty()) metadata[joint_key(channel.name)] = channel.origin.joint;
  }
  return metadata;
}

Result<std::map<std::string, std::string>> metadata_with_units(const Recording& recording) {
  std::map<std::string, std::string> metadata = metadata_with_joints(recording);
  for (const Channel& channel : recording.channels) {
    const auto kinds = kinds_called(channel.name);
    const auto kind = std::ranges::find(kinds, channel.name, &ChannelKind::name);
    // The unit of a named joint does not go without saying.
    const bool is_default = kind != kinds.end() && (*kind)->default_unit() == channel.unit;
    if (channel.unit.empty() || (is_default && channel.origin.joint.empty())) continue;
    const auto [entry, added] = metadata.try_emplace(unit_key(channel.name), channel.unit);
    if (!added && entry->second != channel.unit) {
      return bad_data(fmt::format("metadata '{}' is '{}', but the channel is in '{}'", entry->first,
                                  printable(entry->second), channel.unit),
                      "rename that entry");
    }
  }
  return metadata;
}

Result<std::map<std::string, std::string>> metadata_to_write(const Recording& recording) {
  auto metadata = metadata_with_units(recording);
  if (!metadata) return metadata;
  for (const auto& [key, value] : *metadata) {
    if (!is_matlab_name(key)) {
      return bad_data(fmt::format("metadata '{}' cannot be the name of a MATLAB field", printable(key)),
                      fmt::format("use a letter, then letters, digits and _, at most {}", kLongestMatlabName));
    }
  }
  return metadata;
}

}  // namespace mbk::recording
