#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"
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
  /// @param needs_arm  an arm must be selected if there are two
  /// @fails  usage: options.trial or options.arm do not fit. data: as the reader of the format.
  [[nodiscard]] virtual Result<Decoded> decode(const std::filesystem::path& file, const ReadOptions& options,
                                               bool needs_arm) const = 0;
};

/// The trials of a KINARM exam.
/// @param sha256  of the file    @fails  data: it is damaged.
[[nodiscard]] Result<std::shared_ptr<const OpenTrials>> exam_trials(std::shared_ptr<const Buffer> file,
                                                                    std::string sha256);

/// The records of a file that was decoded at once; it lists no trials if there is only one.
/// @param records  at least one    @param sha256  of the file
[[nodiscard]] std::shared_ptr<const OpenTrials> decoded_trials(std::vector<NamedContents> records, std::string sha256);

/// The recordings of a BIDS data set.   @fails  data: the folder cannot be read.
[[nodiscard]] Result<std::shared_ptr<const OpenTrials>> bids_trials(const std::filesystem::path& folder);

}  // namespace mbk::recording
