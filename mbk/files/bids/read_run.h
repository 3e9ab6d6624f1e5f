#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// The texts of one recording of a BIDS data set.
struct BidsTexts {
  std::string_view motion;            ///< …_motion.tsv: numbers without a header
  std::string_view channels;          ///< …_channels.tsv
  std::vector<std::string> sidecars;  ///< …_motion.json, the most general first: later files override earlier ones
  std::string_view events;            ///< …_events.tsv; "" if there is none
  std::string_view descriptions;      ///< …_channels.json; "" if there is none
  std::string label;                  ///< of the participant
};

/// Reads the columns of the recording under the names that channels.tsv gives them, in its units. Time stamps are those
/// of its first channel of type LATENCY; without one, the rate is the effective sampling frequency or, if missing, the
/// nominal one. "n/a" is NaN. Metadata are those that mbk wrote, or else task and label of the participant.
/// @fails  data: a text is missing or damaged; the number of columns differs from channels.tsv; a cell is not a number;
/// no sampling frequency and no time stamps.
[[nodiscard]] Result<Contents> decode_bids(const BidsTexts& texts);

/// Whether the path is a folder, or the motion.tsv of a recording.
[[nodiscard]] bool may_be_bids(const std::filesystem::path& path);

/// A recording of a data set.
struct BidsRun {
  TrialName name;
  std::filesystem::path motion;  ///< its motion.tsv
};

/// The recordings in a data set, in the folder of a participant or session, or in one motion.tsv; in the order of their
/// names, numbers by their value. The tracking system is part of a name only if names would be ambiguous without it.
/// @fails  data: the folder cannot be read.
[[nodiscard]] Result<std::vector<BidsRun>> find_bids_runs(const std::filesystem::path& path);

/// A recording that was read.
struct BidsRecording {
  Contents contents;
  std::string sha256;  ///< of its motion.tsv
};

/// Reads one of them. JSON files of parent folders also apply, as the standard specifies.
/// @fails  data: as decode_bids; a file is missing or cannot be read.
[[nodiscard]] Result<BidsRecording> read_bids_run(const std::filesystem::path& motion);

}  // namespace mbk::recording
