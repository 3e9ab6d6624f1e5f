#include "mbk/experiment/session/robot_check_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mbk/experiment/session/machine_check.h"

namespace mbk {

using document::Fields;
using document::through;

namespace drivers {

void describe(Fields<RuleFinding>& fields) {
  using From = const RuleFinding&;
  fields.type("RuleFinding");
  fields.add("rule", &RuleFinding::rule);
  fields.add(
      "requirement", [](From one) { return text_of(one.rule).rule; }, "the rule in words");
  fields.add("verdict", &RuleFinding::verdict);
  fields.add("seen", &RuleFinding::seen, "observation with numbers and units; the reason if not tested");
  fields.add_if([](From one) { return one.verdict == RuleVerdict::failed; }, "mend",
                [](From one) { return text_of(one.rule).mend; }, "what to do; absent unless it failed");
}

}  // namespace drivers

namespace realtime {
namespace {

struct Bin {
  std::optional<double> up_to;
  std::uint64_t count;
};

void describe(Fields<Bin>& fields) {
  fields.type("LatenessBin");
  fields.add_or_null("up_to_s", &Bin::up_to, "upper edge [s]; null: all above");
  fields.add("count", &Bin::count);
}

}  // namespace

void describe(Fields<Lateness>& fields) {
  using From = const Lateness&;
  const auto quantile = [](double share) {
    return [share](From lateness) { return 1e-9 * lateness.record.quantile(share); };
  };
  fields.type("Lateness");
  fields.add_number(
      "rate_hz", [](From lateness) { return 1.0 / lateness.period; }, "[Hz]");
  fields.add_number("duration_s", &Lateness::duration, "measured duration [s]");
  fields.add_or_null(
      "priority", [](From lateness) { return lateness.setup.fifo ? std::optional(lateness.priority) : std::nullopt; },
      "SCHED_FIFO priority; null: no real-time scheduling was granted");
  fields.add("locked_memory", through(&Lateness::setup, &ThreadSetup::locked_memory));
  fields.add("wake_ups", [](From lateness) { return lateness.record.count(); });
  fields.add("missed", &Lateness::missed, "ticks without a wake-up");
  fields.add_number("median_s", quantile(0.5), "accurate to 5 % [s]");
  fields.add_number("p99_9_s", quantile(0.999), "99.9th percentile, accurate to 5 % [s]");
  fields.add_number(
      "longest_s", [](From lateness) { return 1e-9 * static_cast<double>(lateness.record.worst()); }, "[s]");
  fields.add("histogram", [](From lateness) {
    std::vector<Bin> bins;
    for (std::size_t i = 0; i < lateness.histogram.size(); ++i) {
      const bool ends = i < Lateness::kEdges.size();
      bins.push_back({ends ? std::optional(Lateness::kEdges[i]) : std::nullopt, lateness.histogram[i]});
    }
    return bins;
  });
}

void describe(Fields<Machine>& fields) {
  fields.type("Machine", "null or empty: not reported by the system.");
  fields.add("kernel", &Machine::kernel);
  fields.add_or_null("preempt_rt", &Machine::preempt_rt);
  fields.add("governors", &Machine::governors);
  fields.add_or_null("idle_latency_s", &Machine::idle_latency, "[s]");
  fields.add_or_null("swap_bytes", &Machine::swap);
  fields.add_or_null("timer_slack_s", &Machine::timer_slack, "[s]");
  fields.add_or_null("virtual_machine", &Machine::virtual_machine);
  fields.add_or_null("processor_quota", &Machine::processor_quota,
                     "processors that the control group allows; null: no limit");
  fields.add("clock_source", &Machine::clock_source);
  fields.add("processors", &Machine::processors);
  fields.add_or_null("load", &Machine::load, "mean over one minute");
}

}  // namespace realtime

namespace session {

void describe(Fields<Finding>& fields) {
  fields.type("CheckFinding");
  fields.add("verdict", &Finding::verdict);
  fields.add("text", &Finding::text, "a sentence with numbers and units, and what to do if it is not fine");
}

namespace {

struct WatchdogFinding {
  double asked, found;
};

void describe(Fields<WatchdogFinding>& fields) {
  fields.type("WatchdogFinding");
  fields.add_number("asked_s", &WatchdogFinding::asked, "[s]");
  fields.add_number("found_s", &WatchdogFinding::found, "from the last command to the state that reports it [s]");
}

}  // namespace

void describe(Fields<RobotCheckReport::Setup>& fields) {
  using Setup = RobotCheckReport::Setup;
  fields.type("SetupCheck", "Of FILE.");
  fields.add("file", &Setup::file);
  fields.add("findings", &Setup::findings);
  fields.add("live", &Setup::live, "checks of the readings; absent without --live");
}

void describe(Fields<RobotCheckReport::Link>& fields) {
  using Link = RobotCheckReport::Link;
  using drivers::BridgeCheckOptions;
  using drivers::BridgeReport;
  fields.type("LinkCheck", "Result of --link: the rules that a robot's program must follow.");
  fields.add("address", &Link::address);
  fields.add("motors", through(&Link::options, &BridgeCheckOptions::motors),
             "whether rules that need the motors on were tested too");
  fields.add("conforms", through(&Link::report, &BridgeReport::conforms), "every rule was tested and passed");
  fields.add("rules", through(&Link::report, &BridgeReport::findings));
  fields.add("states", through(&Link::report, &BridgeReport::states), "states received and accepted");
  fields.add_number("expected_rate_hz", through(&Link::options, &BridgeCheckOptions::rate), "[Hz]");
  fields.add_or_null("rate_hz", through(&Link::report, &BridgeReport::rate), "rate of the states [Hz]");
  fields.add_or_null("median_answer_s", through(&Link::report, &BridgeReport::median_answer),
                     "delay from a command to the state that reports obeying it [s]");
  fields.add_or_null("longest_answer_s", through(&Link::report, &BridgeReport::longest_answer), "[s]");
  fields.add("watchdogs", [](const Link& link) {
    std::vector<WatchdogFinding> all;
    for (const auto& [asked, found] : link.report.watchdogs) all.push_back({asked, found});
    return all;
  });
}

void describe(Fields<RobotCheckReport::Timing>& fields) {
  using Timing = RobotCheckReport::Timing;
  fields.type("TimingCheck",
              "Result of --rt: lateness of the loop's wake-ups, and settings of the computer that may delay it.");
  fields.add("lateness", &Timing::lateness);
  fields.add("machine", &Timing::machine);
  fields.add("findings", &Timing::findings);
}

void describe(Fields<RobotCheckReport>& fields) {
  fields.type(
      "Robot check",
      "Output of `mbk robot check --json`: whether a robot's description, wiring and link are correct. Parts that "
      "were not requested are absent.");
  fields.header("mbk.robot_check/1");
  fields.add("setup", &RobotCheckReport::setup);
  fields.add("link", &RobotCheckReport::link);
  fields.add("timing", &RobotCheckReport::timing);
}

}  // namespace session
}  // namespace mbk

namespace mbk::session {
namespace {

using drivers::BridgeReport;
using drivers::RuleFinding;
using drivers::RuleVerdict;
using Verdict = Finding::Verdict;

constexpr std::size_t kColumns = 80;

/// `text` behind `head`, broken between words; further lines stand below its beginning.
std::string paragraph(const std::string& head, const std::string& text) {
  constexpr std::size_t kIndent = 8;
  std::string all, line = head + std::string(head.size() < kIndent ? kIndent - head.size() : 0, ' ');
  std::size_t used = kIndent;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    const auto width = static_cast<std::size_t>(
        std::ranges::count_if(word, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
    if (used > kIndent && used + 1 + width > kColumns) {
      all += line + "\n";
      line = std::string(kIndent, ' ');
      used = kIndent;
    }
    line += (used > kIndent ? " " : "") + word;
    used += (used > kIndent ? 1 : 0) + width;
    at = end + 1;
  }
  return all + line + "\n";
}

std::string findings_text(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& one : findings) {
    const char* word = one.verdict == Verdict::fine ? "fine" : one.verdict == Verdict::doubtful ? "note" : "WRONG";
    text += paragraph(fmt::format("  {}", word), one.text);
  }
  return text;
}

std::string rule_text(const RuleFinding& one) {
  const auto& [rule, mend] = drivers::text_of(one.rule);
  switch (one.verdict) {
    case RuleVerdict::passed:
      return paragraph("  pass", fmt::format("{}: {}", rule, one.seen));
    case RuleVerdict::failed:
      return paragraph("  FAIL", fmt::format("{}: {}", rule, one.seen)) + paragraph("", fmt::format("→ {}", mend));
    case RuleVerdict::not_tested:
      break;
  }
  return "";
}

/// Untested rules, grouped by reason.
std::string untested_text(const BridgeReport& report) {
  std::vector<std::pair<std::string, std::string>> reasons;
  for (const RuleFinding& one : report.findings) {
    if (one.verdict != RuleVerdict::not_tested) continue;
    auto found = std::ranges::find(reasons, one.seen, &std::pair<std::string, std::string>::first);
    if (found == reasons.end()) found = reasons.insert(reasons.end(), {one.seen, ""});
    found->second += fmt::format("{}{}", found->second.empty() ? "" : "; ", drivers::text_of(one.rule).rule);
  }
  std::string text;
  for (const auto& [reason, rules] : reasons) {
    text += paragraph("  -", fmt::format("not tested ({}): {}", reason, rules));
  }
  return text;
}

std::string conclusion(const BridgeReport& report) {
  const auto count = [&](RuleVerdict verdict) {
    return std::ranges::count(report.findings, verdict, &RuleFinding::verdict);
  };
  const auto failed = count(RuleVerdict::failed), untested = count(RuleVerdict::not_tested);
  std::string text = fmt::format("{} of {} rules kept, {} broken, {} not tested: ", count(RuleVerdict::passed),
                                 report.findings.size(), failed, untested);
  if (failed > 0) return text + "IT DOES NOT CONFORM.\n";
  if (untested > 0) return text + "no violation was found.\n";
  return text + "it conforms.\n";
}

std::string link_text(const RobotCheckReport::Link& link) {
  std::string text = fmt::format("robot at UDP {}\n", link.address);
  for (const RuleFinding& one : link.report.findings) text += rule_text(one);
  text += untested_text(link.report);
  text += conclusion(link.report);
  text +=
      "Not tested: that the stop button cuts the motors' power; the signs of encoders,\n"
      "force sensor and motors ('mbk robot check FILE --live').\n";
  return text;
}

bool any_wrong(const std::vector<Finding>& findings) {
  return worst(findings) == Finding::Verdict::wrong;
}

}  // namespace

bool RobotCheckReport::wrong() const {
  return (setup && (any_wrong(setup->findings) || (setup->live && any_wrong(*setup->live)))) ||
         (link && link->report.failed()) || (timing && any_wrong(timing->findings));
}

bool RobotCheckReport::incomplete() const {
  return link && !link->report.conforms();
}

std::string text_of(const RobotCheckReport& report) {
  std::string text;
  if (report.setup) {
    text += report.setup->text + findings_text(report.setup->findings);
    if (report.setup->live) text += report.setup->live_text + findings_text(*report.setup->live);
  }
  if (report.link) text += link_text(*report.link);
  if (report.timing) {
    text += lateness_text(report.timing->machine, report.timing->lateness);
    text += findings_text(report.timing->findings);
  }
  return text;
}

std::string json_of(const RobotCheckReport& report) {
  return document::document(report);
}

void add_robot_check_schema(document::Schemas& schemas) {
  schemas["robot_check"] = document::schema_of<RobotCheckReport>();
}

}  // namespace mbk::session
