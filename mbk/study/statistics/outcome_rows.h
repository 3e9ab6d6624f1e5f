#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/study/reliability/mixed_model.h"
#include "mbk/study/statistics/study_statistics.h"

/// Results of one outcome, sorted and folded. For the sources of this module only.
namespace mbk::statistics {

/// One result.
struct OutcomeRow {
  std::int64_t participant = 0, session = 0;
  double value = 0, standard_error = 0;  ///< NaN: it is not known
  std::size_t trial = 0;                 ///< its row in OutcomeColumns
};

/// The results of one outcome, by participant, session and trial.
struct OutcomeRows {
  std::vector<OutcomeRow> rows;
  bool axial = false, trusted = true;  ///< not trusted: axes lie more than 45° from their mean, and have no statistics
};

/// Of one condition, or of all (−1), of trials for which `keep` is true (empty: of all); axes are unwrapped about their
/// mean.
[[nodiscard]] OutcomeRows rows_of(const store::OutcomeColumns& columns, const store::OutcomeColumn& column,
                                  int condition, const std::vector<bool>& keep = {});

/// The mean over all results of one person in one repetition.
struct Cell {
  std::int64_t participant = 0, repetition = 0;
  double mean = 0;
  int count = 0;
};

/// One for each session of each person.
[[nodiscard]] std::vector<Cell> session_cells(const OutcomeRows& rows);

/// The people who have the repetitions that most have: as many people times further repetitions as there are, among
/// choices that leave enough people.
/// @param cells  by participant
[[nodiscard]] Repeated repeated(const std::vector<Cell>& cells);

/// Whether each result has a standard error above 0, so that they can be weighted by it.
[[nodiscard]] bool all_known(const std::vector<OutcomeRow>& rows);

[[nodiscard]] Vector as_vector(const std::vector<double>& values);

/// "1, 2, 7"; "1, 2, 3 and 9 more" where they are many.
[[nodiscard]] std::string listed(const std::vector<std::int64_t>& numbers);

/// Heavy tails of the errors between sessions or between trials, as a sentence; "" where there are none. All tests of
/// one outcome together call kTailFalseAlarms of normal errors heavy-tailed.
[[nodiscard]] std::string heavy_tails_in(const OutcomeRows& rows, const Repeated& sessions);

[[nodiscard]] OutcomeReliability reliability_of(OutcomeRows rows, OutcomeReliability named);

/// Of the results that name a rater; nothing where none does.   @param notes  what must be known beside it is added
[[nodiscard]] std::optional<RaterReliability> rater_reliability(const store::OutcomeColumns& columns,
                                                                const OutcomeRows& rows,
                                                                const std::optional<reliability::Averaged>& averaged,
                                                                std::vector<std::string>& notes);

[[nodiscard]] std::vector<MatrixSpread> matrix_spreads(const store::OutcomeColumns& columns);

[[nodiscard]] Result<Comparison> compared(const store::OutcomeColumns& columns,
                                          const std::vector<const store::OutcomeColumn*>& chosen,
                                          const StatisticsOptions& options, std::vector<std::string>& notes);

}  // namespace mbk::statistics
