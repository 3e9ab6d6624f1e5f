// A plan for a terminal, and as JSON.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "mbk/base/core/version.h"
#include "mbk/present/report/text.h"
#include "mbk/study/statistics/study_plan.h"

namespace mbk::statistics {
namespace plan_detail {

using Document = nlohmann::ordered_json;

constexpr std::size_t kPlanWidth = 80;

Document number_or_null(double value) {
  return std::isfinite(value) ? Document(value) : Document();
}

Document planned_json(const Planned& planned) {
  if (std::isnan(planned.value)) return {};
  const bool stated = std::isnan(planned.interval95.first);
  return {{"value", planned.value},
          {"interval95", stated ? Document()
                                : Document::array({number_or_null(planned.interval95.first),
                                                   number_or_null(planned.interval95.second)})}};
}

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
        "between sessions: what more trials in a session would give is not known, so plans have one. Measure two "
        "trials in each session to learn it.");
  }
  if (pilot.warns_of(ReliabilityWarning::people_and_sessions)) {
    notes.emplace_back(
        "Too few people of the pilot have two sessions to separate the variance between sessions from that between "
        "people: what more sessions would give and the minimal detectable change are not known, so plans have one "
        "session. Measure people in two sessions to learn it.");
  }
  if (pilot.warns_of(ReliabilityWarning::heavy_tails)) {
    notes.emplace_back(
        "Errors of the pilot have heavier tails than normal ones: these intervals do not hold. 'mbk study summary' "
        "names the recording that is farthest off.");
  }
  return notes;
}

}  // namespace plan_detail

std::string to_json(const Pilot& pilot, const PlanGoal& goal, const std::vector<StudyPlan>& plans) {
  using namespace plan_detail;
  Document json = {{"schema", "mbk.study_plan/1"}, {"software", fmt::format("mbk {}", version())}};
  json["outcome"] = pilot.outcome.empty() ? Document() : Document(pilot.outcome);
  json["unit"] = pilot.unit;
  json["pilot"] = pilot.outcome.empty() ? Document()
                                        : Document{{"conditions", pilot.conditions},
                                                   {"participants", pilot.participants},
                                                   {"sessions", pilot.sessions},
                                                   {"results", pilot.results},
                                                   {"draws", pilot.redrawn.size()}};
  const bool no_sessions = pilot.warns_of(ReliabilityWarning::people_and_sessions);
  const bool no_trials = pilot.warns_of(ReliabilityWarning::sessions_and_trials);
  const reliability::VarianceComponents& v = pilot.variances;
  json["variance"] = {{"participant", no_sessions ? Document() : Document(v.participant)},
                      {"session", no_sessions || no_trials ? Document() : Document(v.session)},
                      {"residual", no_trials ? Document() : Document(v.residual)},
                      {"within_participant", no_sessions ? Document() : Document(v.session + v.residual)},
                      {"total", v.participant + v.session + v.residual}};
  json["wanted"] = {{"difference", goal.difference ? Document(*goal.difference) : Document()},
                    {"mdc95", goal.change ? Document(*goal.change) : Document()},
                    {"pairing", word_of(goal.pairing)},
                    {"power", goal.power},
                    {"level", goal.level},
                    {"people", goal.people ? Document(*goal.people) : Document()}};
  json["plans"] = Document::array();
  for (const StudyPlan& plan : plans) {
    json["plans"].push_back(
        {{"sessions", plan.sessions},
         {"trials", plan.trials},
         {"mdc95", planned_json(plan.mdc95)},
         {"change_is_detectable", plan.change_is_detectable ? Document(*plan.change_is_detectable) : Document()},
         {"people", planned_json(plan.people)},
         {"power", planned_json(plan.power)},
         {"simulated_power", plan.simulated_power ? planned_json(*plan.simulated_power) : Document()}});
  }
  json["warnings"] = Document::array();
  for (const ReliabilityWarning warning : pilot.warnings) json["warnings"].push_back(word_of(warning));
  json["notes"] = pilot_notes(pilot);
  return json.dump(2, ' ', false, Document::error_handler_t::replace) + "\n";
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
    rest += "Power: of a t test. ";
    rest += goal.pairing == reliability::Pairing::paired ? "People: each measured twice like that. "
                                                         : "People: in each of the two groups. ";
  }
  rest += "Sessions and trials: of each person, trials in each session. ";
  if (goal.change) rest += "* the change can be detected. ";
  if (goal.change && plans.back().change_is_detectable == false) {
    rest += "None of these detects the change; more sessions help where trials no longer do. ";
  }
  if (!pilot.redrawn.empty()) {
    rest += fmt::format(
        "In parentheses: 95 % intervals that a pilot of this size leaves ({} pilots were drawn from its variances).",
        pilot.redrawn.size());
  }
  text += "\n" + report::wrapped(rest, kPlanWidth) + "\n";
  for (const std::string& note : pilot_notes(pilot)) text += report::wrapped("! " + note, kPlanWidth) + "\n";
  return text;
}

}  // namespace mbk::statistics
