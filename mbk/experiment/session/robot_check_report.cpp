#include "mbk/experiment/session/robot_check_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "mbk/base/core/version.h"
#include "mbk/experiment/session/machine_check.h"

namespace mbk::session {
namespace {

using drivers::BridgeReport;
using drivers::RuleFinding;
using drivers::RuleVerdict;
using OrderedJson = nlohmann::ordered_json;

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
  using Verdict = Finding::Verdict;
  std::string text;
  for (const Finding& one : findings) {
    const char* word = one.verdict == Verdict::fine ? "fine" : one.verdict == Verdict::doubtful ? "look" : "WRONG";
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

/// What was not tested, by the reason.
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
  if (untested > 0) return text + "nothing broken was seen.\n";
  return text + "it conforms.\n";
}

std::string link_text(const RobotCheckReport::Link& link) {
  std::string text = fmt::format("robot at UDP {}\n", link.address);
  for (const RuleFinding& one : link.report.findings) text += rule_text(one);
  text += untested_text(link.report);
  text += conclusion(link.report);
  text +=
      "Not seen from here: that the stop button cuts the motors' power; the senses of\n"
      "encoders, force sensor and motors ('mbk robot check FILE --live').\n";
  return text;
}

OrderedJson findings_json(const std::vector<Finding>& findings) {
  OrderedJson all = OrderedJson::array();
  for (const Finding& one : findings) {
    const char* word = one.verdict == Finding::Verdict::fine       ? "fine"
                       : one.verdict == Finding::Verdict::doubtful ? "doubtful"
                                                                   : "wrong";
    all.push_back({{"verdict", word}, {"text", one.text}});
  }
  return all;
}

template <class Value>
OrderedJson optional_json(const std::optional<Value>& value) {
  return value ? OrderedJson(*value) : OrderedJson(nullptr);
}

OrderedJson link_json(const RobotCheckReport::Link& link) {
  const BridgeReport& report = link.report;
  OrderedJson rules = OrderedJson::array();
  for (const RuleFinding& one : report.findings) {
    const auto& [rule, mend] = drivers::text_of(one.rule);
    rules.push_back(
        {{"rule", word_of(one.rule)}, {"requirement", rule}, {"verdict", word_of(one.verdict)}, {"seen", one.seen}});
    if (one.verdict == RuleVerdict::failed) rules.back()["mend"] = mend;
  }
  OrderedJson watchdogs = OrderedJson::array();
  for (const auto& [asked, found] : report.watchdogs) watchdogs.push_back({{"asked_s", asked}, {"found_s", found}});
  return {{"address", link.address},
          {"motors", link.options.motors},
          {"conforms", report.conforms()},
          {"rules", std::move(rules)},
          {"states", report.states},
          {"expected_rate_hz", link.options.rate},
          {"rate_hz", optional_json(report.rate)},
          {"median_answer_s", optional_json(report.median_answer)},
          {"longest_answer_s", optional_json(report.longest_answer)},
          {"watchdogs", std::move(watchdogs)}};
}

OrderedJson lateness_json(const realtime::Lateness& lateness) {
  OrderedJson histogram = OrderedJson::array();
  for (std::size_t i = 0; i < lateness.histogram.size(); ++i) {
    histogram.push_back({{"up_to_s", i < realtime::Lateness::kEdges.size() ? OrderedJson(realtime::Lateness::kEdges[i])
                                                                           : OrderedJson(nullptr)},
                         {"count", lateness.histogram[i]}});
  }
  return {{"rate_hz", 1.0 / lateness.period},
          {"duration_s", lateness.duration},
          {"priority", lateness.setup.fifo ? OrderedJson(lateness.priority) : OrderedJson(nullptr)},
          {"locked_memory", lateness.setup.locked_memory},
          {"wake_ups", lateness.record.count()},
          {"missed", lateness.missed},
          {"median_s", 1e-9 * lateness.record.quantile(0.5)},
          {"p99_9_s", 1e-9 * lateness.record.quantile(0.999)},
          {"longest_s", 1e-9 * static_cast<double>(lateness.record.worst())},
          {"histogram", std::move(histogram)}};
}

OrderedJson timing_json(const RobotCheckReport::Timing& timing) {
  const realtime::Machine& machine = timing.machine;
  return {{"lateness", lateness_json(timing.lateness)},
          {"machine",
           {{"kernel", machine.kernel},
            {"preempt_rt", optional_json(machine.preempt_rt)},
            {"governors", machine.governors},
            {"idle_latency_s", optional_json(machine.idle_latency)},
            {"swap_bytes", optional_json(machine.swap)},
            {"timer_slack_s", optional_json(machine.timer_slack)},
            {"virtual_machine", optional_json(machine.virtual_machine)},
            {"processor_quota", optional_json(machine.processor_quota)},
            {"clock_source", machine.clock_source},
            {"processors", machine.processors},
            {"load", optional_json(machine.load)}}},
          {"findings", findings_json(timing.findings)}};
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
  OrderedJson json{{"schema", "mbk.robot_check/1"}, {"software", fmt::format("mbk {}", version())}};
  if (report.setup) {
    json["setup"] = {{"file", report.setup->file}, {"findings", findings_json(report.setup->findings)}};
    if (report.setup->live) json["setup"]["live"] = findings_json(*report.setup->live);
  }
  if (report.link) json["link"] = link_json(*report.link);
  if (report.timing) json["timing"] = timing_json(*report.timing);
  return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace mbk::session
