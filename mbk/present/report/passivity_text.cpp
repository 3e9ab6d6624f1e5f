#include "mbk/present/report/passivity_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

#include "mbk/base/numeric/statistics.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/layout.h"
#include "mbk/present/report/text.h"

namespace mbk::report {
namespace {

std::string between(const Interval& interval) {
  if (!std::isfinite(interval.first) || !std::isfinite(interval.second)) return "";
  return fmt::format("[{:.3g}, {:.3g}]", interval.first, interval.second);
}

std::string word_or_none(const std::optional<Verdict>& verdict) {
  return std::string(verdict ? word_of(*verdict) : "none");
}

/// Verdicts on straight and circular motion for the model of each method, with its VAF.
std::string models_table(const std::vector<ModelPassivity>& models) {
  std::vector<std::vector<std::string>> rows = {{"model by", "VAF", "straight motion", "circular motion", ""}};
  for (const ModelPassivity& model : models) {
    std::vector<std::string> vaf;
    for (const double one : model.vaf) vaf.push_back(fmt::format("{:.1f}", one));
    rows.push_back({method_name(model.method), fmt::format("{} %", fmt::join(vaf, ", ")), word_or_none(model.symmetric),
                    word_or_none(model.antisymmetric), model.usable ? model.fits ? "" : "fits poorly" : "not usable"});
  }
  return table(rows);
}

/// Frequencies at which a model absorbs energy in circular motion; empty if that is the whole band and a decade around
/// it.
std::string circular_text(const ModelPassivity& model) {
  constexpr double kDecade = 10.0;
  if (!model.circular_hz) return "";
  const auto [low, high] = *model.circular_hz;
  const bool above = low > model.band.low.value / kDecade, below = high < model.band.high.value * kDecade;
  if (above && below) return fmt::format("{:.2g} to {:.2g} Hz", low, high);
  return above ? fmt::format("above {:.2g} Hz", low) : below ? fmt::format("below {:.2g} Hz", high) : "";
}

std::string model_text(const ModelPassivity& model) {
  std::string text =
      fmt::format("  model by {}, {:.3g} to {:.3g} Hz{}\n", method_name(model.method), model.band.low.value,
                  model.band.high.value, model.band.extrapolated ? ", extrapolated" : "");
  std::vector<std::vector<std::string>> rows = {{"must be positive", "value", "unit", ""}};
  for (const PassivityCondition& c : model.conditions) {
    rows.push_back({c.name, with_interval(c.value, numeric::kNormal95 * c.standard_error), c.unit,
                    c.verdict == Verdict::passive  ? "met"
                    : c.verdict == Verdict::active ? "not met"
                                                   : "undecided"});
  }
  text += table(rows);
  rows = {{"smallest index", fmt::format("{:.3g}", model.smallest_index), between(model.smallest_index95),
           fmt::format("at {:.3g} Hz", model.smallest_at.value)}};
  if (model.excess) {
    rows.push_back({"excess of passivity", fmt::format("{:.3g}", model.excess->corrected),
                    between(model.excess->corrected95), "smallest eigenvalue of B"});
    rows.push_back({"  published formula", fmt::format("{:.3g}", model.excess->published),
                    between(model.excess->published95), "half the largest eigenvalue of B"});
  }
  if (const std::string circular = circular_text(model); !circular.empty()) {
    rows.push_back({"absorbs in circular motion", circular, "", "point estimate"});
  }
  return text + table(rows);
}

std::string energy_text(const EnergyAccount& account, const char* unit) {
  const auto excess = [unit](double shortage) { return fmt::format("{:.3g} {}", 0.0 - shortage, unit); };
  const auto negated = [](const Interval& interval) { return Interval{-interval.second, -interval.first}; };
  return table({{"absorbed", fmt::format("{:.3g} J", account.absorbed), between(account.absorbed95),
                 fmt::format("in {:.1f} s", account.duration)},
                {"excess of passivity at the end", excess(account.shortage_at_end),
                 between(negated(account.shortage_at_end95)), "eq. (4.3)"},
                {"excess, worst case during the trial", excess(account.shortage_largest),
                 between(negated(account.shortage_largest95)), "below 0: damping is lacking"}});
}

std::string lines_text(const std::vector<EnergyLine>& lines) {
  if (lines.empty()) return "";
  std::vector<std::vector<std::string>> rows = {{"frequency [Hz]", "absorbed [J]", "joint 95 % interval"}};
  for (const EnergyLine& line : lines) {
    rows.push_back(
        {fmt::format("{:.3g}", line.frequency.value), fmt::format("{:.3g}", line.absorbed), between(line.absorbed95)});
  }
  return table(rows);
}

std::string trial_line(const std::optional<TrialPassivity>& trial) {
  if (!trial) return "no statement on the trial: force or motion is not plausible";
  return fmt::format("{}: {}", word_of(trial->energy.verdict), trial->statement);
}

std::string prediction_line(const PassivityPrediction& prediction) {
  return fmt::format("{}: {}", word_or_none(prediction.verdict), prediction.statement);
}

constexpr const char* kNoGuarantee = "Neither statement guarantees that a robot coupled to this person is stable.";

}  // namespace

std::string passivity_text(const Passivity& passivity, Motion motion) {
  std::string text = "passivity, what happened\n" + paragraph("  ", trial_line(passivity.trial));
  if (passivity.trial) {
    text += paragraph("  ", passivity.trial->energy.reason) +
            energy_text(passivity.trial->energy, units_of(motion).damping) + lines_text(passivity.trial->lines);
  }
  text += "\npassivity, what the model predicts\n" + paragraph("  ", prediction_line(passivity.prediction));
  if (!passivity.models.empty()) text += models_table(passivity.models);
  text += "\n";
  for (const ModelPassivity& model : passivity.models) text += model_text(model) + "\n";
  return text + paragraph("  ", fmt::format("Brackets are 95 % intervals. {}", kNoGuarantee));
}

namespace {

/// "inertia, damping and stiffness".
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k) {
    text += (k == 0 ? "" : k + 1 < names.size() ? ", " : " and ") + names[k];
  }
  return text;
}

}  // namespace

std::string consistent_text(const ConsistentFit& fit, Motion motion) {
  std::vector<std::string> active;
  if (fit.inertia.active) active.emplace_back("inertia");
  if (fit.damping.active) active.emplace_back("damping");
  if (fit.stiffness.active) active.emplace_back("stiffness");
  const Units units = units_of(motion);
  const auto row = [](const char* name, const Semidefiniteness& one, const char* unit) {
    const double smallest = one.active ? 0.0 : one.smallest;  // to rounding
    return std::vector<std::string>{name, fmt::format("{:.3g}", one.free_smallest), fmt::format("{:.3g}", smallest),
                                    unit};
  };
  const std::string constraint = active.empty() ? "only symmetry had to be imposed"
                                                : fmt::format("{} {} moved to the limit of a passive limb",
                                                              listed(active), active.size() == 1 ? "was" : "were");
  return paragraph(
             "  ",
             fmt::format("nearest model with M and K symmetric and M, B, K positive semidefinite: {}; the power of the "
                         "residual increases by {:.2g} %; the largest change is in {}, by {:.2g} standard errors",
                         constraint, fit.increase_percent(), fit.largest_change, fit.largest_change_errors)) +
         table({{"smallest eigenvalue", "estimated", "nearest", ""},
                row("M", fit.inertia, units.inertia),
                row("B", fit.damping, units.damping),
                row("K", fit.stiffness, units.stiffness)});
}

std::string passivity_lines(const Passivity& passivity) {
  return paragraph("  ", "passivity, what happened: " + trial_line(passivity.trial)) +
         paragraph("  ", "passivity, what the model predicts: " + prediction_line(passivity.prediction)) +
         paragraph("  ", kNoGuarantee);
}

Chart energy_chart(const Energy& energy) {
  Chart chart;
  chart.title = "Energy absorbed by the limb";
  chart.x = {"time", "s"};
  chart.y = {"energy", "J"};
  ChartSeries series;
  series.name = "energy";
  series.drawn = ChartSeries::Drawn::line;
  series.x.assign(energy.curve.time.begin(), energy.curve.time.end());
  series.y.assign(energy.curve.absorbed.begin(), energy.curve.absorbed.end());
  chart.series.push_back(std::move(series));
  chart.horizontal.push_back({0.0, "0"});
  return chart;
}

}  // namespace mbk::report
