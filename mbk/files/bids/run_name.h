#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// The name of a recording in a BIDS data set: "sub-07_ses-2_task-reach_tracksys-robot_run-1".
struct BidsName {
  std::vector<std::pair<std::string, std::string>> entities;  ///< in the order of the standard

  /// "07" of "sub"; "" if it is not in the name.
  [[nodiscard]] std::string_view label(std::string_view entity) const;
  /// "sub-07_ses-2_task-reach_tracksys-robot_run-1".
  [[nodiscard]] std::string text() const;
  /// "sub-07_ses-2".
  [[nodiscard]] std::string session() const;
  /// "sub-07/ses-2".
  [[nodiscard]] std::string session_folder() const;
};

/// Reads "sub-07_task-reach", with or without ses, tracksys, acq and run, in any order. The default tracking system is
/// "robot".
/// @fails  usage: participant or task is missing; an entity is unknown or named twice; a label contains other
/// characters than letters and digits, or a run other than digits.
[[nodiscard]] Result<BidsName> parse_bids_name(std::string_view text);

}  // namespace mbk::recording
