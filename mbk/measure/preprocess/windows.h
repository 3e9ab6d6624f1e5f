#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/columns.h"
#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/measure/preprocess/trial_clock.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/protocol.h"

namespace mbk::preprocess {

/// Samples [begin, end) of the recording that are filtered as one piece, and the segments of it that count.
/// All indices are those of the recording.
struct Cut {
  Index begin = 0, end = 0;
  std::vector<Segment> keep;
};

/// The analysed interval, and why.
struct WindowPlan {
  std::vector<Cut> cuts;
  std::string rule;               ///< in words
  std::optional<double> split_s;  ///< start of the held-out data
  Index trim = 0;                 ///< samples unused at each end of a cut in the published procedure
  std::vector<Segment> excluded;  ///< excluded from the cuts, in order; not used
};

/// The protocol that a reference signal shows, and the reason.
struct ProtocolFinding {
  Protocol protocol;
  std::string rule;
};

/// Underdamped if the reference is piecewise constant (it changes at fewer than 2 % of the samples), sinusoidal if it
/// varies continuously, free if there is none or it is constant.
/// @param reference N×n, or empty
[[nodiscard]] ProtocolFinding detect_protocol(const Columns& reference);

/// The published windows (Dyck 2013, appendix C): sinusoidal [11999, 62000) with 40,000 samples to identify;
/// underdamped from 15999, the segments in which the reference is displaced, up to the ninth onset to identify; the
/// whole log is filtered before anything is cut out. Limits, where given, replace them.
/// @fails the recording is not at 1 kHz, where these numbers of samples mean something else; it ends before the window
/// begins; limits as for default_windows.
[[nodiscard]] Result<WindowPlan> reference_windows(Protocol protocol, const Columns& reference, const Clock& clock,
                                                   const WindowLimits& limits, Index half_window);

/// Windows of default mode: data outside are removed before filtering.
/// sinusoidal: from the instant at which the reference stays within the range that it keeps in its second half, to its
/// last change; underdamped: each displacement of the reference is a piece of its own, the first half of them to
/// identify; free: everything. Sinusoidal and free identify on the first 80 %.
/// @fails limits out of order or outside the recording; no displacement of the reference inside the limits.
[[nodiscard]] Result<WindowPlan> default_windows(Protocol protocol, const Columns& reference, const Clock& clock,
                                                 const WindowLimits& limits);

/// Appends the segments of a cut, as rows of its filtered signals.
/// @param first_sample  that the first of its rows belongs to   @param every  samples between rows
/// @param rows  of the cut, beginning at `first_row`
void append_segments(const Cut& cut, Index first_sample, Index every, Index first_row, Index rows,
                     std::vector<Segment>& segments);

}  // namespace mbk::preprocess
