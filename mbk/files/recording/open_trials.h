#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {

/// A file, decoded, and where it came from.
struct Decoded {
  Contents contents;
  SourceFile source;
};

/// One class for each format that holds several records.
class OpenTrials {
 public:
  OpenTrials() = default;
  OpenTrials(const OpenTrials&) = delete;
  OpenTrials& operator=(const OpenTrials&) = delete;
  virtual ~OpenTrials() = default;

  [[nodiscard]] virtual const std::vector<TrialName>& trials() const = 0;
  /// @param needs_arm  an arm must be named where there are two
  /// @fails  usage: options.trial or options.arm do not fit. data: as the reader of the format.
  [[nodiscard]] virtual Result<Decoded> decode(const std::filesystem::path& file, const ReadOptions& options,
                                               bool needs_arm) const = 0;
};

/// The file as one that can hold several records; nullptr where it is of a format that holds one.
/// @fails  data: it is such a file, and cannot be read
[[nodiscard]] Result<std::shared_ptr<const OpenTrials>> open_as_trials(const std::filesystem::path& file);

}  // namespace mbk::recording
