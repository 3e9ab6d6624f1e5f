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

/// What one method's model says of straight and of circular motion, beside how much it explains.
std::string models_table(const std::vector<ModelPassivity>& models) {
  std::vector<std::vector<std::string>> rows = {{"model of", "VAF", "straight motion", "circular motion", ""}};
  for (const ModelPassivity& model : models) {
    std::vector<std::string> vaf;
    for (const double one : model.vaf) vaf.push_back(fmt::format("{:.1f}", one));
    rows.push_back({method_name(model.method), fmt::format("{} %", fmt::join(vaf, ", ")), word_or_none(model.symmetric),
                    word_or_none(model.antisymmetric), model.usable ? model.fits ? "" : "fits poorly" : "not usable"});
  }
  return table(rows);
}

/// Where a model absorbs in circular motion; empty where that is throughout the band and a decade to either side.
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
      fmt::format("  model of {}, {:.3g} to {:.3g} Hz{}\n", method_name(model.method), model.band.low.value,
                  model.band.high.value, model.band.extrapolated ? ", extrapolated" : "");
  std::vector<std::vector<std::string>> rows = {{"condition: positive", "value", "unit", ""}};
  for (const PassivityCondition& c : model.conditions) {
    rows.push_back({c.name, with_interval(c.value, numeric::kNormal95 * c.standard_error), c.unit,
                    c.verdict == Verdict::passive  ? "holds"
                    : c.verdict == Verdict::active ? "fails"
                                                   : "open"});
  }
  text += table(rows);
  rows = {{"smallest index", fmt::format("{:.3g}", model.smallest_index), between(model.smallest_index95),
           fmt::format("at {:.3g} Hz", model.smallest_at.value)}};
  if (model.excess) {
    rows.push_back({"excess of passivity", fmt::format("{:.3g}", model.excess->corrected),
                    between(model.excess->corrected95), "smallest eigenvalue of B"});
    rows.push_back({"  by the published formula", fmt::format("{:.3g}", model.excess->published),
                    between(model.excess->published95), "half of the largest"});
  }
  if (const std::string circular = circular_text(model); !circular.empty()) {
    rows.push_back({"absorbs in circles", circular, "", "as estimated"});
  }
  return text + table(rows);
}

std::string energy_text(const EnergyAccount& account, const char* unit) {
  const char* const what = account.shortage_at_end < 0.0 ? "excess at the end" : "shortage at the end";
  const char* const largest = account.shortage_largest < 0.0 ? "excess, worst case" : "shortage, worst case";
  const auto shortage = [](double value, const Interval& interval) {
    return value < 0.0 ? std::pair{-value, Interval{-interval.second, -interval.first}} : std::pair{value, interval};
  };
  const auto [end, end95] = shortage(account.shortage_at_end, account.shortage_at_end95);
  const auto [most, most95] = shortage(account.shortage_largest, account.shortage_largest95);
  return table({{"absorbed", fmt::format("{:.3g} J", account.absorbed), between(account.absorbed95),
                 fmt::format("in {:.1f} s", account.duration)},
                {what, fmt::format("{:.3g} {}", end, unit), between(end95), "eq. (4.3)"},
                {largest, fmt::format("{:.3g} {}", most, unit), between(most95), "over time"}});
}

std::string lines_text(const std::vector<EnergyLine>& lines) {
  if (lines.empty()) return "";
  std::vector<std::vector<std::string>> rows = {{"line [Hz]", "absorbed [J]", "95 % for all lines at once"}};
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

constexpr const char* kNoPromise = "Neither is a promise that a machine is stable with this person.";

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
  return text + paragraph("  ", fmt::format("Brackets are 95 % intervals. {}", kNoPromise));
}

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
  const std::string held =
      active.empty() ? "the data ask for nothing else but symmetry"
                     : fmt::format("{} held at the edge of what a passive limb can have", fmt::join(active, " and "));
  return paragraph("  ", fmt::format("nearest model with M and K symmetric and M, B, K positive semidefinite: {}; the "
                                     "residual's power grows by {:.2g} %, {} moves by {:.2g} standard errors",
                                     held, fit.increase_percent(), fit.largest_change, fit.largest_change_errors)) +
         table({{"smallest eigenvalue", "as found", "nearest", ""},
                row("M", fit.inertia, units.inertia),
                row("B", fit.damping, units.damping),
                row("K", fit.stiffness, units.stiffness)});
}

std::string passivity_lines(const Passivity& passivity) {
  return paragraph("  ", "passivity, what happened: " + trial_line(passivity.trial)) +
         paragraph("  ", "passivity, what the model predicts: " + prediction_line(passivity.prediction)) +
         paragraph("  ", kNoPromise);
}

Chart energy_chart(const Energy& energy) {
  Chart chart;
  chart.title = "energy that the limb absorbed";
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
