#include "mbk/study/statistics/study_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/version.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/study/reliability/heavy_tails.h"
#include "mbk/study/statistics/outcome_rows.h"

namespace mbk::statistics {
namespace {

using reliability::Pairing;
using reliability::VarianceComponents;

/// Results of a pilot as the mixed model takes them. A person's results of one session under one condition are a
/// session of the model.
Result<reliability::Measurements> pilot_measurements(const store::OutcomeColumns& columns,
                                                     const store::OutcomeColumn& column,
                                                     const std::vector<int>& conditions) {
  std::vector<bool> keep(columns.trials.size());
  for (std::size_t k = 0; k < keep.size(); ++k) {
    keep[k] = std::ranges::find(conditions, columns.trials[k].condition) != conditions.end();
  }
  const OutcomeRows rows = rows_of(columns, column, -1, keep);
  if (!rows.trusted) {
    return bad_data("its orientations are more than 45° from their mean axis", "plan for another outcome");
  }
  reliability::Measurements m;
  const auto count = static_cast<Index>(rows.rows.size());
  const auto effects = static_cast<Index>(conditions.size());
  m.values.resize(count);
  m.fixed = Matrix::Ones(count, effects);
  m.names = {"mean", "difference"};
  m.names.resize(conditions.size());
  std::map<std::pair<std::int64_t, int>, int> sessions;
  for (Index i = 0; i < count; ++i) {
    const OutcomeRow& row = rows.rows[static_cast<std::size_t>(i)];
    const int condition = columns.trials[row.trial].condition;
    m.values[i] = row.value;
    if (effects == 2) m.fixed(i, 1) = condition == conditions[1] ? 1.0 : 0.0;
    m.participants.push_back(static_cast<int>(row.participant));
    m.sessions.push_back(sessions.emplace(std::pair(row.session, condition), std::ssize(sessions)).first->second);
  }
  return m;
}

VarianceComponents components_of(const reliability::MixedModel& model) {
  return {model.participant.value, model.session.value, model.residual.value};
}

std::vector<ReliabilityWarning> not_separated(const reliability::MixedModel& model) {
  std::vector<ReliabilityWarning> warnings;
  const bool repeated = model.sessions - model.participants >= reliability::kMinPeople;
  if (!reliability::separates_sessions_from_trials(model)) warnings.push_back(ReliabilityWarning::sessions_and_trials);
  if (!repeated) warnings.push_back(ReliabilityWarning::people_and_sessions);
  return warnings;
}

/// What is not separated, summed up in the outer one of both.
VarianceComponents merged(VarianceComponents variances, const Pilot& pilot) {
  if (pilot.warns_of(ReliabilityWarning::sessions_and_trials)) {
    variances.session += std::exchange(variances.residual, 0.0);
  }
  if (pilot.warns_of(ReliabilityWarning::people_and_sessions)) {
    variances.participant += std::exchange(variances.session, 0.0);
  }
  return variances;
}

/// Values of the same people, sessions and trials, drawn from the variances.
void redraw(reliability::Measurements& m, const VarianceComponents& variances, numeric::Random& random) {
  std::map<int, double> people;
  std::map<std::pair<int, int>, double> sessions;
  const auto drawn = [&](double variance) { return std::sqrt(variance) * random.normal(); };
  for (Index i = 0; i < m.values.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto person = people.try_emplace(m.participants[k], 0.0);
    if (person.second) person.first->second = drawn(variances.participant);
    const auto session = sessions.try_emplace({m.participants[k], m.sessions[k]}, 0.0);
    if (session.second) session.first->second = drawn(variances.session);
    m.values[i] = person.first->second + session.first->second + drawn(variances.residual);
  }
}

double error_of_mean(const VarianceComponents& variances, int sessions, int trials) {
  return (variances.session + variances.residual / trials) / sessions;
}

double planned_variance(const VarianceComponents& variances, Pairing pairing, int sessions, int trials) {
  const double error = error_of_mean(variances, sessions, trials);
  return pairing == Pairing::paired ? 2.0 * error : variances.participant + error;
}

/// V²/V* at the ends of 95 % of the V*.
template <class Function>
Interval variance_interval(const Pilot& pilot, double variance, const Function& function) {
  if (pilot.redrawn.empty()) return {kNaN, kNaN};
  Vector drawn(std::ssize(pilot.redrawn));
  for (Index i = 0; i < drawn.size(); ++i) drawn[i] = function(pilot.redrawn[static_cast<std::size_t>(i)]);
  std::sort(drawn.begin(), drawn.end());
  const auto end = [&](double p) {
    const double star = numeric::quantile(drawn, p);
    return star > 0.0 ? variance * variance / star : std::numeric_limits<double>::infinity();
  };
  return {end(1.0 - reliability::kTail95), end(reliability::kTail95)};
}

/// How many of so many studies found the difference, each drawn from the variances trial by trial.
Planned simulated(const VarianceComponents& variances, const PlanGoal& goal, const StudyPlan& plan, int people) {
  constexpr int kBlocks = 64;  // each with its own numbers, so that threads do not matter
  std::vector<int> found(kBlocks, 0);
  std::ignore = numeric::parallel_for(kBlocks, 0, [&](int block) -> Result<void> {
    numeric::Random random(goal.seed, static_cast<std::uint32_t>(block + 1));
    const auto drawn = [&](double variance) { return std::sqrt(variance) * random.normal(); };
    const auto person_mean = [&](double own) {
      double sum = 0.0;
      for (int session = 0; session < plan.sessions; ++session) {
        const double of_session = drawn(variances.session);
        for (int trial = 0; trial < plan.trials; ++trial) sum += own + of_session + drawn(variances.residual);
      }
      return sum / (double(plan.sessions) * plan.trials);
    };
    const bool paired = goal.pairing == Pairing::paired;
    Vector first(people), second(people);
    for (int study = block; study < goal.simulated_studies; study += kBlocks) {
      for (Index i = 0; i < people; ++i) {
        const double own = drawn(variances.participant);
        first[i] = person_mean(own);
        second[i] = *goal.difference + person_mean(paired ? own : drawn(variances.participant));
      }
      if (reliability::difference_p(first, second, goal.pairing) <= goal.level) ++found[std::size_t(block)];
    }
    return {};
  });
  int all = 0;
  for (const int one : found) all += one;
  constexpr double kConfidence = 0.95;
  return {double(all) / goal.simulated_studies, numeric::binomial_interval(all, goal.simulated_studies, kConfidence)};
}

Result<void> check_goal(const Pilot& pilot, const PlanGoal& goal) {
  if (!goal.difference && !goal.change) {
    return bad_usage("no target is given", "pass --difference or --mdc, in the unit of the outcome");
  }
  for (const auto& requested : {goal.difference, goal.change}) {
    if (requested && !(*requested > 0.0 && std::isfinite(*requested))) {
      return bad_usage(fmt::format("the target {:g} is not above zero", *requested), "choose one above 0");
    }
  }
  if (pilot.warns_of(ReliabilityWarning::people_and_sessions) && (goal.change || goal.pairing == Pairing::paired)) {
    return bad_data(
        "too few people of the pilot have two sessions, so the variance between sessions is "
        "unknown",
        "measure at least five people in two sessions, or state the variances with --sd-people, "
        "--sd-sessions and --sd-trials",
        pilot.outcome);
  }
  return {};
}

Result<void> plan_people(const Pilot& pilot, const PlanGoal& goal, StudyPlan& plan) {
  const auto variance_of = [&](const VarianceComponents& variances) {
    return planned_variance(variances, goal.pairing, plan.sessions, plan.trials);
  };
  const double variance = variance_of(pilot.variances);
  if (!(variance > 0.0)) return bad_usage("all variances are 0", "give those of a reliability study");
  const Interval between = variance_interval(pilot, variance, variance_of);
  const auto people_for = [&](double V) -> Result<double> {
    if (std::isnan(V)) return kNaN;
    if (std::isinf(V)) return V;
    const auto people =
        MBK_TRY(reliability::people_for_effect(*goal.difference / std::sqrt(V), goal.power, goal.pairing, goal.level));
    return double(people);
  };
  if (goal.people) {
    plan.people.value = *goal.people;
  } else {
    const auto value = MBK_TRY(people_for(variance));
    const auto low = MBK_TRY(people_for(between.first));
    const auto high = people_for(between.second);
    plan.people = {value, {low, high ? *high : std::numeric_limits<double>::infinity()}};
  }
  const int people = static_cast<int>(plan.people.value);
  const auto power_at = [&](double V) {
    if (std::isnan(V)) return kNaN;
    return std::isinf(V)
               ? goal.level
               : reliability::power_of_t_test(*goal.difference / std::sqrt(V), people, goal.pairing, goal.level);
  };
  plan.power = {power_at(variance), {power_at(between.second), power_at(between.first)}};
  if (goal.simulated_studies > 0) plan.simulated_power = simulated(pilot.variances, goal, plan, people);
  return {};
}

}  // namespace

bool Pilot::warns_of(ReliabilityWarning warning) const {
  return std::ranges::find(warnings, warning) != warnings.end();
}

Result<Pilot> pilot_of(const store::OutcomeColumns& columns, const std::string& outcome,
                       const std::vector<std::string>& conditions, int draws, std::uint64_t seed) {
  const auto column = std::ranges::find(columns.outcomes, outcome, &store::OutcomeColumn::name);
  if (column == columns.outcomes.end()) {
    return bad_usage(fmt::format("there is no outcome '{}' with usable results", printable(outcome)),
                     "'mbk study summary' lists the existing ones");
  }
  Pilot pilot;
  pilot.outcome = outcome;
  pilot.unit = column->unit;
  pilot.conditions = conditions;
  std::vector<int> places;
  for (const std::string& condition : conditions) {
    const auto found = std::ranges::find(columns.conditions, condition);
    if (found == columns.conditions.end()) {
      return bad_usage(fmt::format("there is no condition '{}' with usable results", printable(condition)),
                       "'mbk study summary' lists the existing ones");
    }
    places.push_back(static_cast<int>(found - columns.conditions.begin()));
  }
  auto m = pilot_measurements(columns, *column, places);
  if (!m) return tl::unexpected(m.error().in(outcome));
  std::vector<int> people = m->participants;
  people.erase(std::unique(people.begin(), people.end()), people.end());
  pilot.participants = static_cast<int>(people.size());
  if (pilot.participants < reliability::kMinPeople) {
    return bad_data(
        fmt::format("{} people are too few for a pilot to estimate how much people differ", pilot.participants),
        fmt::format("measure at least {}, or state the variances with --sd-people, --sd-sessions and "
                    "--sd-trials",
                    reliability::kMinPeople),
        outcome);
  }
  const auto model = reliability::fit_mixed_model(*m);
  if (!model) return tl::unexpected(model.error().in(outcome));
  if (model->rows == model->participants) {
    return bad_data("nobody has two results, so the variances of sessions and trials are unknown",
                    "measure people again, or state the variances with --sd-people, --sd-sessions and --sd-trials",
                    outcome);
  }
  pilot.sessions = model->sessions;
  pilot.results = model->rows;
  pilot.warnings = not_separated(*model);
  if (places.size() == 1) {
    const OutcomeRows rows = rows_of(columns, *column, places.front());
    if (!heavy_tails_in(rows, repeated(session_cells(rows))).empty()) {
      pilot.warnings.push_back(ReliabilityWarning::heavy_tails);
    }
  }
  const VarianceComponents fitted = components_of(*model);
  pilot.variances = merged(fitted, pilot);
  pilot.redrawn.resize(static_cast<std::size_t>(draws));
  MBK_TRY(numeric::parallel_for(draws, 0, [&](int draw) -> Result<void> {
    reliability::Measurements again = *m;
    numeric::Random random(seed, static_cast<std::uint32_t>(draw + 1));
    redraw(again, fitted, random);
    const auto refitted = reliability::fit_mixed_model(again);
    if (!refitted) return tl::unexpected(refitted.error().in(outcome));
    pilot.redrawn[static_cast<std::size_t>(draw)] = merged(components_of(*refitted), pilot);
    return {};
  }));
  return pilot;
}

Result<std::vector<StudyPlan>> study_plans(const Pilot& pilot, const PlanGoal& goal) {
  MBK_TRY(check_goal(pilot, goal));
  std::vector<StudyPlan> plans;
  constexpr double kChange = reliability::kPublishedNormal95 * std::numbers::sqrt2;
  const bool change_known = !pilot.warns_of(ReliabilityWarning::people_and_sessions);
  const int max_sessions = change_known ? goal.max_sessions : 1;
  const int max_trials = pilot.warns_of(ReliabilityWarning::sessions_and_trials) ? 1 : goal.max_trials;
  for (int sessions = 1; sessions <= max_sessions; ++sessions) {
    for (int trials = 1; trials <= max_trials; ++trials) {
      StudyPlan plan{.sessions = sessions, .trials = trials};
      const auto error = [&](const VarianceComponents& variances) {
        return error_of_mean(variances, sessions, trials);
      };
      const double of_mean = error(pilot.variances);
      const Interval between = variance_interval(pilot, of_mean, error);
      if (change_known) {
        const double mdc = kChange * std::sqrt(of_mean);
        plan.mdc95 = {mdc, reliability::widened_for_tails(
                               mdc, {kChange * std::sqrt(between.first), kChange * std::sqrt(between.second)})};
      }
      if (goal.change) plan.change_is_detectable = plan.mdc95.value <= *goal.change;
      if (goal.difference) {
        MBK_TRY(plan_people(pilot, goal, plan));
      }
      plans.push_back(plan);
    }
  }
  return plans;
}

}  // namespace mbk::statistics
