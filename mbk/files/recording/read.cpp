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

#include "mbk/files/archive/gzip.h"
#include "mbk/files/archive/zip_archive.h"
#include "mbk/files/c3d/c3d.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/files/hdf5/read_hdf5.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/assemble.h"
#include "mbk/files/recording/csv.h"
#include "mbk/files/recording/hdf5_recording.h"
#include "mbk/files/recording/likely_format.h"
#include "mbk/files/recording/mat_level4.h"
#include "mbk/files/recording/mat_level5.h"
#include "mbk/files/recording/one_clock.h"
#include "mbk/files/recording/open_trials.h"
#include "mbk/files/ros/bag.h"
#include "mbk/files/ros/mcap.h"
#include "mbk/files/tables/npy.h"
#include "mbk/files/tables/octave_text.h"
#include "mbk/files/tables/opensim.h"
#include "mbk/files/xdf/xdf.h"

namespace mbk::recording {

namespace {

constexpr std::string_view kFormats =
    "MAT (v4 to v7.3), HDF5, CSV, C3D, XDF, MCAP, ROS 1 bags, NumPy and OpenSim files, KINARM exams and BIDS data sets "
    "are read";

bool is_text(std::string_view bytes) {
  return std::ranges::none_of(bytes.substr(0, 65536), [](char c) {
    const auto code = static_cast<unsigned char>(c);
    return code < 0x20 && c != '\t' && c != '\n' && c != '\r';
  });
}

bool has_mat_header(std::string_view text) {
  return text.size() >= 128 && (text.substr(126, 2) == "IM" || text.substr(126, 2) == "MI");
}

/// A text that is a table, but none that can be read in passing.
bool is_other_table(std::string_view text) {
  return looks_like_octave_text(text) || looks_like_trc(text) || looks_like_opensim(text);
}

Result<Contents> decode_text(std::span<const std::byte> bytes, std::string_view text) {
  if (looks_like_octave_text(text)) return decode_octave_text(bytes);
  if (looks_like_trc(text)) return decode_trc(bytes);
  if (looks_like_opensim(text)) return decode_opensim(bytes);
  return decode_csv(bytes);
}

Result<Contents> decode_zip(std::span<const std::byte> bytes) {
  const auto archive = ZipArchive::open(bytes);
  if (!archive) return tl::unexpected(archive.error());
  if (looks_like_npz(*archive)) return decode_npz(*archive);
  if (const auto likely = likely_format(bytes)) return not_read(*likely);
  return bad_data("the zip archive holds no recording", "unpack it, and name the files in it");
}

/// What is no table may be text of another kind, of which that is to be said rather than where it breaks off.
Result<Contents> table_or_likely(Result<Contents> table, std::string_view text) {
  if (table && !text.starts_with("LabVIEW Measurement")) return table;  // whose header looks like one
  const auto likely = likely_format(std::as_bytes(std::span(text)));
  return likely ? not_read(*likely) : std::move(table);
}

/// XDF is the one format that programs write packed (.xdfz, .xdf.gz).
Result<Contents> decode_gzip(std::shared_ptr<Buffer> file) {
  const auto unpacked = gunzip(file->bytes());
  if (!unpacked) return tl::unexpected(unpacked.error());
  file.reset();
  if (looks_like_xdf(unpacked->bytes())) return decode_xdf(unpacked->bytes());
  return bad_data("it is packed with gzip and holds no XDF", "unpack it first, with gzip -d");
}

Result<Contents> decode(std::shared_ptr<Buffer> file) {
  const std::span<const std::byte> bytes = file->bytes();
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (hdf5::looks_like_hdf5(bytes)) return decode_hdf5(bytes);
  if (looks_like_xdf(bytes)) return decode_xdf(bytes);
  if (looks_like_gzip(bytes)) return decode_gzip(std::move(file));
  if (text.starts_with("MATLAB 7.3")) {
    return bad_data("the MAT v7.3 header is not followed by HDF5 data",
                    "copy the file again from where it was recorded");
  }
  if (has_mat_header(text) || text.starts_with("MATLAB 5.0")) return decode_mat_level5(std::move(file));
  if (looks_like_mat_level4(bytes)) return decode_mat_level4(bytes);
  if (is_text(text) || looks_like_utf16(bytes)) return table_or_likely(decode_text(bytes, text), text);
  if (looks_like_npy(bytes)) return decode_npy(bytes);
  if (ZipArchive::looks_like_zip(bytes)) return decode_zip(bytes);
  if (const auto likely = likely_format(bytes)) return not_read(*likely);
  if (looks_like_c3d(bytes)) return decode_c3d(bytes);
  return bad_data("the content is of no known format",
                  fmt::format("{}; a program of its own (Qualisys QTM, Vicon Nexus, …) exports one of them", kFormats));
}

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
  const std::string first = begin_of(file, 64);
  const bool mcap = looks_like_mcap(std::as_bytes(std::span(first)));
  const bool bag = looks_like_bag(std::as_bytes(std::span(first)));
  if (passing->size() < kLong && !mcap && !bag) return std::nullopt;
  if (auto ok = passing->read_on(); !ok) return tl::unexpected(ok.error());
  if (mcap) return passed(file, *passing, decode_mcap(*passing));
  if (bag) return passed(file, *passing, decode_bag(*passing));
  const std::string_view begin = passing->text();
  const auto bytes = std::as_bytes(std::span(begin));
  if (!is_text(begin) || begin.starts_with("MATLAB ") || has_mat_header(begin) || looks_like_mat_level4(bytes) ||
      is_other_table(begin)) {
    return std::nullopt;
  }
  // A number of the usual ten digits takes less memory than its text.
  if (auto ok = check_memory(passing->size()); !ok) return tl::unexpected(ok.error());
  return passed(file, *passing, table_or_likely(decode_csv(*passing), begin));
}

/// @param needs_arm  an arm must be named where there are two
Result<Decoded> decode_file(const std::filesystem::path& file, const ReadOptions& options, bool needs_arm) {
  if (!options.arm.empty() && options.arm != "right" && options.arm != "left") {
    return bad_usage(fmt::format("there is no arm '{}'", options.arm), "name the right or the left one");
  }
  auto open = options.open ? Result<std::shared_ptr<const OpenTrials>>(options.open) : open_as_trials(file);
  if (!open) return tl::unexpected(open.error());
  if (*open) return (*open)->decode(file, options, needs_arm);
  if (!options.arm.empty()) {
    return bad_usage(fmt::format("--side {}: the file tells no arms apart", options.arm), "leave --side out");
  }
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

/// What `use` makes of the file; every failure names the file.
template <class Use>
auto with_file(const std::filesystem::path& file, const Use& use) -> decltype(use()) {
  try {
    auto result = use();
    if (!result) return tl::unexpected(result.error().in(file.string()));
    return result;
  } catch (const std::bad_alloc&) {
    return bad_data("there is not enough memory to read it", "close other programs or split the recording",
                    file.string());
  }
}

}  // namespace

Result<Recording> read(const std::filesystem::path& file, const ReadOptions& options) {
  const std::string place =
      options.trial.empty() ? file.string() : fmt::format("{}, trial {}", file.string(), options.trial);
  return with_file(place, [&]() -> Result<Recording> {
    const bool by_name = options.channels.empty() || !options.requested.empty();
    auto decoded = decode_file(file, options, by_name);
    if (!decoded) return tl::unexpected(decoded.error());
    return assemble_file(std::move(*decoded), options);
  });
}

Result<std::vector<TrialName>> list_trials(const std::filesystem::path& file) {
  const auto open = open_trials(file);
  if (!open) return tl::unexpected(open.error());
  return *open ? trials_of(**open) : std::vector<TrialName>();
}

Result<std::shared_ptr<const OpenTrials>> open_trials(const std::filesystem::path& file) {
  return with_file(file, [&] { return open_as_trials(file); });
}

const std::vector<TrialName>& trials_of(const OpenTrials& open) {
  return open.trials();
}

Result<FileContents> list_contents(const std::filesystem::path& file, const ReadOptions& options) {
  return with_file(file, [&]() -> Result<FileContents> {
    auto decoded = decode_file(file, options, false);
    if (!decoded) return tl::unexpected(decoded.error());
    return listed(std::move(*decoded));
  });
}

Result<Contents> read_contents(const std::filesystem::path& file, const ReadOptions& options) {
  return with_file(file, [&]() -> Result<Contents> {
    auto decoded = decode_file(file, options, false);
    if (!decoded) return tl::unexpected(decoded.error());
    return std::move(decoded->contents);
  });
}

bool nothing_is_recognised(const Error& error) {
  return error.kind == ErrorKind::data &&
         (error.message.starts_with(kNothingRecognised) || error.message.starts_with(kOnlyTimeRecognised));
}

}  // namespace mbk::recording
