#include "mbk/files/recording/read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "mbk/files/bids/read_run.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/whole_numbers.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/assemble.h"
#include "mbk/files/recording/believable_time.h"
#include "mbk/files/recording/formats.h"
#include "mbk/files/recording/one_clock.h"
#include "mbk/files/recording/open_trials.h"
#include "mbk/files/recording/slices.h"

namespace mbk::recording {

namespace {

/// The result of `use` on the file; every error names the file.
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

class RecordingFile {
 public:
  static Result<std::shared_ptr<const RecordingFile>> open(const std::filesystem::path& path) {
    auto made = std::make_shared<RecordingFile>();
    made->path_ = path;
    if (may_be_bids(path)) {
      made->trials_ = MBK_TRY(bids_trials(path));
      return made;
    }
    auto file = MBK_TRY(OpenFile::open(path));
    const auto format = MBK_TRY(format_of(file));
    made->format_ = format;
    if (format->open != nullptr) {
      made->trials_ = MBK_TRY(format->open(file));
    } else {
      made->file_.emplace(std::move(file));
    }
    return made;
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::vector<TrialName>& trials() const {
    static const std::vector<TrialName> kNone;
    return trials_ ? trials_->trials() : kNone;
  }

  void rest() const {
    const std::scoped_lock lock(reading_);
    if (file_) file_->rest();
  }

  /// @param needs_arm  an arm must be selected if there are two
  [[nodiscard]] Result<Decoded> decode(const ReadOptions& options, bool needs_arm) const {
    if (!options.arm.empty() && options.arm != "right" && options.arm != "left") {
      return bad_usage(fmt::format("'{}' is not an arm", options.arm), "pass right or left");
    }
    if (trials_) return trials_->decode(path_, options, needs_arm);
    if (!options.arm.empty()) {
      return bad_usage(fmt::format("--side {}: the file does not distinguish left and right arm", options.arm),
                       "omit --side");
    }
    const std::scoped_lock lock(reading_);
    auto contents = MBK_TRY(format_->decode(*file_));
    take_annotations(contents);
    SourceFile source{path_.string(), contents.format, file_->sha256(), options.trial};
    return Decoded{std::move(contents), std::move(source)};
  }

 private:
  std::filesystem::path path_;
  const FileFormat* format_ = nullptr;
  std::shared_ptr<const OpenTrials> trials_;  ///< of a file or folder of several
  mutable std::optional<OpenFile> file_;      ///< of one that holds one
  mutable std::mutex reading_;                ///< of `file_`
};

namespace {

Result<Recording> assemble_file(Decoded decoded, const ReadOptions& options) {
  auto recording = assemble(std::move(decoded.contents), options);
  if (recording) recording->sources = {std::move(decoded.source)};
  return recording;
}

/// [Hz], as the file says it or as its time stamps have it.
double rate_of_array(const Contents& contents, const Array& array) {
  return array.clock >= 0 ? rate_of(contents.clocks[static_cast<std::size_t>(array.clock)]) : array.rate_hz;
}

void note_rounded(Contents& contents) {
  for (std::size_t k = 0; k < contents.arrays.size(); ++k) {
    const Array& array = contents.arrays[k];
    if (array.rests.empty()) continue;
    contents.notes.push_back(rounded_note(array.name.empty() ? std::to_string(k + 1) : array.name));
  }
}

FileContents listed(Decoded decoded) {
  note_rounded(decoded.contents);
  FileContents listing{std::move(decoded.source), decoded.contents.table, {}, std::move(decoded.contents.notes)};
  for (const Array& array : decoded.contents.arrays) {
    StoredArray stored{array.name,
                       array.values.rows(),
                       array.values.cols(),
                       std::nan(""),
                       std::nan(""),
                       array.unit,
                       rate_of_array(decoded.contents, array),
                       array.shape};
    if (array.is_block()) {
      stored.rows = static_cast<Index>(array.shape.front());
      stored.columns = stored.rows > 0 ? array.values.size() / stored.rows : 0;
    }
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
    listing.notes.push_back(fmt::format("the file contains metadata: {}", fmt::join(keys, ", ")));
  }
  return listing;
}

}  // namespace

Result<std::shared_ptr<const RecordingFile>> open(const std::filesystem::path& file) {
  return with_file(file, [&] { return RecordingFile::open(file); });
}

const std::vector<TrialName>& trials_of(const RecordingFile& file) {
  return file.trials();
}

std::vector<TrialName> trials_of(const RecordingFile& file, const ReadOptions& options) {
  const bool slices = std::ranges::any_of(options.channels, [](const ChannelSource& one) {
    return std::ranges::any_of(readings(one.source), [](const SourceReading& way) {
      return sliced_source(way.name.substr(0, way.name.rfind('@'))).has_value();
    });
  });
  if (!file.trials().empty() || !slices) return file.trials();
  const auto decoded = file.decode(options, false);  // errors are reported on reading
  return decoded ? trials_of_map(decoded->contents, options.channels) : std::vector<TrialName>();
}

void rest(const RecordingFile& file) {
  file.rest();
}

Result<Recording> read(const RecordingFile& file, const ReadOptions& options) {
  const std::string place =
      options.trial.empty() ? file.path().string() : fmt::format("{}, trial {}", file.path().string(), options.trial);
  return with_file(place, [&]() -> Result<Recording> {
    auto decoded = MBK_TRY(file.decode(options, leaves_names(options)));
    return assemble_file(std::move(decoded), options);
  });
}

Result<Recording> read(const std::filesystem::path& file, const ReadOptions& options) {
  const auto opened = MBK_TRY(open(file));
  return read(*opened, options);
}

Result<FileContents> list_contents(const RecordingFile& file, const ReadOptions& options) {
  return with_file(file.path(), [&]() -> Result<FileContents> {
    auto decoded = MBK_TRY(file.decode(options, false));
    return listed(std::move(decoded));
  });
}

Result<Contents> read_contents(const RecordingFile& file, const ReadOptions& options) {
  return with_file(file.path(), [&]() -> Result<Contents> {
    auto decoded = MBK_TRY(file.decode(options, false));
    Contents& contents = decoded.contents;
    note_rounded(contents);
    for (const Array& array : contents.arrays) {
      if (!array.is_block()) continue;
      contents.notes.push_back(fmt::format("'{}' is {} and was ignored because it has more than two dimensions",
                                           array.name, shape_text(array)));
    }
    std::erase_if(contents.arrays, [](const Array& array) { return array.is_block(); });
    return std::move(contents);
  });
}

}  // namespace mbk::recording
