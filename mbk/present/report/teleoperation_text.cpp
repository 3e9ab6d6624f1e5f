#include "mbk/present/report/teleoperation_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

constexpr std::size_t kMaxPlaces = 5;  // bands or frequencies that are named in one cell

constexpr int kDigits = 4;  // of limits

std::string value_text(double value) {
  if (std::isinf(value)) return value > 0.0 ? "infinity" : "minus infinity";
  return fmt::format("{:.{}g}", value, kDigits);
}

enum class Side { up, down };

/// A limit of what is stable with four digits, rounded to the stable side.
double rounded_limit(double value, Side side) {
  if (value == 0.0 || !std::isfinite(value)) return value;
  constexpr double kExact = 1e-9;  // of a decimal fraction that is stored in binary
  const double scale = std::pow(10.0, kDigits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  const double scaled = value * scale, nearest = std::round(scaled);
  if (std::abs(scaled - nearest) < kExact * std::abs(scaled)) return nearest / scale;
  return (side == Side::up ? std::ceil(scaled) : std::floor(scaled)) / scale;
}

/// The ends of an interval; with more digits where four would leave nothing of it.
std::pair<std::string, std::string> limit_texts(const AdmissibleInterval& interval) {
  const double low = rounded_limit(interval.low.value, Side::up), high = rounded_limit(interval.high.value, Side::down);
  if (low < high) return {value_text(low), value_text(high)};
  return {fmt::format("{:.10g}", interval.low.value), fmt::format("{:.10g}", interval.high.value)};
}

std::string in_hz(RadPerSec omega) {
  return fmt::format("{:.4g} Hz", omega.value / (2.0 * std::numbers::pi));
}

std::string band_text(const ViolatedBand& band, std::optional<RadPerSec> limit) {
  if (band.low == band.high && !band.detail.empty()) return band.detail;
  if (band.low == band.high) return fmt::format("at {} rad/s", value_text(band.low.value));
  const std::string range = std::isinf(band.high.value) ? fmt::format("above {} rad/s", value_text(band.low.value))
                                                        : fmt::format("from {} to {} rad/s", value_text(band.low.value),
                                                                      value_text(band.high.value));
  if (limit && band.worst > *limit) return range + (band.low > *limit ? " (of the Padé approximation)" : "");
  return fmt::format("{}, worst near {:.4g} rad/s ({})", range, band.worst.value, in_hz(band.worst));
}

std::string outcome_text(const StabilityOutcome& outcome, std::optional<RadPerSec> limit) {
  if (outcome.violated.empty()) return "holds";
  std::vector<std::string> places;
  for (const ViolatedBand& band : outcome.violated) {
    if (places.size() == kMaxPlaces) {
      places.push_back(fmt::format("and {} more", outcome.violated.size() - kMaxPlaces));
      break;
    }
    places.push_back(band_text(band, limit));
  }
  return fmt::format("VIOLATED {}", fmt::join(places, "; "));
}

std::string conditions_table(const AbsoluteStability& stability, std::optional<RadPerSec> limit) {
  std::vector<std::vector<std::string>> rows;
  for (const StabilityOutcome& outcome : stability.conditions) {
    rows.push_back({text(outcome.condition), outcome_text(outcome, limit)});
  }
  return table(rows);
}

std::string verdict_line(const AbsoluteStability& stability, const char* where) {
  switch (stability.verdict) {
    case StabilityVerdict::stable:
      return fmt::format("absolutely stable{}", where);
    case StabilityVerdict::marginal:
      return fmt::format("marginal{}: absolutely stable, without margin", where);
    case StabilityVerdict::unstable:
      break;
  }
  return fmt::format("NOT absolutely stable{}", where);
}

std::string touches_text(const AbsoluteStability& stability) {
  if (stability.touches_everywhere) return "a condition holds with equality at every frequency";
  std::vector<std::string> places;
  for (const RadPerSec omega : stability.touches) places.push_back(value_text(omega.value));
  if (places.size() > kMaxPlaces) places.resize(kMaxPlaces);
  return fmt::format("a condition holds with equality at {} rad/s", fmt::join(places, ", "));
}

/// Whether every violated band lies where the Padé approximation is no longer the delay.
bool only_of_pade(const AbsoluteStability& stability, std::optional<RadPerSec> limit) {
  bool any = false;
  for (const StabilityOutcome& outcome : stability.conditions) {
    for (const ViolatedBand& band : outcome.violated) {
      any = true;
      if (!limit || !band.detail.empty() || band.low < *limit) return false;
    }
  }
  return any;
}

/// Whether a verdict does not apply to all frequencies.
bool is_limited(const std::optional<FrequencyGrid>& grid) {
  return grid && (!grid->bounded || grid->low.value > 0.0 || !std::isinf(grid->high.value));
}

/// The frequencies to which a verdict applies; nothing if it applies to all without a delay.
std::string where_text(const std::optional<FrequencyGrid>& grid, const AbsoluteStability& stability) {
  if (!grid) return "";
  if (!grid->bounded) {
    return fmt::format(" on {} points from {:g} to {:g} rad/s", grid->points, grid->low.value, grid->high.value);
  }
  std::string where = " with the true delay";
  if (!stability.holds()) return where;
  if (grid->low.value > 0.0) where += fmt::format(", from {:.4g} rad/s", grid->low.value);
  if (!std::isinf(grid->high.value)) where += fmt::format(", up to {:.4g} rad/s", grid->high.value);
  return where;
}

std::string meaning(const AbsoluteStability& stability, std::optional<RadPerSec> limit, bool limited) {
  if (only_of_pade(stability, limit)) {
    return fmt::format(
        "with the Padé approximation some passive pair is unstable, but only above {:.4g} rad/s, where its "
        "phase is not that of the delay: omit pade in [delay] to decide the true delay",
        limit->value);
  }
  if (stability.verdict == StabilityVerdict::unstable) {
    return "some passive hand and some passive environment make the system oscillate or run away, most likely near the "
           "worst frequency";
  }
  std::string words = limited ? "at these frequencies " : "";
  words += "no passive hand and no passive environment can make the system unstable";
  if (stability.verdict == StabilityVerdict::marginal) words += "; " + touches_text(stability);
  return words;
}

std::string interval_text(const AdmissibleInterval& interval) {
  if (interval.low.value == interval.high.value) return fmt::format("only {:.10g}", interval.low.value);
  const auto [low, high] = limit_texts(interval);
  const auto side = [](const AdmissibleEnd& end) {
    if (end.limit_of_search) return " (the range ends there)";
    if (!end.included) return " (undecided at this value)";
    return *end.included ? "" : " (excluded)";
  };
  return fmt::format("{}{} to {}{}", low, side(interval.low), high, side(interval.high));
}

std::string admissible_text(const AdmissibleSet& set, bool with_operator) {
  std::string result = fmt::format("\n{} between {:g} and {:g}{}: ", set.parameter, set.low, set.high,
                                   set.unit.empty() ? "" : " " + set.unit);
  const char* const what = with_operator ? "stable with that operator" : "absolutely stable";
  if (set.intervals.empty()) {
    result += fmt::format("never {}\n", what);
  } else {
    result += fmt::format("{} for\n", what);
    for (const AdmissibleInterval& interval : set.intervals) result += "  " + interval_text(interval) + "\n";
  }
  if (!set.undecided.empty()) {
    std::vector<std::string> values;
    for (const double value : set.undecided) values.push_back(fmt::format("{:.10g}", value));
    result += paragraph("  ", fmt::format("undecided at the isolated values {}", fmt::join(values, ", ")));
  }
  return result + paragraph("  ",
                            "all boundaries are roots of polynomials, rounded to the stable side; the verdict is the "
                            "same for all values between two boundaries");
}

std::string shortage_text(const LargestShortage& largest, const std::optional<FrequencyGrid>& grid) {
  if (!largest.exists) return fmt::format("port {}: none; no excess of passivity is sufficient", largest.port);
  return fmt::format("port {}: a ≤ {} N·s/m{}", largest.port,
                     value_text(rounded_limit(grid ? largest.at_least : largest.value(), Side::down)),
                     grid && !grid->bounded ? ", on the grid" : "");
}

std::string run_text(const TeleoperationRun& run) {
  std::string result = fmt::format("\n  {}\n", run.what);
  result += paragraph("    hand         ", run.hand);
  result += paragraph("    environment  ", run.environment);
  if (run.worst) {
    result += paragraph("    expected     ",
                        fmt::format("grows at {:.5g} rad/s ({}), by a factor e in {:.3g} s", run.worst->frequency.value,
                                    in_hz(run.worst->frequency), 1.0 / run.worst->growth));
  }
  const char* const outcome = run.outcome == MotionOutcome::grows      ? "GROWS"
                              : run.outcome == MotionOutcome::dies_out ? "dies out"
                                                                       : "stays bounded";
  std::string seen = fmt::format("{}: speed in the last quarter {:.3g} times that in the second", outcome, run.ratio);
  if (run.frequency.value > 0.0) seen += fmt::format(", at {:.5g} rad/s", run.frequency.value);
  seen += run.ran_away ? fmt::format("; ran away after {:.3g} s", run.duration)
                       : fmt::format("; {:.3g} s, at most {:.3g} mm", run.duration, 1e3 * run.largest_position);
  result += paragraph("    simulated    ", seen);
  if (run.lost > 0) {
    result += paragraph("    line         ", fmt::format("{} of {} packets lost", run.lost, run.sent));
  }
  if (run.lowest_energy) {
    result += paragraph("    controller   ",
                        fmt::format("minimum energy of the teleoperator at the master: {:.4g} J", *run.lowest_energy));
  }
  return result;
}

std::string simulation_text(const TeleoperationSimulation& simulation, const TeleoperationFinding& finding) {
  std::string result = fmt::format("\nTime simulation, with controllers at {:g} Hz and zero-order hold:\n",
                                   1.0 / simulation.sample_time);
  const auto predicted = [&](const char* who, const AbsoluteStability& designed,
                             const std::optional<AbsoluteStability>& sampled) {
    if (!sampled) return;
    result +=
        paragraph("  predicted  ", fmt::format("{}: {} as designed; {} with sampling, on {} points up to {:.4g} rad/s",
                                               who, verdict_line(designed, ""), verdict_line(*sampled, ""),
                                               simulation.grid.points, simulation.grid.high.value));
  };
  predicted("passive hand", finding.stability, simulation.sampled);
  if (finding.with_operator) predicted("that operator", *finding.with_operator, simulation.sampled_with_operator);
  for (const TeleoperationRun& run : simulation.runs) result += run_text(run);
  if (!simulation.notes.empty()) result += "\n";
  for (const std::string& note : simulation.notes) result += paragraph("  note  ", note);
  return result;
}

std::string excess_text(const ExcessSweep& sweep) {
  const std::string unit = sweep.unit.empty() ? "" : " [" + sweep.unit + "]";
  std::vector<std::vector<std::string>> rows = {
      {"excess [N·s/m]", "stable " + sweep.parameter + unit, "felt free [N·s/m]", "felt clamped [N/m]"}};
  for (const ExcessStep& step : sweep.steps) {
    std::vector<std::string> intervals;
    for (const AdmissibleInterval& interval : step.set.intervals) {
      const auto [low, high] = limit_texts(interval);
      intervals.push_back(
          interval.low.value == interval.high.value
              ? fmt::format("{:.6g}", interval.low.value)
              : fmt::format("{} to {}{}", low, high, interval.high.limit_of_search ? " (end of range)" : ""));
    }
    rows.push_back({fmt::format("{:g}", step.excess),
                    intervals.empty() ? "none" : fmt::format("{}", fmt::join(intervals, "; ")),
                    step.felt ? fmt::format("{:.4g}", step.felt->free) : "",
                    step.felt ? fmt::format("{:.4g}", step.felt->clamped) : ""});
  }
  return fmt::format("\nEffect of an excess of passivity of the operator:\n{}", table(rows)) +
         paragraph("  ", fmt::format("felt: by the hand at {:.4g} rad/s ({}) with the largest stable value, |Z| with "
                                     "nothing at port 2 (transparent: 0) and |ω Z| with port 2 held fast (transparent: "
                                     "infinite)",
                                     sweep.frequency.value, in_hz(sweep.frequency)));
}

}  // namespace

std::string teleoperation_text(const TeleoperationFinding& finding) {
  std::string result = finding.file + "\n";
  result += paragraph("  ", finding.kind + (finding.name.empty() ? "" : ": " + finding.name));
  if (!finding.matrix.empty()) result += "  port 1: the master and the hand; port 2: the slave and the environment\n";
  for (const std::string& line : finding.matrix) result += "  " + line + "\n";
  if (!finding.parameters.empty()) {
    std::vector<std::vector<std::string>> rows;
    for (const DesignParameter& p : finding.parameters) {
      rows.push_back({p.name, fmt::format("{:g}", p.value), p.unit, p.meaning});
    }
    result += "\n" + table(rows);
  }
  const std::string where = where_text(finding.grid, finding.stability);
  result += fmt::format("\nLlewellyn's criterion (r = Re {0}, p = {0}12 {0}21): {1}\n", finding.stability.form,
                        verdict_line(finding.stability, where.c_str()));
  result += conditions_table(finding.stability, finding.pade_limit);
  result += paragraph("  meaning  ", meaning(finding.stability, finding.pade_limit, is_limited(finding.grid)));
  if (finding.with_operator) {
    const double a = finding.operator_shortage->a;
    result +=
        "\n" +
        paragraph("", fmt::format("With the operator at port {}, Re z ≥ {:g} N·s/m, a = {:g} ({} of passivity): {}",
                                  finding.operator_port, 0.0 - a, a, a > 0.0 ? "shortage" : "excess",
                                  verdict_line(*finding.with_operator,
                                               where_text(finding.operator_grid, *finding.with_operator).c_str())));
    result += conditions_table(*finding.with_operator, finding.pade_limit);
    result += paragraph("  operator  ", finding.operator_shortage->rule);
  }
  result += "\nLargest shortage of passivity of one termination if the other is passive:\n";
  for (const LargestShortage& largest : finding.largest_shortages) {
    result += paragraph("  ", shortage_text(largest, finding.grid));
  }
  result += paragraph("  ", "a < 0: the termination needs that much excess (Re z ≥ −a at every frequency)");
  if (finding.admissible) result += admissible_text(*finding.admissible, finding.with_operator.has_value());
  if (finding.excess) result += excess_text(*finding.excess);
  if (finding.simulation) result += simulation_text(*finding.simulation, finding);
  if (!finding.notes.empty()) result += "\n";
  for (const std::string& note : finding.notes) result += paragraph("  note  ", note);
  return result;
}

}  // namespace mbk::report
