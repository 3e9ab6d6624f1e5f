#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/result.h"
#include "mbk/study/reliability/comparison.h"
#include "mbk/study/reliability/power.h"
#include "mbk/study/reliability/support.h"
#include "mbk/study/statistics/study_statistics.h"
#include "mbk/study/store/store_values.h"

/// How many people, sessions and trials a study takes.
namespace mbk::statistics {

/// What is wanted of a study that is to be made.
struct PlanGoal {
  std::optional<double> difference;  ///< of two means, to be found with `power` [unit]
  std::optional<double> change;      ///< minimal detectable change of one person [unit]
  reliability::Pairing pairing = reliability::Pairing::unpaired;
  double power = 0.8, level = 0.05;
  std::optional<int> people;  ///< how many there will be, in each group, or pairs; absent: as many as it takes
  int max_sessions = 1, max_trials = 10;  ///< plans up to so many, trials in each session
  int simulated_studies = 0;              ///< in which power is counted as well; 0: none
  std::uint64_t seed = 1;
};

/// Where the variances of a plan are from.
struct Pilot {
  std::string outcome, unit;            ///< "" where variances were stated
  std::vector<std::string> conditions;  ///< one, or the two whose difference is planned
  int participants = 0, sessions = 0, results = 0;
  reliability::VarianceComponents variances;
  /// Each as a study of the same people, sessions and trials gives it, drawn from `variances`: how sure they are. Empty
  /// where variances were stated.
  std::vector<reliability::VarianceComponents> redrawn;
  /// Which variances it does not separate, and whether its errors have heavy tails. Where not separated, `session`
  /// holds those of trials too, or `participant` those of sessions, and nothing is planned that needs them apart.
  std::vector<ReliabilityWarning> warnings;

  [[nodiscard]] bool warns_of(ReliabilityWarning warning) const;
};

/// Variances of one outcome by the mixed model (residual: with the trials' own errors).
/// @param conditions  one; or two: the fixed effect between them is taken out, and what people differ by in it is part
///                    of the variance between sessions
/// @param draws  how many pilots are drawn
/// @fails  usage: there is no such outcome or condition. data: fewer than kMinPeople people; nobody has two results.
[[nodiscard]] Result<Pilot> pilot_of(const store::OutcomeColumns& columns, const std::string& outcome,
                                     const std::vector<std::string>& conditions, int draws, std::uint64_t seed);

/// A number with the interval that the pilot leaves it; the interval is NaN where variances were stated.
struct Planned {
  double value = kNaN;
  reliability::Interval interval95 = {kNaN, kNaN};
};

/// One way to make the study.
struct StudyPlan {
  int sessions = 1, trials = 1;              ///< trials in each session
  Planned mdc95;                             ///< of a person's mean over them
  std::optional<bool> change_is_detectable;  ///< mdc95 ≤ what is wanted; absent where no change is
  Planned people;                            ///< in each group, or pairs; NaN where no difference is wanted
  Planned power;                             ///< with that many people, rounded up
  /// Share of simulated studies whose t test found it, with its 95 % interval (Clopper and Pearson).
  std::optional<Planned> simulated_power;
};

/// Plans of 1 … max_sessions sessions and 1 … max_trials trials. A person's mean over k sessions of m trials errs by
///   E = (σ_s² + σ_e²/m)/k;  MDC = 1.96 √2 √E;  V = σ_p² + E unpaired, V = 2E paired;  d = difference/√V
/// and people follow from the t test of d (reliability/power.h). Intervals are by the parametric bootstrap: where a
/// pilot like this gives V* for V, V lies between V²/V*(0.975) and V²/V*(0.025). Where the pilot does not separate
/// sessions from trials, plans have one trial in each session; where it does not separate people from sessions, one
/// session and no MDC.
/// @fails  usage: neither difference nor change is wanted, or one that is not above 0; as people_for_effect. data: a
///   change or a paired difference is wanted, and the pilot does not separate people from sessions.
[[nodiscard]] Result<std::vector<StudyPlan>> study_plans(const Pilot& pilot, const PlanGoal& goal);

/// Schema "mbk.study_plan/1".
[[nodiscard]] std::string to_json(const Pilot& pilot, const PlanGoal& goal, const std::vector<StudyPlan>& plans);

/// For a terminal of 80 columns.
[[nodiscard]] std::string plan_text(const Pilot& pilot, const PlanGoal& goal, const std::vector<StudyPlan>& plans);

}  // namespace mbk::statistics
