#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "mbk/base/core/table_text.h"
#include "mbk/base/core/version.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/encode.h"

namespace mbk::recording {
namespace {

Result<void> append_comments(std::string& text, const Recording& recording) {
  text = fmt::format("# {}, written by mbk {}\n", kLayout, version());
  for (const auto& [key, value] : metadata_with_joints(recording)) {
    if (key.empty() || key.find_first_of(" :\t") != key.npos) {
      return bad_data(fmt::format("metadata '{}' cannot be written as a comment", key),
                      "use a name without spaces or colons");
    }
    text += fmt::format("# {}: {}\n", key, value);
  }
  for (const Event& event : recording.events) {
    text += "# event ";
    append_number(text, event.time);
    text += ' ';
    append_number(text, event.value);
    text += fmt::format(" {}\n", event.name);
  }
  return {};
}

Result<void> append_header(std::string& text, const std::vector<const Channel*>& channels) {
  text += "time_s";
  for (const Channel* const channel : channels) {
    std::string name = channel->name;
    if (!channel->unit.empty()) name += "_" + channel->unit;
    if (name.find_first_of(",;\t\" #%\n\r") != name.npos || is_formula(name)) {
      return bad_data(fmt::format("'{}' is not a valid column name", name), "use letters, digits and _");
    }
    text += ',' + name;
  }
  text += '\n';
  return {};
}

}  // namespace

void append_number(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += std::isnan(value) ? "NaN" : value > 0.0 ? "Inf" : "-Inf";
    return;
  }
  char digits[32];
  const char* const end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, static_cast<std::size_t>(end - digits));
}

Result<std::string> encode_csv(const Recording& recording) {
  std::string text;
  MBK_TRY(append_comments(text, recording));
  const std::vector<const Channel*> channels = in_order(recording.channels);
  MBK_TRY(append_header(text, channels));
  for (Index k = 0; k < recording.samples(); ++k) {
    append_number(text, recording.time[k]);
    for (const Channel* const channel : channels) {
      text += ',';
      append_number(text, channel->values[k]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace mbk::recording
