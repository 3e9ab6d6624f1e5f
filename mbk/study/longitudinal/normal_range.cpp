#include "mbk/study/longitudinal/normal_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/study/store/study_summary.h"

namespace mbk::longitudinal {

NormalRange normal_range(const std::vector<double>& values) {
  NormalRange range{.controls = static_cast<int>(values.size())};
  if (range.controls < reliability::kMinPeople) return range;
  const auto count = static_cast<double>(values.size());
  const auto all = Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
  range.mean = all.mean();
  const double deviation = std::sqrt((all.array() - range.mean).square().sum() / (count - 1.0));
  if (!(deviation > 0.0)) return range;
  const double half =
      numeric::student_quantile(1.0 - reliability::kTail95, count - 1.0) * deviation * std::sqrt(1.0 + 1.0 / count);
  range.range95 = {range.mean - half, range.mean + half};
  return range;
}

std::string too_few_comparable(const NormalRange& normal) {
  if (normal.controls >= reliability::kMinPeople || normal.not_comparable == 0) return "";
  return fmt::format("{} of {} controls were stretched to another speed or over other positions", normal.not_comparable,
                     normal.controls + normal.not_comparable);
}

RangeVerdict verdict_of(double value, const NormalRange& normal) {
  const auto& [low, high] = normal.range95;
  if (!std::isfinite(value) || !std::isfinite(low) || !std::isfinite(high)) return RangeVerdict::unknown;
  return value < low ? RangeVerdict::below : value > high ? RangeVerdict::above : RangeVerdict::inside;
}

std::map<std::int64_t, std::map<std::int64_t, SessionResult>> session_results(const store::OutcomeColumns& columns,
                                                                              const store::OutcomeColumn& column,
                                                                              int condition) {
  std::map<std::int64_t, std::map<std::int64_t, SessionResult>> all;
  for (std::size_t k = 0; k < columns.trials.size(); ++k) {
    const store::TrialRow& trial = columns.trials[k];
    if (trial.condition != condition || !std::isfinite(column.values[k])) continue;
    SessionResult& one = all[trial.participant][trial.session];
    const double error = column.standard_errors.empty() ? kNaN : column.standard_errors[k];
    one.mean = (one.results > 0 ? one.mean : 0.0) + column.values[k];  // sums, until all are there
    one.standard_error = (one.results > 0 ? one.standard_error : 0.0) + error * error;
    one.recordings.push_back(trial.recording);
    ++one.results;
  }
  for (auto& [participant, sessions] : all) {
    for (auto& [session, one] : sessions) {
      one.mean /= one.results;
      one.standard_error = std::sqrt(one.standard_error) / one.results;
    }
  }
  return all;
}

std::map<std::int64_t, std::int64_t> last_sessions(const store::OutcomeColumns& columns, int condition) {
  std::map<std::int64_t, std::int64_t> last;
  for (const store::TrialRow& trial : columns.trials) {
    if (trial.condition == condition) last[trial.participant] = std::max(last[trial.participant], trial.session);
  }
  return last;
}

std::vector<OutcomeRange> outcome_ranges(const store::OutcomeColumns& columns, std::int64_t participant,
                                         const std::set<std::int64_t>& controls, const StretchExtents& extents) {
  std::vector<OutcomeRange> ranges;
  for (int condition = 0; condition < static_cast<int>(columns.conditions.size()); ++condition) {
    const auto last = last_sessions(columns, condition);
    const auto own = last.find(participant);
    if (own == last.end()) continue;
    for (const store::OutcomeColumn& column : columns.outcomes) {
      if (store::is_orientation(column.name)) continue;
      const auto results = session_results(columns, column, condition);
      const auto found = [&](std::int64_t person) -> const SessionResult* {
        const auto sessions = results.find(person);
        if (sessions == results.end()) return nullptr;
        const auto session = sessions->second.find(last.at(person));
        return session == sessions->second.end() ? nullptr : &session->second;
      };
      const SessionResult* const one = found(participant);
      if (one == nullptr) continue;
      OutcomeRange range{.condition = columns.conditions[static_cast<std::size_t>(condition)],
                         .outcome = column.name,
                         .unit = column.unit,
                         .session = own->second,
                         .results = one->results,
                         .value = one->mean};
      range.why_not_comparable = extents.difference(column.name, one->recordings, {});
      std::vector<double> values;
      int not_comparable = 0;
      for (const std::int64_t control : controls) {
        if (!last.contains(control)) continue;
        const SessionResult* const theirs = found(control);
        if (theirs == nullptr) {
          ++range.without;
        } else if (extents.comparable(column.name, theirs->recordings, one->recordings)) {
          values.push_back(theirs->mean);
        } else {
          ++not_comparable;
        }
      }
      range.normal = normal_range(values);
      range.normal.not_comparable = not_comparable;
      if (range.why_not_comparable.empty()) range.why_not_comparable = too_few_comparable(range.normal);
      range.verdict = verdict_of(range.value, range.normal);
      ranges.push_back(std::move(range));
    }
  }
  return ranges;
}

}  // namespace mbk::longitudinal
