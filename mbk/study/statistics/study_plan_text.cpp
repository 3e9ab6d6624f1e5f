// A plan for a terminal, and as JSON.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "mbk/present/report/text.h"
#include "mbk/study/statistics/study_plan.h"
#include "mbk/study/statistics/summary_document.h"

namespace mbk::statistics {
namespace plan_detail {

constexpr std::size_t kPlanWidth = 80;

std::string three_digits(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "∞";
}

/// "33 (28 to 42)"; the value alone where variances were stated.
std::string with_ends(const Planned& planned, const char* format) {
  const auto text = [&](double value) {
    return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : std::string("∞");
  };
  if (std::isnan(planned.value)) return "–";
  if (std::isnan(planned.interval95.first)) return text(planned.value);
  return fmt::format("{} ({} to {})", text(planned.value), text(planned.interval95.first),
                     text(planned.interval95.second));
}

std::string head_of(const Pilot& pilot, const PlanGoal& goal) {
  std::string text;
  const reliability::VarianceComponents& v = pilot.variances;
  const std::string unit = pilot.unit.empty() ? "" : " " + pilot.unit;
  if (pilot.outcome.empty()) {
    text = "stated";
  } else {
    text = fmt::format("{}{}: pilot of {} people, {} results in {} sessions", pilot.outcome,
                       pilot.conditions.empty() || pilot.conditions.front().empty()
                           ? ""
                           : ", " + fmt::format("{}", fmt::join(pilot.conditions, " and ")),
                       pilot.participants, pilot.results, pilot.sessions);
  }
  const bool no_sessions = pilot.warns_of(ReliabilityWarning::people_and_sessions);
  const bool no_trials = pilot.warns_of(ReliabilityWarning::sessions_and_trials);
  std::vector<std::string> deviations;
  const auto add = [&](const char* of, double variance) {
    deviations.push_back(fmt::format("{} {}{}", of, three_digits(std::sqrt(variance)), unit));
  };
  add(!no_sessions ? "people"
      : no_trials  ? "people, sessions and trials together"
                   : "people and sessions together",
      v.participant);
  if (!no_sessions) add(no_trials ? "sessions and trials together" : "sessions", v.session);
  if (!no_trials) add("trials", v.residual);
  text += report::wrapped(fmt::format("\nstandard deviations: {}\n", fmt::join(deviations, ", ")), kPlanWidth);
  if (goal.difference) {
    text += fmt::format("to find a difference of {:g}{} {} with power {:g} at {:g}\n", *goal.difference, unit,
                        goal.pairing == reliability::Pairing::paired ? "in the same people" : "between two groups",
                        goal.power, goal.level);
  }
  if (goal.change) {
    text += fmt::format("to detect a change of {:g}{} of one person (MDC, 95 %)\n", *goal.change, unit);
  }
  return text;
}

/// What the pilot does not separate; sentences.
std::vector<std::string> pilot_notes(const Pilot& pilot) {
  std::vector<std::string> notes;
  if (pilot.warns_of(ReliabilityWarning::sessions_and_trials)) {
    notes.emplace_back(
        "Too few sessions of the pilot have two trials or more to separate the variance between trials from that "
        "between sessions: the benefit of more trials per session is unknown, so plans have one. Measure two "
        "trials in each session to estimate it.");
  }
  if (pilot.warns_of(ReliabilityWarning::people_and_sessions)) {
    notes.emplace_back(
        "Too few people of the pilot have two sessions to separate the variance between sessions from that between "
        "people: the benefit of more sessions and the minimal detectable change are unknown, so plans have one "
        "session. Measure people in two sessions to estimate them.");
  }
  if (pilot.warns_of(ReliabilityWarning::heavy_tails)) {
    notes.emplace_back(
        "Errors of the pilot have heavier tails than normal ones: these intervals are not valid. 'mbk study summary' "
        "names the most extreme recording.");
  }
  return notes;
}

}  // namespace plan_detail

using document::Fields;

void describe(Fields<Planned>& fields) {
  fields.type("PlannedNumber", "A number with its interval from the pilot.");
  fields.add("value", &Planned::value);
  fields.add_or_null(
      "interval95",
      [](const Planned& planned) {
        return std::isnan(planned.interval95.first) ? std::nullopt : std::optional(planned.interval95);
      },
      "null if variances were stated");
}

void describe(Fields<Pilot>& fields) {
  fields.add("conditions", &Pilot::conditions);
  fields.add("participants", &Pilot::participants);
  fields.add("sessions", &Pilot::sessions);
  fields.add("results", &Pilot::results);
  fields.add(
      "draws", [](const Pilot& pilot) { return pilot.redrawn.size(); }, "pilots drawn for the intervals");
}

void describe(Fields<StudyPlan>& fields) {
  const auto known = [](const Planned& number) {
    return std::isnan(number.value) ? std::nullopt : std::optional(number);
  };
  fields.add("sessions", &StudyPlan::sessions);
  fields.add("trials", &StudyPlan::trials, "in each session");
  fields.add_or_null("mdc95", [=](const StudyPlan& plan) { return known(plan.mdc95); });
  fields.add_or_null("change_is_detectable", &StudyPlan::change_is_detectable);
  fields.add_or_null("people", [=](const StudyPlan& plan) { return known(plan.people); });
  fields.add_or_null("power", [=](const StudyPlan& plan) { return known(plan.power); });
  fields.add_or_null("simulated_power",
                     [=](const StudyPlan& plan) { return known(plan.simulated_power.value_or(Planned())); });
}

void describe(Fields<PlanGoal>& fields) {
  fields.add_or_null("difference", &PlanGoal::difference, "of two means");
  fields.add_or_null("mdc95", &PlanGoal::change, "minimal detectable change of one person");
  fields.add("pairing", &PlanGoal::pairing);
  fields.add_number("power", &PlanGoal::power);
  fields.add_number("level", &PlanGoal::level);
  fields.add_or_null("people", &PlanGoal::people, "given; null: planned");
}

namespace {

/// [unit²]; NaN where the pilot does not identify it.
struct PilotVariances {
  double participant = kNaN, session = kNaN, residual = kNaN, within = kNaN, total = kNaN;
};

PilotVariances variances_of(const Pilot& pilot) {
  const auto& [participant, session, residual] = pilot.variances;
  const bool sessions = !pilot.warns_of(ReliabilityWarning::people_and_sessions);
  const bool trials = !pilot.warns_of(ReliabilityWarning::sessions_and_trials);
  return {sessions ? participant : kNaN, sessions && trials ? session : kNaN, trials ? residual : kNaN,
          sessions ? session + residual : kNaN, participant + session + residual};
}

void describe(Fields<PilotVariances>& fields) {
  fields.add("participant", &PilotVariances::participant, "between people");
  fields.add("session", &PilotVariances::session, "between sessions");
  fields.add("residual", &PilotVariances::residual, "between trials");
  fields.add("within_participant", &PilotVariances::within, "session and residual together");
  fields.add_number("total", &PilotVariances::total, "all together");
}

struct PlannedStudy {
  const Pilot& pilot;
  const PlanGoal& goal;
  const std::vector<StudyPlan>& plans;
};

void describe(Fields<PlannedStudy>& fields) {
  using From = const PlannedStudy&;
  fields.type("StudyPlan",
              "Output of `mbk study plan --json`: numbers of people, sessions and trials that a study needs.");
  fields.header("mbk.study_plan/1");
  const auto where_measured = [](From study, const auto& value) {
    return study.pilot.outcome.empty() ? std::nullopt : std::optional(value);
  };
  fields.add_or_null(
      "outcome", [=](From study) { return where_measured(study, study.pilot.outcome); },
      "outcome of the pilot; null if variances were stated");
  fields.add("unit", [](From study) { return study.pilot.unit; });
  fields.add_or_null("pilot", [=](From study) { return where_measured(study, study.pilot); });
  fields.add(
      "variance", [](From study) { return variances_of(study.pilot); },
      "[unit²]; null: not identifiable from the pilot");
  fields.add("wanted", [](From study) { return study.goal; });
  fields.add("plans", [](From study) { return std::span(study.plans); });
  fields.add(
      "warnings", [](From study) { return study.pilot.warnings; },
      "variances that the pilot does not separate: no plan uses them; heavy-tails: intervals are not valid");
  fields.add(
      "notes", [](From study) { return plan_detail::pilot_notes(study.pilot); }, "a sentence for each warning");
}

}  // namespace

void add_plan_schema(document::Schemas& schemas) {
  schemas["study_plan"] = document::schema_of<PlannedStudy>();
}

std::string to_json(const Pilot& pilot, const PlanGoal& goal, const std::vector<StudyPlan>& plans) {
  return document::document(PlannedStudy{pilot, goal, plans});
}

std::string plan_text(const Pilot& pilot, const PlanGoal& goal, const std::vector<StudyPlan>& plans) {
  using namespace plan_detail;
  std::string text = head_of(pilot, goal);
  const bool simulated = goal.difference && goal.simulated_studies > 0;
  text += fmt::format("\n{:>8} {:>6}", "sessions", "trials");
  if (goal.difference) text += fmt::format(" {:>16} {:>20}", "people", "power");
  if (simulated) text += fmt::format(" {:>9}", "simulated");
  text += fmt::format("  MDC\n");
  for (const StudyPlan& plan : plans) {
    text += fmt::format("{:>8} {:>6}", plan.sessions, plan.trials);
    if (goal.difference) {
      text += fmt::format(" {:>16} {:>20}", with_ends(plan.people, "{:.0f}"), with_ends(plan.power, "{:.2f}"));
    }
    if (simulated) text += fmt::format(" {:>9.3f}", plan.simulated_power->value);
    text +=
        fmt::format("  {}{}\n", with_ends(plan.mdc95, "{:.3g}"), plan.change_is_detectable.value_or(false) ? " *" : "");
  }
  std::string rest;
  if (goal.difference) {
    rest += "Power of a t test. ";
    rest += goal.pairing == reliability::Pairing::paired ? "People: each measured twice like this. "
                                                         : "People: in each of the two groups. ";
  }
  rest += "Sessions per person, trials per session. ";
  if (goal.change) rest += "* the change can be detected. ";
  if (goal.change && plans.back().change_is_detectable == false) {
    rest += "None of these detects the change; more sessions help where trials no longer do. ";
  }
  if (!pilot.redrawn.empty()) {
    rest +=
        fmt::format("In parentheses: 95 % intervals due to the size of the pilot ({} pilots drawn from its variances).",
                    pilot.redrawn.size());
  }
  text += "\n" + report::wrapped(rest, kPlanWidth) + "\n";
  for (const std::string& note : pilot_notes(pilot)) text += report::wrapped("! " + note, kPlanWidth) + "\n";
  return text;
}

}  // namespace mbk::statistics
