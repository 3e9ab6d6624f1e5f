// Tables of a study's outcomes for a paper.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include "mbk/base/core/counted.h"
#include "mbk/base/core/printable.h"
#include "mbk/base/core/table_text.h"
#include "mbk/base/core/version.h"
#include "mbk/study/statistics/study_statistics_text.h"

namespace mbk::statistics {
namespace summary_table {

using store::OutcomeSummary;
using store::RecordingState;
using enum PaperCell::Kind;

constexpr std::size_t kRowsOfPage = 45;

PaperCell no_number() {
  return {"–"};
}

/// Decimals that show so many significant digits of a number.
int decimals(double size, int digits) {
  if (!(std::abs(size) > 0.0) || !std::isfinite(size)) return digits;
  return std::clamp(digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(size)))), 0, 9);
}

/// ".93": APA style omits the 0 of a number that cannot exceed 1.
std::string share(double value) {
  std::string text = fmt::format("{:.2f}", value);
  if (text == "-0.00") text = "0.00";
  const std::size_t zero = text.starts_with('-') ? 1 : 0;
  if (text[zero] == '0') text.erase(zero, 1);
  return text;
}

PaperCell mean_cell(const OutcomeSummary& one) {
  if (!std::isfinite(one.standard_deviation)) return {fmt::format("{:.{}f}", one.mean, decimals(one.mean, 3)), number};
  const int count = decimals(one.standard_deviation > 0.0 ? one.standard_deviation : one.mean, 2);
  return {fmt::format("{:.{}f} ± {:.{}f}", one.mean, count, one.standard_deviation, count), number};
}

/// The symbol or the name of an outcome: K_xx → $K_{xx}$, stiffness_lambda_max → $K_{\max}$.
PaperCell name_cell(const std::string& outcome) {
  const std::size_t cut = outcome.find('_');
  const std::string head = outcome.substr(0, cut), rest = cut == std::string::npos ? "" : outcome.substr(cut + 1);
  if (head == "M" || head == "B" || head == "K") return {rest.empty() ? head : head + "_{" + rest + "}", symbol};
  if (head == "x0") return {rest.empty() ? "x_0" : "x_{0," + rest + "}", symbol};
  if (head == "VAF" || head == "RMSE") {
    return {"\\mathrm{" + head + "}" + (rest.empty() ? "" : "_{" + rest + "}"), symbol};
  }
  constexpr auto kMatrix =
      std::to_array<std::pair<std::string_view, const char*>>({{"inertia", "M"}, {"damping", "B"}, {"stiffness", "K"}});
  constexpr auto kPart =
      std::to_array<std::pair<std::string_view, const char*>>({{"lambda_max", "{}_{{\\max}}"},
                                                               {"lambda_min", "{}_{{\\min}}"},
                                                               {"lambda_mid", "{}_{{\\mathrm{{mid}}}}"},
                                                               {"symmetric_xy", "{}_{{\\mathrm{{sym}},xy}}"},
                                                               {"symmetric_xz", "{}_{{\\mathrm{{sym}},xz}}"},
                                                               {"symmetric_yz", "{}_{{\\mathrm{{sym}},yz}}"},
                                                               {"antisymmetric", "{}_{{\\mathrm{{anti}}}}"},
                                                               {"antisymmetric_x", "{}_{{\\mathrm{{anti}},x}}"},
                                                               {"antisymmetric_y", "{}_{{\\mathrm{{anti}},y}}"},
                                                               {"antisymmetric_z", "{}_{{\\mathrm{{anti}},z}}"},
                                                               {"zmean", "Z_{{\\mathrm{{mean}}}}({})"}});
  const auto* const matrix =
      std::ranges::find(kMatrix, std::string_view(head), [](const auto& one) { return one.first; });
  const auto* const part = std::ranges::find(kPart, std::string_view(rest), [](const auto& one) { return one.first; });
  if (matrix != kMatrix.end() && part != kPart.end()) {
    return {fmt::format(fmt::runtime(part->second), matrix->second), symbol};
  }
  const bool ellipse = matrix != kMatrix.end() && !rest.starts_with("ellipsoid");
  std::string words = ellipse ? head + " ellipse, " + rest : outcome;
  if (head == "min") words = "minimum_" + rest;
  std::ranges::replace(words, '_', ' ');
  if (words[0] >= 'a' && words[0] <= 'z') words[0] = static_cast<char>(words[0] - 'a' + 'A');
  return {words};
}

const OutcomeReliability* found_reliability(const StudyStatistics& statistics, const OutcomeSummary& one) {
  const auto found = std::ranges::find_if(statistics.reliability, [&](const OutcomeReliability& other) {
    return other.condition == one.condition && other.outcome == one.outcome;
  });
  return found == statistics.reliability.end() ? nullptr : &*found;
}

const Repeated* repeated_of(const StudyStatistics& statistics, const OutcomeSummary& one) {
  const OutcomeReliability* const found = found_reliability(statistics, one);
  return found != nullptr && found->between_sessions.support == Support::enough ? &found->between_sessions : nullptr;
}

/// Of one trial by one rater in one session; nullptr where there are no raters, or too few.
const reliability::Generalizability* one_rater(const OutcomeReliability* found) {
  if (found == nullptr || !found->raters || found->raters->of_numbers.empty()) return nullptr;
  return &found->raters->of_numbers.front();
}

void add_rater(PaperRow& row, const reliability::Generalizability* one) {
  if (one == nullptr) {
    row.cells.insert(row.cells.end(), 3, no_number());
    return;
  }
  const auto& [low, high] = one->absolute95;
  row.cells.push_back(std::isfinite(one->absolute) ? PaperCell{share(one->absolute), number} : no_number());
  row.cells.push_back(std::isfinite(low) && std::isfinite(high)
                          ? PaperCell{fmt::format("[{}, {}]", share(low), share(high)), number}
                          : no_number());
  const double mdc = one->absolute_error.mdc95;
  row.cells.push_back(std::isfinite(mdc)
                          ? PaperCell{fmt::format("{:.{}f}", mdc, decimals(one->absolute_error.sem, 2)), number}
                          : no_number());
}

/// Recordings of the condition that the outcome does not include.
std::int64_t excluded(const store::StudyList& list, const OutcomeSummary& one) {
  return std::ranges::count_if(list.recordings,
                               [&](const auto& other) { return other.recording.condition == one.condition; }) -
         one.results;
}

void add_reliability(PaperRow& row, const Repeated* sessions) {
  if (sessions == nullptr) {
    row.cells.insert(row.cells.end(), 4, no_number());
    return;
  }
  const reliability::Icc& icc = sessions->test_retest.icc[1];
  const reliability::MeasurementError& error = sessions->test_retest.error[0];
  const auto& [low, high] = icc.interval95;
  row.cells.push_back(std::isfinite(icc.value) ? PaperCell{share(icc.value), number} : no_number());
  row.cells.push_back(std::isfinite(low) && std::isfinite(high)
                          ? PaperCell{fmt::format("[{}, {}]", share(low), share(high)), number}
                          : no_number());
  for (const double value : {error.sem, error.mdc95}) {
    row.cells.push_back(std::isfinite(value) ? PaperCell{fmt::format("{:.{}f}", value, decimals(error.sem, 2)), number}
                                             : no_number());
  }
}

/// "6 people in 2 sessions", or the ranges of both.
std::string people_and_sessions(std::span<const Repeated* const> all) {
  const auto range = [&](auto count) {
    const auto [low, high] = std::ranges::minmax(all, {}, count);
    return count(low) == count(high) ? fmt::format("{}", count(low)) : fmt::format("{} to {}", count(low), count(high));
  };
  return fmt::format("{} people in {} sessions", range([](const Repeated* one) { return one->participants.size(); }),
                     range([](const Repeated* one) { return one->repetitions.size(); }));
}

std::string note_of(const store::StudyList& list, std::span<const OutcomeSummary> outcomes,
                    const StudyStatistics& statistics) {
  std::string text =
      "n: participants (trials), each participant with the mean of their usable trials; SD between participants. ";
  std::vector<const Repeated*> repeated;
  std::vector<std::string> heavy;
  bool eigenvalues = false, rated = false;
  for (const OutcomeSummary& one : outcomes) {
    rated = rated || one_rater(found_reliability(statistics, one)) != nullptr;
    eigenvalues = eigenvalues || one.outcome.find("_lambda_") != std::string::npos;
    if (const Repeated* const sessions = repeated_of(statistics, one)) repeated.push_back(sessions);
    const OutcomeReliability* const found = found_reliability(statistics, one);
    if (found != nullptr && std::ranges::count(found->warnings, ReliabilityWarning::heavy_tails) > 0) {
      heavy.push_back(one.outcome);
    }
  }
  if (eigenvalues) text += "max, min: eigenvalues of the symmetric part. ";
  if (repeated.empty()) {
    text += fmt::format("No reliability: it needs at least {} people in two sessions. ", reliability::kMinPeople);
  } else {
    text += fmt::format(
        "ICC(A,1): two-way, absolute agreement, one session (McGraw & Wong, 1996), from the means of {}; SEM: standard "
        "error of measurement (agreement); MDC95: minimal detectable change at 95 % confidence. ",
        people_and_sessions(repeated));
  }
  if (rated) {
    text +=
        "Phi: dependability of one trial by any one rater in one session (people x raters x sessions, restricted "
        "maximum likelihood), and MDC95 of that trial; other columns take results of different raters as trials. ";
  }
  text += fmt::format(
      "Excluded: recordings of the condition without this outcome. Of {}, {} usable, {} not usable, {} could not be "
      "measured, {} not measured, {} excluded by the investigators. mbk {}.",
      counted(std::ssize(list.recordings), "recording", "recordings"), list.count(RecordingState::usable),
      list.count(RecordingState::not_usable), list.count(RecordingState::failed),
      list.count(RecordingState::not_measured), list.count(RecordingState::excluded),
      list.analysis ? list.analysis->version : std::string(version()));
  if (!heavy.empty()) {
    text +=
        fmt::format(" Errors with heavy tails, for which intervals and MDC are not valid: {}.", fmt::join(heavy, ", "));
  }
  for (const std::string& note : statistics.notes) text += " " + note + ".";
  return text;
}

PaperTable table_of(const store::StudyList& list, std::span<const OutcomeSummary> outcomes,
                    const StudyStatistics& statistics) {
  const bool reliable =
      std::ranges::any_of(outcomes, [&](const OutcomeSummary& one) { return repeated_of(statistics, one) != nullptr; });
  const bool rated = std::ranges::any_of(
      outcomes, [&](const OutcomeSummary& one) { return one_rater(found_reliability(statistics, one)) != nullptr; });
  const bool blocks = std::ranges::any_of(
      outcomes, [&](const OutcomeSummary& one) { return one.condition != outcomes.front().condition; });
  PaperTable table;
  table.caption = list.facts.title.empty() ? "" : printable(list.facts.title) + ". ";
  table.caption += reliable ? "Outcomes and their reliability between sessions" : "Outcomes";
  if (!blocks && !outcomes.front().condition.empty()) table.caption += ", " + outcomes.front().condition;
  table.caption += ".";
  table.note = note_of(list, outcomes, statistics);
  PaperRow& header = table.header.emplace_back();
  header.cells = {{"Outcome"}, {"Unit"}, {"n (trials)"}, {"Mean ± SD"}};
  if (reliable) {
    const std::vector<PaperCell> more = {{"ICC(A,1)"}, {"95 % CI"}, {"SEM"}, {"\\mathrm{MDC}_{95}", symbol}};
    header.cells.insert(header.cells.end(), more.begin(), more.end());
  }
  if (rated) {
    const std::vector<PaperCell> more = {
        {"\\Phi", symbol}, {"95 % CI"}, {"\\mathrm{MDC}_{95,\\mathrm{rater}}", symbol}};
    header.cells.insert(header.cells.end(), more.begin(), more.end());
  }
  header.cells.push_back({"Excluded"});
  table.alignment = "ll" + std::string(header.cells.size() - 2, 'r');
  const std::string* condition = nullptr;
  for (const OutcomeSummary& one : outcomes) {
    if (blocks && (condition == nullptr || *condition != one.condition)) {
      PaperRow& title = table.rows.emplace_back();
      title.cells = {PaperCell{one.condition.empty() ? "no condition" : one.condition}};
      title.rule_above = condition != nullptr;
      condition = &one.condition;
    }
    PaperRow& row = table.rows.emplace_back();
    row.cells = {name_cell(one.outcome), PaperCell{one.unit},
                 PaperCell{fmt::format("{} ({})", one.participants, one.results)}, mean_cell(one)};
    if (reliable) add_reliability(row, repeated_of(statistics, one));
    if (rated) add_rater(row, one_rater(found_reliability(statistics, one)));
    row.cells.push_back({fmt::format("{}", excluded(list, one))});
  }
  return table;
}

std::vector<PaperTable> tables_of(const store::StudyList& list, std::span<const OutcomeSummary> outcomes,
                                  const StudyStatistics& statistics) {
  std::vector<PaperTable> tables;
  const bool split = outcomes.size() > kRowsOfPage;
  for (std::size_t begin = 0, end = 0; begin < outcomes.size(); begin = end) {
    while (end < outcomes.size() && (!split || outcomes[end].condition == outcomes[begin].condition)) ++end;
    tables.push_back(table_of(list, outcomes.subspan(begin, end - begin), statistics));
  }
  return tables;
}

std::string written(const std::vector<PaperTable>& tables, std::string (*write)(const PaperTable&)) {
  std::string text;
  for (const PaperTable& table : tables) text += (text.empty() ? "" : "\n") + write(table);
  return text;
}

std::string all_digits(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

/// Empty where there are no raters, or too few.
std::string rater_fields(const OutcomeReliability* found) {
  const reliability::Generalizability* const one = one_rater(found);
  if (one == nullptr) return ",,,,,,";
  return fmt::format(",{},{},{},{},{},{}", found->raters->model.raters, all_digits(one->absolute),
                     all_digits(one->absolute95.first), all_digits(one->absolute95.second),
                     all_digits(one->absolute_error.sem), all_digits(one->absolute_error.mdc95));
}

}  // namespace summary_table

std::string summary_latex(const store::StudyList& list, const std::vector<store::OutcomeSummary>& outcomes,
                          const StudyStatistics& statistics) {
  return summary_table::written(summary_table::tables_of(list, outcomes, statistics), latex_table);
}

std::string summary_markdown(const store::StudyList& list, const std::vector<store::OutcomeSummary>& outcomes,
                             const StudyStatistics& statistics) {
  return summary_table::written(summary_table::tables_of(list, outcomes, statistics), markdown_table);
}

std::string summary_csv(const store::StudyList& list, const std::vector<store::OutcomeSummary>& outcomes,
                        const StudyStatistics& statistics) {
  using namespace summary_table;
  std::string text =
      "condition,outcome,unit,participants,trials,excluded,mean,sd,icc_form,icc,icc_low95,icc_high95,icc_participants,"
      "icc_sessions,sem,mdc95,notes";
  const bool raters =
      std::ranges::any_of(statistics.reliability, [](const auto& one) { return one.raters.has_value(); });
  text += raters ? ",raters,phi,phi_low95,phi_high95,sem_rater,mdc95_rater\n" : "\n";
  for (const OutcomeSummary& one : outcomes) {
    text += fmt::format("{},{},{},{},{},{},{},{}", csv_field(one.condition), one.outcome, csv_field(one.unit),
                        one.participants, one.results, excluded(list, one), all_digits(one.mean),
                        all_digits(one.standard_deviation));
    if (const Repeated* const sessions = repeated_of(statistics, one)) {
      const reliability::Icc& icc = sessions->test_retest.icc[1];
      const reliability::MeasurementError& error = sessions->test_retest.error[0];
      text += fmt::format(",\"ICC(A,1)\",{},{},{},{},{},{},{}", all_digits(icc.value), all_digits(icc.interval95.first),
                          all_digits(icc.interval95.second), sessions->participants.size(),
                          sessions->repetitions.size(), all_digits(error.sem), all_digits(error.mdc95));
    } else {
      text += ",,,,,,,,";
    }
    const OutcomeReliability* const found = found_reliability(statistics, one);
    text += "," + (found == nullptr ? "" : csv_field(fmt::format("{}", fmt::join(found->notes, "; "))));
    if (raters) text += rater_fields(found);
    text += "\n";
  }
  return text;
}

}  // namespace mbk::statistics
