#pragma once

#include <optional>
#include <span>
#include <string>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/base/dsp/zero_phase.h"
#include "mbk/measure/preprocess/band.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/measure/preprocess/signals.h"
#include "mbk/measure/preprocess/windows.h"

namespace mbk::preprocess {

/// Filter settings and the reasons for them. Choices of the user override both plans.
struct FilterPlan {
  dsp::SavitzkyGolay smoothing;
  std::optional<Hertz> cutoff;  ///< of the zero-phase Butterworth filter of order five; none: not applied
  std::string rule;
  Index every = 1;  ///< decimation: every Nth filtered sample is used
};

/// Those of the published procedure: (6, 101) and 5 Hz, or in chapter 5 (6, 151) and 4.5 Hz.
[[nodiscard]] FilterPlan reference_filters(const Options& options);

/// mbk's own: the cutoff lies where the filter passes the top of the excited band with a gain of 0.994, and the
/// smoothing window is as long as it can be without reaching down to that.
/// @param shortest_cut [samples]; the window takes at most a quarter of it
[[nodiscard]] FilterPlan improved_filters(const Options& options, const Band& band, Hertz rate, Index shortest_cut);

/// Rows that the filters leave of a cut.   @fails the cut is shorter than the filters need; every < 1.
[[nodiscard]] Result<Index> filtered_rows(const Cut& cut, const FilterPlan& filters, Index trim,
                                          const dsp::Padding& padding);

/// One cut through both filters: [x ẋ ẍ F], each n columns, then [r̈ ṙ r] of the reference where it is wanted and what a
/// computed force's sensitivity has; row i belongs to sample cut.begin + half window + trim + i·every.
/// @param to  the columns' first numbers; each has room for `filtered_rows`
/// @fails as filtered_rows; the filter settings are invalid.
[[nodiscard]] Result<void> filter_cut(const Signals& signals, const Cut& cut, const FilterPlan& filters, Index trim,
                                      Hertz rate, const dsp::Padding& padding, bool with_reference,
                                      std::span<double* const> to);

/// Signals through both filters, sample by sample, without their derivatives: row i belongs to sample half window + i.
/// @fails  as filter_cut
[[nodiscard]] Result<Matrix> filter_values(const Matrix& signals, const FilterPlan& filters, Hertz rate,
                                           const dsp::Padding& padding);

}  // namespace mbk::preprocess
