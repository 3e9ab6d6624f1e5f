#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/study/store/study_list.h"

namespace mbk::longitudinal {

/// What a stored result of stretches in one direction is of.
struct StretchExtent {
  double fastest = 0;       ///< fastest speed [unit/s]
  double from = 0, to = 0;  ///< analysed positions [unit]
  std::string unit;         ///< "°" or "mm"
};

/// Speeds that differ by at most 10 % of the faster one.
[[nodiscard]] bool same_speed(double one, double other);

/// What a damaged result of stretches fails with.
[[nodiscard]] tl::unexpected<Error> damaged_stretches();

/// Extents of the results of a study, which say whether two of its numbers may be compared:
///   - `torque` and `work` are of the fastest speed and are taken over the analysed positions; `catch` moves to smaller
///     angles at higher speeds (λ* = λ − μ θ̇) and is not found beyond the positions. All three depend on both.
///   - `slope` and `rise` are regressions over all speeds, so that the fastest speed of a linear resistance cancels;
///     `threshold` is extrapolated to speed 0. They depend on the positions alone: elasticity and reflex differ along
///     them, and a threshold beyond them is not found.
///   - Other outcomes depend on neither.
/// Speeds are comparable by same_speed, positions if those that both have are at least 80 % of those of each: a result
/// over more positions is another mean, too. An outcome of stretches whose extent is unknown is not comparable.
class StretchExtents {
 public:
  /// @param direction  1: the position increases, −1: it decreases
  void set(std::int64_t recording, int direction, StretchExtent extent);

  /// Why the outcome of one set of recordings is not comparable with that of another, as a clause; "": it is, and
  /// each set within itself, too. Texts stand before the extents: "left 60 to 90°, right 60 to 120°".
  [[nodiscard]] std::string difference(const std::string& outcome, const std::vector<std::int64_t>& one,
                                       const std::vector<std::int64_t>& other, std::string_view before_one = "",
                                       std::string_view before_other = "") const;

  [[nodiscard]] bool comparable(const std::string& outcome, const std::vector<std::int64_t>& one,
                                const std::vector<std::int64_t>& other) const {
    return difference(outcome, one, other).empty();
  }

 private:
  [[nodiscard]] const StretchExtent* of(std::int64_t recording, int direction) const;

  std::map<std::int64_t, std::map<int, StretchExtent>> recordings_;
};

/// Of the usable results of a study; empty without outcomes of stretches.
/// @fails  data: a result cannot be read.
[[nodiscard]] Result<StretchExtents> stretch_extents(const store::Store& study, const store::StudyList& list,
                                                     const store::OutcomeColumns& columns);

/// The columns without numbers (NaN) that are not comparable with those of the participant's last session under the
/// same condition. Conditions and outcomes that the participant lacks, or whose recordings in that session are not
/// comparable with each other, are unchanged.
[[nodiscard]] store::OutcomeColumns comparable_columns(store::OutcomeColumns columns, const StretchExtents& extents,
                                                       std::int64_t participant);

}  // namespace mbk::longitudinal
