#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/preprocess/trial_clock.h"
#include "mbk/measure/preprocess/windows.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// Metadata with the exclusions of the operator: reason, and windows.
inline constexpr const char *kExcluded = "excluded", *kExcludedWindows = "excluded_windows";

/// Whether a recording may be measured and stored.
/// @fails  data, "withdrawn": the person has withdrawn.
[[nodiscard]] Result<void> check_consent(const Recording& recording);

/// A part of a recording that its operator excluded.
struct ExcludedWindow {
  double from_s = 0.0, to_s = 0.0;  ///< [s], on the clock of Recording::time, both ends included
  std::string why;
};

/// As metadata have them: "1.5-4 s: coughed; 7-9 s: spoke".
[[nodiscard]] std::string excluded_windows_text(std::span<const ExcludedWindow> windows);

/// Parses such a text. A reason may contain anything except the start of a window: "; 7-9 s: ".
/// @fails  data: it does not begin with a window; a window does not end behind its begin.
[[nodiscard]] Result<std::vector<ExcludedWindow>> parse_excluded_windows(std::string_view text);

/// Excluded windows of a recording; none if nothing was excluded.   @fails  as parse_excluded_windows
[[nodiscard]] Result<std::vector<ExcludedWindow>> excluded_windows(const Recording& recording);

/// Why the whole recording was excluded; "" if it was not.
[[nodiscard]] std::string why_excluded(const Recording& recording);

/// All exclusions in words: "excluded: coughed; 3.5 s to 5 s excluded: spoke"; "" if there are none.
[[nodiscard]] std::string exclusions_text(const Recording& recording);

/// Removes exclusions from the plan before filtering and reports them in its rule. A displacement that overlaps an
/// excluded window is removed as a whole; of a sustained perturbation, what is left beside a window counts from 2 s
/// on.
/// @param displacements  each cut is one    @param origin_s  when the first sample was taken, on the windows' clock [s]
/// @fails  data: nothing is left.
[[nodiscard]] Result<void> leave_out(std::span<const ExcludedWindow> windows, const Clock& clock, double origin_s,
                                     bool displacements, WindowPlan& plan);

/// The same recording with NaN for measured values in excluded windows; the reference is kept.
[[nodiscard]] Recording blanked(const Recording& recording, std::span<const ExcludedWindow> windows);

}  // namespace mbk::preprocess
