#include "mbk/files/recording/write.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <set>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/byte_view.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/write_file.h"

namespace mbk::recording {
namespace {

struct Extension {
  std::string_view name;
  Format format;
};

constexpr auto kExtensions = std::to_array<Extension>({
    {".mat", Format::mat5},
    {".h5", Format::hdf5},
    {".hdf5", Format::hdf5},
    {".csv", Format::csv},
    {".c3d", Format::c3d},
});

Result<std::string> encode(const Recording& recording, Format format) {
  switch (format) {
    case Format::mat5:
      return encode_mat_level5(recording);
    case Format::mat73:
      return encode_mat_hdf5(recording);
    case Format::hdf5:
      return encode_hdf5(recording);
    case Format::c3d:
      return encode_c3d(recording);
    case Format::csv:
      break;
  }
  return encode_csv(recording);
}

}  // namespace

Result<void> check_writable(const Recording& recording) {
  if (recording.samples() == 0) return bad_data("a recording without samples cannot be written");
  if (recording.channels.empty()) return bad_data("a recording without channels cannot be written");
  std::set<std::string_view> names;
  for (const Channel& channel : recording.channels) {
    if (!names.insert(channel.name).second || channel.name == "time") {
      return bad_data(fmt::format("channel '{}' occurs twice", channel.name));
    }
    if (channel.values.size() == recording.samples()) continue;
    return bad_data(fmt::format("channel '{}' has {} samples, but time has {}", channel.name, channel.values.size(),
                                recording.samples()));
  }
  for (const auto& [key, value] : recording.metadata) {
    if (printable(value) == value) continue;
    return bad_data(fmt::format("metadata '{}' is not one line of UTF-8", printable(key)),
                    "write it without control characters");
  }
  for (const Event& event : recording.events) {
    if (printable(event.name) == event.name) continue;
    return bad_data(fmt::format("the event name '{}' is not one line of UTF-8", printable(event.name)),
                    "write it without control characters");
  }
  return {};
}

std::string_view text(Format format) {
  switch (format) {
    case Format::mat5:
      return "MAT v5";
    case Format::mat73:
      return "MAT v7.3";
    case Format::hdf5:
      return "HDF5";
    case Format::c3d:
      return "C3D";
    case Format::csv:
      break;
  }
  return "CSV";
}

Result<Format> format_of(const std::filesystem::path& file, std::string_view name) {
  const std::string extension = file.extension().string();
  const auto by_extension = std::ranges::find(kExtensions, extension, &Extension::name);
  if (const auto by_name = value_of<Format>(name == "mat" ? "mat5" : name)) {
    const auto kind = [](Format format) { return format == Format::mat73 ? Format::mat5 : format; };
    if (by_extension != kExtensions.end() && by_extension->format != kind(*by_name)) {
      return fail(ErrorKind::usage,
                  fmt::format("the extension {} is not that of the format {}", extension, text(*by_name)),
                  "change the file name, or omit the format", file.string());
    }
    return *by_name;
  }
  if (!name.empty()) {
    return bad_usage(fmt::format("format '{}' cannot be written", printable(std::string(name))),
                     "choose mat5, mat73, hdf5, csv or c3d");
  }
  if (by_extension != kExtensions.end()) return by_extension->format;
  return fail(ErrorKind::usage,
              extension.empty() ? "the file name has no extension that gives the format"
                                : fmt::format("format '{}' cannot be written", printable(extension)),
              "use the extension .h5, .mat, .csv or .c3d", file.string());
}

Result<Format> format_of(const std::filesystem::path& file) {
  auto format = format_of(file, "");
  if (format && *format != Format::c3d) return format;
  Error error = format ? Error{ErrorKind::usage, "C3D rounds numbers to single precision", "", file.string()}
                       : std::move(format.error());
  error.remedy = "use the extension .h5, .mat or .csv";
  if (format) error.remedy += ", then 'mbk convert'";
  return tl::unexpected(std::move(error));
}

std::vector<std::string> lost_frames(const Recording& recording, std::string_view format) {
  std::vector<std::string> lost;
  for (const Channel& channel : recording.channels) {
    const auto kind = std::ranges::find(channel_kinds(), channel.name, &ChannelKind::name);
    if (channel.frame == (kind == channel_kinds().end() ? "" : kind->frame)) continue;
    lost.push_back(
        fmt::format("the frame of {} ('{}'): {} files cannot store it", channel.name, channel.frame, format));
  }
  return lost;
}

std::vector<std::string> lost_in(const Recording& recording, Format format) {
  if (format == Format::hdf5) return {};
  std::vector<std::string> lost = lost_frames(recording, text(format));
  if (format == Format::c3d) std::ranges::move(lost_in_c3d(recording), std::back_inserter(lost));
  return lost;
}

Result<void> write(const Recording& recording, const std::filesystem::path& file, Format format, bool overwrite,
                   Readers readers) {
  if (auto ok = check_writable(recording); !ok) return tl::unexpected(ok.error().in(file.string()));
  const auto bytes = encode(recording, format);
  if (!bytes) return tl::unexpected(bytes.error().in(file.string()));
  return write_file(file, overwrite, *bytes, readers);
}

}  // namespace mbk::recording
