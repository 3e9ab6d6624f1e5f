#include "mbk/files/recording/read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/files/hdf5/read_hdf5.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/assemble.h"
#include "mbk/files/recording/c3d.h"
#include "mbk/files/recording/csv.h"
#include "mbk/files/recording/hdf5_recording.h"
#include "mbk/files/recording/mat_level4.h"
#include "mbk/files/recording/mat_level5.h"
#include "mbk/files/recording/one_clock.h"
#include "mbk/files/ros/bag.h"
#include "mbk/files/ros/mcap.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kFormats = "MAT (v4 to v7.3), HDF5, CSV, C3D, MCAP and ROS 1 bags are read";

bool is_text(std::string_view bytes) {
  return std::ranges::none_of(bytes.substr(0, 65536), [](char c) {
    const auto code = static_cast<unsigned char>(c);
    return code < 0x20 && c != '\t' && c != '\n' && c != '\r';
  });
}

bool has_mat_header(std::string_view text) {
  return text.size() >= 128 && (text.substr(126, 2) == "IM" || text.substr(126, 2) == "MI");
}

Result<Contents> decode(std::shared_ptr<Buffer> file) {
  const std::span<const std::byte> bytes = file->bytes();
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (hdf5::looks_like_hdf5(bytes)) return decode_hdf5(bytes);
  if (text.starts_with("MATLAB 7.3")) {
    return bad_data("the MAT v7.3 header is not followed by HDF5 data",
                    "copy the file again from where it was recorded");
  }
  if (has_mat_header(text) || text.starts_with("MATLAB 5.0")) return decode_mat_level5(std::move(file));
  if (looks_like_mat_level4(bytes)) return decode_mat_level4(bytes);
  if (is_text(text)) return decode_csv(bytes);
  if (looks_like_c3d(bytes)) return decode_c3d(bytes);
  return bad_data("the content is of no known format", std::string(kFormats));
}

/// A file, decoded, and where it came from.
struct Decoded {
  Contents contents;
  SourceFile source;
};

/// @param whole  of which all was read
Result<std::optional<Decoded>> passed(const std::filesystem::path& file, FileInPassing& whole,
                                      Result<Contents> contents) {
  if (!contents) return tl::unexpected(contents.error());
  SourceFile source{file.string(), contents->format, whole.sha256()};
  return Decoded{std::move(*contents), std::move(source)};
}

/// A long table or a bag, read in passing; nothing where the file is something else.
Result<std::optional<Decoded>> decode_in_passing(const std::filesystem::path& file) {
  constexpr std::size_t kLong = 4 * FileInPassing::kPiece;
  auto passing = FileInPassing::open(file);
  if (!passing) return tl::unexpected(passing.error());
  if (auto ok = passing->read_on(); !ok) return tl::unexpected(ok.error());
  const std::string_view begin = passing->text();
  const auto bytes = std::as_bytes(std::span(begin));
  if (looks_like_mcap(bytes)) return passed(file, *passing, decode_mcap(*passing));
  if (looks_like_bag(bytes)) return passed(file, *passing, decode_bag(*passing));
  if (passing->size() < kLong) return std::nullopt;
  if (!is_text(begin) || begin.starts_with("MATLAB ") || has_mat_header(begin) || looks_like_mat_level4(bytes)) {
    return std::nullopt;
  }
  // A number of the usual ten digits takes less memory than its text.
  if (auto ok = check_memory(passing->size()); !ok) return tl::unexpected(ok.error());
  return passed(file, *passing, decode_csv(*passing));
}

Result<Decoded> decode_file(const std::filesystem::path& file) {
  auto passing = decode_in_passing(file);
  if (!passing) return tl::unexpected(passing.error());
  if (*passing) {
    take_annotations((*passing)->contents);
    return std::move(**passing);
  }
  auto bytes = read_file(file);
  if (!bytes) return tl::unexpected(bytes.error());
  std::string sum = sha256(bytes->bytes());
  auto contents = decode(std::make_shared<Buffer>(std::move(*bytes)));  // what needs the file no more lets it go
  if (!contents) return tl::unexpected(contents.error());
  take_annotations(*contents);
  SourceFile source{file.string(), contents->format, std::move(sum)};
  return Decoded{std::move(*contents), std::move(source)};
}

Result<Recording> assemble_file(Decoded decoded, const ReadOptions& options) {
  auto recording = assemble(std::move(decoded.contents), options);
  if (recording) recording->sources = {std::move(decoded.source)};
  return recording;
}

/// [Hz], as the file says it or as its time stamps have it.
double rate_of_array(const Contents& contents, const Array& array) {
  return array.clock >= 0 ? rate_of(contents.clocks[static_cast<std::size_t>(array.clock)]) : array.rate_hz;
}

FileContents listed(Decoded decoded) {
  FileContents listing{std::move(decoded.source), decoded.contents.table, {}, std::move(decoded.contents.notes)};
  for (const Array& array : decoded.contents.arrays) {
    StoredArray stored{array.name,
                       array.values.rows(),
                       array.values.cols(),
                       std::nan(""),
                       std::nan(""),
                       array.unit,
                       rate_of_array(decoded.contents, array)};
    for (const double value : array.values.reshaped()) {
      if (!std::isfinite(value)) continue;
      stored.minimum = std::fmin(stored.minimum, value);
      stored.maximum = std::fmax(stored.maximum, value);
    }
    listing.arrays.push_back(std::move(stored));
  }
  if (!decoded.contents.metadata.empty()) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : decoded.contents.metadata) keys.push_back(key);
    listing.notes.push_back(fmt::format("it holds metadata: {}", fmt::join(keys, ", ")));
  }
  return listing;
}

/// Decodes the file and hands it on; every failure names the file.
template <class Use>
auto with_decoded(const std::filesystem::path& file, const Use& use) -> decltype(use(Decoded{})) {
  try {
    auto decoded = decode_file(file);
    if (!decoded) return tl::unexpected(decoded.error().in(file.string()));
    auto result = use(std::move(*decoded));
    if (!result) return tl::unexpected(result.error().in(file.string()));
    return result;
  } catch (const std::bad_alloc&) {
    return bad_data("there is not enough memory to read it", "close other programs or split the recording",
                    file.string());
  }
}

}  // namespace

Result<Recording> read(const std::filesystem::path& file, const ReadOptions& options) {
  return with_decoded(file, [&](Decoded decoded) { return assemble_file(std::move(decoded), options); });
}

Result<std::vector<TrialName>> list_trials(const std::filesystem::path& /*file*/) {
  return std::vector<TrialName>();
}

Result<FileContents> list_contents(const std::filesystem::path& file) {
  return with_decoded(file, [](Decoded decoded) { return Result<FileContents>(listed(std::move(decoded))); });
}

}  // namespace mbk::recording
