#include "mbk/study/longitudinal/course.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/study/reliability/axial.h"

namespace mbk::longitudinal {
namespace {

/// Among more people than that one alone changes little, and leaving each out in turn costs much.
constexpr int kMaxComparedPeople = 40;

/// Results of one person in one session, and the recordings that they are of.
struct ValuesOfSession {
  std::vector<double> values;
  std::vector<std::int64_t> recordings;
};
using SessionValues = std::map<std::int64_t, ValuesOfSession>;  ///< by session

double mean_of(const std::vector<double>& values, bool axial) {
  const auto size = static_cast<Index>(values.size());
  const Vector all = Eigen::Map<const Vector>(values.data(), size);
  if (!axial) return all.mean();
  const auto mean = reliability::axial_mean(kDegree * all);
  return mean ? mean->mean / kDegree : kNaN;
}

double difference_of(double second, double first, bool axial) {
  return axial ? reliability::axial_difference(kDegree * second, kDegree * first) / kDegree : second - first;
}

/// The results by participant and session.
std::map<std::int64_t, SessionValues> values_of(const store::OutcomeColumns& columns,
                                                const store::OutcomeColumn& column, const std::string& condition,
                                                std::optional<std::int64_t> participant) {
  std::map<std::int64_t, SessionValues> people;
  for (std::size_t k = 0; k < columns.trials.size(); ++k) {
    const store::TrialRow& trial = columns.trials[k];
    if (participant && trial.participant != *participant) continue;
    if (columns.conditions[static_cast<std::size_t>(trial.condition)] != condition) continue;
    if (!std::isfinite(column.values[k])) continue;
    ValuesOfSession& session = people[trial.participant][trial.session];
    session.values.push_back(column.values[k]);
    session.recordings.push_back(trial.recording);
  }
  return people;
}

/// Sets what may be said of a change.
void judge(Change& change, const Course& course, const DetectableChange& error) {
  if (!change.why_not_comparable.empty()) return;
  const auto results = [&](std::int64_t session) {
    return std::ranges::find(course.sessions, session, &SessionMean::session)->results;
  };
  if (error.known()) {
    change.mdc = error.between(results(change.first_session), results(change.last_session));
    change.mdc95 = {error.lower_factor * change.mdc, error.upper_factor * change.mdc};
  }
  change.heavy_tails = error.heavy_tails;
  change.verdict = verdict_of(change.difference, change.mdc, change.mdc95);
  if (change.heavy_tails && change.verdict == ChangeVerdict::beyond_error) change.verdict = ChangeVerdict::uncertain;
}

Change change_between(const SessionMean& first, const SessionMean& last, const Course& course, bool axial,
                      const DetectableChange& error, std::string why_not_comparable) {
  Change change{.first_session = first.session,
                .last_session = last.session,
                .first = first.mean,
                .last = last.mean,
                .difference = difference_of(last.mean, first.mean, axial),
                .why_not_comparable = std::move(why_not_comparable)};
  judge(change, course, error);
  return change;
}

/// The minimal detectable change by results of everyone else that are comparable with a session's.
DetectableChange without(std::int64_t participant, const store::OutcomeColumns& columns,
                         const store::OutcomeColumn& column, const std::string& condition,
                         const StretchExtents& extents, const ValuesOfSession& last) {
  store::OutcomeColumns others{{condition}, {}, {{column.name, column.unit, {}, {}}}};
  store::OutcomeColumn& kept = others.outcomes.front();
  for (std::size_t k = 0; k < columns.trials.size(); ++k) {
    store::TrialRow trial = columns.trials[k];
    if (trial.participant == participant ||
        columns.conditions[static_cast<std::size_t>(trial.condition)] != condition ||
        !extents.comparable(column.name, {trial.recording}, last.recordings)) {
      continue;
    }
    trial.condition = 0;
    others.trials.push_back(trial);
    kept.values.push_back(column.values[k]);
    if (!column.standard_errors.empty()) kept.standard_errors.push_back(column.standard_errors[k]);
  }
  const auto found = statistics::study_statistics(others, {.outcomes = {column.name}});
  if (!found || found->reliability.empty()) return {.why_unknown = "no other person has results"};
  return detectable_change(found->reliability.front());
}

Course course_of(std::int64_t participant, const SessionValues& values, const OutcomeCourses& outcome,
                 const DetectableChange& error, const StretchExtents& extents) {
  const bool axial = outcome.axial;
  Course course{.participant = participant};
  for (const auto& [session, results] : values) {
    SessionMean one{session, static_cast<int>(results.values.size()), mean_of(results.values, axial)};
    if (axial && !course.sessions.empty()) {  // the half turn that is nearer
      const double first = course.sessions.front().mean;
      one.mean = first + difference_of(one.mean, first, true);
    }
    course.sessions.push_back(one);
  }
  const auto change = [&](const SessionMean& from, const SessionMean& to) {
    return change_between(from, to, course, axial, error,
                          extents.difference(outcome.outcome, values.at(to.session).recordings,
                                             values.at(from.session).recordings, "", "before "));
  };
  const SessionMean& first = course.sessions.front();
  double sum = 0.0, variance = 0.0;
  for (const SessionMean& one : course.sessions) {
    sum += one.mean;
    variance += error.session + error.trial / one.results;
    if (&one == &first) continue;
    course.changes.push_back(change(first, one));
  }
  if (course.sessions.size() > 2) {
    course.latest = change(*(course.sessions.end() - 2), course.sessions.back());
  }
  const auto count = static_cast<double>(course.sessions.size());
  course.mean = sum / count;
  if (error.known()) {
    const double half = reliability::kPublishedNormal95 * std::sqrt(variance) / count;
    course.interval95 = {course.mean - half, course.mean + half};
  }
  return course;
}

void set_mean(OutcomeCourses& all) {
  std::vector<double> means;
  for (const Course& one : all.courses) {
    if (std::isfinite(one.mean)) means.push_back(one.mean);
  }
  if (means.empty()) return;
  all.mean = mean_of(means, all.axial);
  if (all.axial || means.size() < 2) return;
  const auto count = static_cast<double>(means.size());
  double squares = 0.0;
  for (const double one : means) squares += (one - all.mean) * (one - all.mean);
  const double half =
      numeric::student_quantile(1.0 - reliability::kTail95, count - 1.0) * std::sqrt(squares / (count - 1.0) / count);
  all.interval95 = {all.mean - half, all.mean + half};
}

}  // namespace

double DetectableChange::between(int first_results, int second_results) const {
  return reliability::kPublishedNormal95 *
         std::sqrt(2.0 * session + trial * (1.0 / first_results + 1.0 / second_results));
}

DetectableChange detectable_change(const statistics::OutcomeReliability& reliability) {
  DetectableChange error;
  const statistics::MixedReliability& model = reliability.mixed_model;
  const int people = reliability.repeated_participants;
  if (people < reliability::kMinPeople) {
    error.why_unknown = people == 0
                            ? fmt::format("nobody has two sessions, and {} people are needed", reliability::kMinPeople)
                            : fmt::format("only {} {} two sessions or more, and {} are needed", people,
                                          people == 1 ? "person has" : "people have", reliability::kMinPeople);
    return error;
  }
  const auto not_known = [&](const char* why) {
    error.why_unknown = why;
    return error;
  };
  if (reliability.axial && model.support == reliability::Support::no_variation) {
    return not_known("directions are too far apart to be compared as numbers");
  }
  if (model.support != reliability::Support::enough || model.of_trials.empty()) {
    return not_known("the variances of this study are not identifiable");
  }
  // Where sessions and trials are not separable, no mean of trials is taken to be better than one.
  const bool separable = std::isfinite(model.session);
  error.session = separable ? model.session : model.within;
  error.trial = (separable ? model.residual : 0.0) + (std::isfinite(model.known) ? model.known : 0.0);
  error.heavy_tails = std::ranges::find(reliability.warnings, statistics::ReliabilityWarning::heavy_tails) !=
                      reliability.warnings.end();
  const reliability::ModelReliability& typical = model.of_trials.back();
  error.lower_factor = typical.sem_between95.first / typical.sem_between;
  error.upper_factor = typical.sem_between95.second / typical.sem_between;
  const double sem = error.between(1, 1);
  if (!(sem > 0.0) || !std::isfinite(sem)) return not_known("nothing varies between sessions");
  if (!std::isfinite(error.lower_factor) || !(error.upper_factor >= 1.0) || !std::isfinite(error.upper_factor)) {
    return not_known("its uncertainty cannot be estimated");
  }
  return error;
}

ChangeVerdict verdict_of(double difference, double mdc, const Interval& mdc95) {
  const double size = std::abs(difference);
  if (!std::isfinite(size) || !(mdc > 0.0) || !std::isfinite(mdc95.second)) return ChangeVerdict::unknown;
  if (size > std::max(mdc, mdc95.second)) return ChangeVerdict::beyond_error;
  return size > mdc ? ChangeVerdict::uncertain : ChangeVerdict::within_error;
}

std::vector<OutcomeCourses> courses(const store::OutcomeColumns& columns, const statistics::StudyStatistics& statistics,
                                    std::optional<std::int64_t> participant, const StretchExtents& extents) {
  std::vector<OutcomeCourses> all;
  for (const statistics::OutcomeReliability& reliability : statistics.reliability) {
    const auto column = std::ranges::find(columns.outcomes, reliability.outcome, &store::OutcomeColumn::name);
    if (column == columns.outcomes.end()) continue;
    OutcomeCourses one{.condition = reliability.condition,
                       .outcome = reliability.outcome,
                       .unit = reliability.unit,
                       .axial = reliability.axial,
                       .repeated_participants = reliability.repeated_participants};
    const DetectableChange error = detectable_change(reliability);
    one.why_unknown = error.why_unknown;
    for (const auto& [number, values] : values_of(columns, *column, one.condition, participant)) {
      Course course = course_of(number, values, one, error, extents);
      const auto large = [](const Change& change) { return std::abs(change.difference) > change.mdc; };
      const bool stands_out = one.repeated_participants <= kMaxComparedPeople &&
                              (std::ranges::any_of(course.changes, large) || (course.latest && large(*course.latest)));
      const DetectableChange others =
          stands_out ? without(number, columns, *column, one.condition, extents, values.rbegin()->second)
                     : DetectableChange();
      if (stands_out && others.known()) {
        const auto again = [&](Change& change) {
          judge(change, course, others);
          change.by_others = change.why_not_comparable.empty();
        };
        std::ranges::for_each(course.changes, again);
        if (course.latest) again(*course.latest);
      }
      one.courses.push_back(std::move(course));
    }
    if (!participant) set_mean(one);
    if (!one.courses.empty()) all.push_back(std::move(one));
  }
  return all;
}

}  // namespace mbk::longitudinal
