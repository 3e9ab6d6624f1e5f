// How reliable one outcome is under one condition.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mbk/base/numeric/statistics.h"
#include "mbk/study/reliability/heavy_tails.h"
#include "mbk/study/statistics/outcome_rows.h"

namespace mbk::statistics {
namespace {

/// Above so many results weights cost much and change little.
constexpr std::size_t kMaxWeighted = 5'000;
/// Above so many people no single one decides, and looking at each costs their square.
constexpr Index kMaxJudged = 1'000;

/// Single trials of the session in which most people have two or more, the earliest of those.
std::vector<Cell> trials_of_one_session(const OutcomeRows& rows, const std::vector<Cell>& cells,
                                        std::int64_t& session) {
  std::map<std::int64_t, int> people;
  for (const Cell& cell : cells) {
    if (cell.count >= 2) ++people[cell.repetition];
  }
  session = 0;
  int most = 0;
  for (const auto& [number, count] : people) {
    if (count <= most) continue;
    most = count;
    session = number;
  }
  std::vector<Cell> trials;
  for (const OutcomeRow& row : rows.rows) {
    if (most == 0 || row.session != session) continue;
    const bool same = !trials.empty() && trials.back().participant == row.participant;
    trials.push_back({row.participant, same ? trials.back().repetition + 1 : 1, row.value, 1});
  }
  return trials;
}

std::vector<SessionAgreement> agreements(const Repeated& sessions) {
  std::vector<SessionAgreement> all;
  if (sessions.support != Support::enough) return all;
  for (Index k = 1; k < sessions.scores.cols(); ++k) {
    auto limits = reliability::bland_altman(sessions.scores.col(k - 1), sessions.scores.col(k));
    if (!limits) continue;
    all.push_back({sessions.repetitions[static_cast<std::size_t>(k - 1)],
                   sessions.repetitions[static_cast<std::size_t>(k)], *limits});
  }
  return all;
}

/// The person without whom ICC(A,1) is farthest from that of all.
std::optional<Influence> influence_on_icc(const Repeated& sessions) {
  const Index people = sessions.scores.rows();
  if (sessions.support != Support::enough || people <= reliability::kMinPeople || people > kMaxJudged) return {};
  const double all = sessions.test_retest.icc[1].value;
  std::optional<Influence> most;
  Matrix others(people - 1, sessions.scores.cols());
  for (Index i = 0; i < people; ++i) {
    others << sessions.scores.topRows(i), sessions.scores.bottomRows(people - 1 - i);
    const auto squares = reliability::mean_squares(others);
    if (!squares) continue;
    const double without = reliability::icc_of(reliability::IccForm::agreement, *squares);
    if (!std::isfinite(without)) continue;
    if (most && std::abs(without - all) <= std::abs(most->without - all)) continue;
    most = {sessions.participants[static_cast<std::size_t>(i)], without};
  }
  return most;
}

reliability::Measurements measurements_of(const OutcomeRows& rows, bool weighted) {
  reliability::Measurements m;
  const auto count = static_cast<Index>(rows.rows.size());
  m.values.resize(count);
  if (weighted) m.known_variance.resize(count);
  m.fixed = Matrix::Ones(count, 1);
  m.names = {"mean"};
  for (Index i = 0; i < count; ++i) {
    const OutcomeRow& row = rows.rows[static_cast<std::size_t>(i)];
    m.values[i] = row.value;
    if (weighted) m.known_variance[i] = row.standard_error * row.standard_error;
    m.participants.push_back(static_cast<int>(row.participant));
    m.sessions.push_back(static_cast<int>(row.session));
  }
  return m;
}

/// Whether the trials' own errors explain more than there is: then an error of measurement made of them would be one
/// that nobody has seen.
bool overstated(const reliability::MixedModel& weighted, reliability::Measurements m) {
  if (weighted.residual.value > 0.0) return false;
  m.known_variance.resize(0);
  const auto plain = reliability::fit_mixed_model(m);
  constexpr double kByMuch = 1.5;
  return !plain || weighted.typical_known_variance > kByMuch * plain->residual.value;
}

MixedReliability mixed_reliability(const OutcomeRows& rows, const std::vector<Cell>& cells, int participants,
                                   OutcomeReliability& outcome) {
  std::vector<std::string>& notes = outcome.notes;
  MixedReliability result;
  result.participants = participants;
  result.sessions = static_cast<int>(cells.size());
  result.results = static_cast<int>(rows.rows.size());
  if (participants < reliability::kMinPeople) return result;
  result.support = Support::too_few_sessions;
  if (cells.size() == static_cast<std::size_t>(participants)) return result;
  result.support = Support::no_variation;
  std::vector<double> counts;
  for (const Cell& cell : cells) counts.push_back(cell.count);
  result.typical_trials = static_cast<int>(numeric::upper_median(std::move(counts)));
  const bool known = all_known(rows.rows);
  result.weighted = known && rows.rows.size() <= kMaxWeighted;
  if (known && !result.weighted) {
    notes.push_back(
        fmt::format("trials are not weighted by their standard errors: there are more than {}", kMaxWeighted));
  }
  reliability::Measurements m = measurements_of(rows, result.weighted);
  std::vector<int> trials = {1};
  if (result.typical_trials > 1) trials.push_back(result.typical_trials);
  auto fit = reliability::fit_reliability(m, trials);
  if (result.weighted && fit && fit->model && overstated(*fit->model, m)) {
    notes.emplace_back("trials are not weighted by their standard errors, which exceed the differences between trials");
    result.weighted = false;
    m.known_variance.resize(0);
    fit = reliability::fit_reliability(m, trials);
  }
  if (!fit) notes.push_back("no mixed model: " + fit.error().message);
  if (!fit || !fit->model) return result;
  result.participant = fit->model->participant.value;
  result.within = fit->model->session.value + fit->model->residual.value;
  if (reliability::separates_sessions_from_trials(*fit->model)) {
    result.session = fit->model->session.value;
    result.residual = fit->model->residual.value;
  } else {
    outcome.warnings.push_back(ReliabilityWarning::sessions_and_trials);
    notes.emplace_back(
        "the variances between sessions and between trials are not identifiable, since too few sessions have two "
        "trials or more: only their sum is known, and the benefit of more trials is unknown");
  }
  result.known = fit->model->typical_known_variance;
  result.of_trials = std::move(fit->of_trials);
  std::erase_if(result.of_trials, [](const auto& one) { return one.support != Support::enough; });
  result.support = Support::enough;
  return result;
}

/// Sessions in rows, their first trials in columns: as many as half of those with two or more have.
Matrix trials_of_sessions(const OutcomeRows& rows, std::vector<std::pair<std::int64_t, std::int64_t>>& which) {
  std::vector<std::vector<double>> sessions;
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    const OutcomeRow& row = rows.rows[k];
    if (k == 0 || row.participant != rows.rows[k - 1].participant || row.session != rows.rows[k - 1].session) {
      sessions.emplace_back();
      which.emplace_back(row.participant, row.session);
    }
    sessions.back().push_back(row.value);
  }
  std::vector<double> counts;
  for (const auto& one : sessions) {
    if (one.size() >= 2) counts.push_back(static_cast<double>(one.size()));
  }
  const auto columns = counts.empty() ? 2 : static_cast<std::size_t>(numeric::upper_median(std::move(counts)));
  std::size_t kept = 0;
  for (std::size_t k = 0; k < sessions.size(); ++k) {
    if (sessions[k].size() < columns) continue;
    which[kept] = which[k];
    sessions[kept++] = std::vector<double>(sessions[k].begin(), sessions[k].begin() + std::ptrdiff_t(columns));
  }
  which.resize(kept);
  Matrix trials(static_cast<Index>(kept), static_cast<Index>(columns));
  for (std::size_t k = 0; k < kept; ++k) trials.row(static_cast<Index>(k)) = as_vector(sessions[k]).transpose();
  return trials;
}

}  // namespace

std::string heavy_tails_in(const OutcomeRows& rows, const Repeated& sessions) {
  std::vector<std::pair<std::int64_t, std::int64_t>> which;
  const Matrix trials = trials_of_sessions(rows, which);
  const bool of_trials = trials.rows() >= reliability::kMinPeople;
  const double level = of_trials ? 0.5 * reliability::kTailFalseAlarms : reliability::kTailFalseAlarms;
  const reliability::TailTest between = reliability::tail_test(sessions.scores);
  const reliability::TailTest within = of_trials ? reliability::tail_test(trials) : reliability::TailTest();
  if (between.p > level && within.p > level) return "";
  const bool is_between = between.p <= within.p;
  const double kurtosis = is_between ? between.kurtosis : within.kurtosis;
  std::string where;
  if (is_between) {
    where = fmt::format("participant {}", sessions.participants[static_cast<std::size_t>(between.row)]);
    // Of two sessions both are equally far from their mean.
    if (sessions.repetitions.size() > 2) {
      where += fmt::format(", session {}", sessions.repetitions[static_cast<std::size_t>(between.column)]);
    }
  } else {
    const auto [participant, session] = which[static_cast<std::size_t>(within.row)];
    where = fmt::format("participant {}, session {}", participant, session);
  }
  return fmt::format(
      "errors between {} have heavier tails than normal ones (kurtosis {:.1f} of the residuals, which normal errors "
      "reach "
      "in {:.1g} % of studies): the intervals of SEM, MDC and ICC and the limits of agreement do not hold; {} is "
      "farthest "
      "off; check the recordings",
      is_between ? "sessions" : "trials", kurtosis, 100.0 * std::min(between.p, within.p), where);
}

OutcomeReliability reliability_of(OutcomeRows rows, OutcomeReliability named) {
  OutcomeReliability result = std::move(named);
  result.axial = rows.axial;
  const std::vector<Cell> cells = session_cells(rows);
  result.results = static_cast<int>(rows.rows.size());
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const bool again = k > 0 && cells[k].participant == cells[k - 1].participant;
    if (!again) ++result.participants;
    const bool second = again && (k == 1 || cells[k - 2].participant != cells[k].participant);
    if (second) ++result.repeated_participants;
  }
  if (!rows.trusted) {
    result.notes.emplace_back(
        "orientations lie more than 45° from their mean axis, so that no numbers can stand for them: look at the "
        "shape, "
        "near 1 it is a circle without orientation");
    result.between_sessions.support = result.within_session.support = result.mixed_model.support =
        Support::no_variation;
    return result;
  }
  result.between_sessions = repeated(cells);
  result.agreement = agreements(result.between_sessions);
  result.influence = influence_on_icc(result.between_sessions);
  result.within_session = repeated(trials_of_one_session(rows, cells, result.session));
  if (result.session == 0 && result.participants >= reliability::kMinPeople) {
    result.within_session.support = Support::too_few_sessions;
  }
  result.mixed_model = mixed_reliability(rows, cells, result.participants, result);

  const Repeated& sessions = result.between_sessions;
  if (std::string tails = heavy_tails_in(rows, sessions); !tails.empty()) {
    result.warnings.push_back(ReliabilityWarning::heavy_tails);
    result.notes.push_back(std::move(tails));
  }
  if (sessions.support == Support::no_variation) {
    result.notes.emplace_back(
        "the values of each person are the same in all sessions: check that they were not copied; no reliability");
  }
  if (result.influence) {
    const auto [low, high] = sessions.test_retest.icc[1].interval95;
    const double without = result.influence->without;
    if (without < low || without > high) {
      result.notes.push_back(
          fmt::format("the result depends on participant {}: without them ICC(A,1) is {:.2f}, not {:.2f}",
                      result.influence->participant, result.influence->without, sessions.test_retest.icc[1].value));
    }
  }
  return result;
}

}  // namespace mbk::statistics
