#include "mbk/teleop/judge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "mbk/base/lti/half_planes.h"
#include "mbk/base/lti/on_axis.h"
#include "mbk/teleop/admissible.h"
#include "mbk/teleop/delayed.h"
#include "mbk/teleop/largest_shortage.h"
#include "mbk/teleop/llewellyn.h"
#include "mbk/teleop/sampled.h"

namespace mbk::teleop {
namespace {

using Immittance = std::function<Eigen::MatrixXcd(RadPerSec)>;

/// A decade beyond the corner frequencies of the entries, the delays and the places where something begins or is worst.
/// @param two_port  without delay, so that roots of a Padé approximation are not among its corners
FrequencyGrid range_of_charts(const TwoPort& two_port, const std::vector<double>& delays,
                              const AbsoluteStability& stability, std::optional<RadPerSec> limit) {
  constexpr double kBeside = 10.0;
  constexpr int kPoints = 600;
  std::vector<double> places;
  const auto add = [&](double omega) {
    if (omega > 0.0 && std::isfinite(omega)) places.push_back(omega);
  };
  for (const Index i : {0, 1}) {
    for (const Index j : {0, 1}) {
      const lti::RationalFunction& entry = two_port.matrix(i, j);
      if (entry.is_zero()) continue;
      for (const Polynomial* p : {&entry.numerator(), &entry.denominator()}) {
        Polynomial rest = *p;  // without roots at 0, which are no corners and not found as exactly 0
        while (rest.degree() > 0 && rest.coefficient(0).is_zero()) rest = lti::divide(rest, Polynomial{0, 1}).quotient;
        for (const std::complex<double> root : lti::complex_roots(rest)) add(std::abs(root));
      }
    }
  }
  for (const double T : delays) add(1.0 / T);
  for (const StabilityOutcome& outcome : stability.conditions) {
    if (outcome.violated.empty()) continue;
    const ViolatedBand& first = outcome.violated.front();  // a true delay repeats them
    if (limit && first.low > *limit) continue;
    const bool closed = first.low.value > 0.0 && std::isfinite(first.high.value);
    for (const RadPerSec omega : {first.low, closed ? first.worst : first.low, first.high}) add(omega.value);
  }
  if (places.empty()) places.push_back(1.0);
  const auto [low, high] = std::ranges::minmax(places);
  return {RadPerSec(low / kBeside), RadPerSec(high * kBeside), kPoints};
}

/// The frequencies of a grid, and the worst ones, which may lie in a band narrower than its step.
std::vector<RadPerSec> chart_frequencies(const FrequencyGrid& grid, const AbsoluteStability& stability) {
  std::vector<RadPerSec> omega = frequencies(grid);
  for (const StabilityOutcome& outcome : stability.conditions) {
    for (const ViolatedBand& band : outcome.violated) {
      for (const RadPerSec place : {band.low, band.worst, band.high}) {
        if (grid.low < place && place < grid.high && band.low != band.high) omega.push_back(place);
      }
    }
  }
  std::ranges::sort(omega);
  return omega;
}

std::vector<Chart> charts(const Immittance& immittance, const std::vector<RadPerSec>& omega, const std::string& form) {
  ChartSeries r11{"r11", {}, {}, {}, ChartSeries::Drawn::line}, r22 = r11, third = r11;
  r22.name = "r22";
  third.name = "third condition";
  for (const RadPerSec frequency : omega) {
    const ConditionValues values = condition_values(immittance(frequency));
    for (const auto& [series, value] : {std::pair{&r11, values.r11}, {&r22, values.r22}, {&third, values.third}}) {
      series->x.push_back(frequency.value);
      series->y.push_back(value);
    }
  }
  const auto chart = [&](std::string title, ChartAxis y, ChartSeries series) {
    Chart result;
    result.title = std::move(title);
    result.x = {"frequency", "rad/s", true};
    result.y = std::move(y);
    result.series = {std::move(series)};
    result.horizontal = {{0.0, "0"}};
    return result;
  };
  const auto resistance = [&](int port) {
    const bool impedance = form == word_of(Form::z) || form == word_of(port == 1 ? Form::h : Form::g);
    return ChartAxis{fmt::format("Re {}{}{}", form, port, port), impedance ? "N·s/m" : "m/(N·s)"};
  };
  return {chart("First condition: r11 must not be negative", resistance(1), std::move(r11)),
          chart("Second condition: r22 must not be negative", resistance(2), std::move(r22)),
          chart("Third condition: 2 r11 r22 − Re p − |p| must not be negative",
                {"divided by 2 |r11 r22| + |Re p| + |p|", ""}, std::move(third))};
}

/// How a design is judged, exactly or with true delays, with a shortage at a port.
struct Judged {
  AbsoluteStability stability;
  std::optional<FrequencyGrid> grid;  ///< with true delays
};

Result<Judged> judge_with(const Design& design, Port port, const Rational& a) {
  if (!design.has_true_delay()) {
    const auto two_port = MBK_TRY(design.equations().with_shortage(port, Polynomial{a}).at(0));
    return Judged{llewellyn(two_port), std::nullopt};
  }
  const auto& teleoperator = std::get<Teleoperator>(design.network);
  if (design.exact_delay) {
    auto stability = MBK_TRY(llewellyn_on_grid(teleoperator, *design.exact_delay, port, a));
    return Judged{std::move(stability), design.exact_delay};
  }
  auto delayed = MBK_TRY(llewellyn_with_delay(teleoperator, port, a));
  return Judged{std::move(delayed.stability), delayed.grid};
}

Result<LargestShortage> largest_shortage_of(const Design& design, Port port) {
  if (!design.has_true_delay()) return largest_shortage(design.equations(), port);
  const auto& teleoperator = std::get<Teleoperator>(design.network);
  if (design.exact_delay) return largest_shortage_on_grid(teleoperator, *design.exact_delay, port);
  return largest_shortage_with_delay(teleoperator, port);
}

/// Delays other than 0 [s].
std::vector<double> delays_of(const Design& design) {
  std::vector<double> delays;
  if (!design.is_architecture()) return delays;
  for (const auto& [name, value] : std::get<Teleoperator>(design.network).values) {
    if (name.starts_with("delay.") && !value.is_zero()) delays.push_back(lti::to_double(value));
  }
  return delays;
}

/// The frequency at which the phase of the Padé approximation of the longest delay differs by 0.1 rad.
RadPerSec pade_limit(int order, double T) {
  constexpr double kError = 0.1, kStep = 1e-3;
  double x = 0.0;  // ωT
  const auto error = [&] {
    std::complex<double> q = 0.0, power = 1.0;  // Q(jx), whose phase counts twice
    double c = 1.0;
    for (int j = 0; j <= order; ++j) {
      q += c * power;
      power *= std::complex<double>(0.0, x);
      c *= double(order - j) / ((2.0 * order - j) * (j + 1.0));
    }
    return std::abs(std::arg(std::conj(q) / q * std::polar(1.0, x)));
  };
  while (error() < kError) x += kStep;
  return RadPerSec(x / T);
}

void describe(const Design& design, TeleoperationFinding& finding) {
  finding.file = design.file;
  finding.name = design.name;
  finding.operator_port = static_cast<int>(design.operator_port);
  if (const auto* two_port = std::get_if<TwoPort>(&design.network)) {
    finding.kind = fmt::format("two-port {}", word_of(two_port->form));
    return;
  }
  const auto& teleoperator = std::get<Teleoperator>(design.network);
  finding.kind = word_of(teleoperator.architecture);
  finding.matrix = matrix_lines(teleoperator.architecture);
  for (const Parameter& parameter : all_parameters()) {
    const auto found = teleoperator.values.find(parameter.name);
    if (found == teleoperator.values.end()) continue;
    finding.parameters.push_back({std::string(parameter.name), std::string(parameter.unit),
                                  std::string(parameter.meaning), lti::to_double(found->second)});
  }
}

/// What the answer is worth where there is a delay.
void add_notes_on_delay(const Design& design, const Question& question, TeleoperationFinding& finding) {
  const std::vector<double> delays = delays_of(design);
  const bool varied = question.sweep && question.sweep->parameter.starts_with("delay.");
  if (!design.is_architecture()) return;
  const int order = std::get<Teleoperator>(design.network).pade_order;
  if (finding.grid && finding.grid->bounded) {
    const FrequencyGrid& grid = *finding.grid;
    finding.notes.push_back(fmt::format(
        "true delay, evaluated in double precision at {} to {} rad/s; between the points the conditions are bounded, "
        "so "
        "that no violation deeper than {:g} of the sum of the terms is missed",
        grid.low.value > 0.0 ? fmt::format("{:.3g}", grid.low.value) : "0",
        std::isinf(grid.high.value) ? "infinity" : fmt::format("{:.4g}", grid.high.value), kDelayTolerance));
    if (std::isfinite(grid.high.value) && !finding.stability.holds()) {
      finding.notes.push_back("violations above that frequency are not listed");
    } else if (std::isfinite(grid.high.value)) {
      finding.notes.push_back(
          "above that frequency the conditions depend on the phase of the delay; a search of single "
          "frequencies found no violation");
    }
  } else if (finding.grid) {
    finding.notes.push_back(
        "true delay, and the verdict applies to the grid frequencies only: a violation between grid points is "
        "not detected; omit grid_from_rad_per_s, grid_to_rad_per_s and grid_points to cover what lies between them");
  } else if (!delays.empty() || varied) {
    finding.notes.push_back(
        fmt::format("each delay is a Padé approximation of order {}: the verdict is exact for this approximation",
                    order) +
        (finding.pade_limit ? fmt::format(", whose phase differs from that of the delay by more than 0.1 rad above "
                                          "{:.4g} rad/s; omit pade to use the true delay",
                                          finding.pade_limit->value)
                            : ""));
  }
}

Result<std::string> unit_of(const Design& design, const std::string& name) {
  const auto* teleoperator = std::get_if<Teleoperator>(&design.network);
  if (teleoperator == nullptr) {
    return bad_usage("--parameter: a design given as [two_port] has no parameters", "write an [architecture]");
  }
  std::vector<std::string_view> names;
  for (const Parameter& parameter : all_parameters()) {
    if (need(teleoperator->architecture, parameter.name) == Need::none) continue;
    if (parameter.name == name) return std::string(parameter.unit);
    names.push_back(parameter.name);
  }
  return bad_usage(fmt::format("--parameter: '{}' is not a parameter of {}", name, word_of(teleoperator->architecture)),
                   fmt::format("use one of {}", fmt::join(names, ", ")));
}

Result<AdmissibleSet> sweep(const Design& design, const Question::Sweep& asked, const Rational& a,
                            const std::function<void(double)>& progress = {}) {
  auto unit = MBK_TRY(unit_of(design, asked.parameter));
  if (design.has_true_delay()) {
    return bad_usage("--parameter: a true delay has no polynomial form",
                     "write pade = 1 or pade = 2 in [delay] to sweep with a Padé approximation");
  }
  const PortEquations equations = design.equations(asked.parameter).with_shortage(design.operator_port, Polynomial{a});
  auto set = admissible_set(equations, asked.low, asked.high, progress);
  if (set) {
    set->parameter = asked.parameter;
    set->unit = std::move(unit);
  }
  return set;
}

/// One cycle per second, within what a hand does.
constexpr RadPerSec kFelt{Hertz(1.0)};

/// With nothing at port 2 the hand feels Z = z₁₁ − z₁₂ z₂₁/z₂₂ = h₁₁ + …, with V₂ = 0; with port 2 held fast, z₁₁.
ExcessStep::Felt felt(const PortEquations& equations, const Rational& k) {
  const std::complex<double> s(0.0, kFelt.value);
  Eigen::Matrix<std::complex<double>, 2, 4> values;
  for (const std::size_t i : {0, 1}) {
    for (std::size_t j = 0; j < 4; ++j) {
      values(static_cast<Index>(i), static_cast<Index>(j)) = lti::evaluate(equations.rows[i][j].at(k), s);
    }
  }
  const Eigen::Matrix2cd z = immittance(values, Form::z), y = immittance(values, Form::y);
  return {std::abs(1.0 / y(0, 0)), kFelt.value * std::abs(z(0, 0))};
}

Result<ExcessSweep> sweep_excess(const Design& design, const Question::Sweep& asked, const Question::Excess& excess,
                                 const std::function<void(int, int)>& progress) {
  ExcessSweep result;
  result.frequency = kFelt;
  for (int i = 0; i < excess.steps; ++i) {
    const Rational delta = excess.low + (excess.high - excess.low) * Rational(i, excess.steps - 1);
    auto set = MBK_TRY(sweep(design, asked, -delta));
    result.parameter = set.parameter;
    result.unit = set.unit;
    ExcessStep step{lti::to_double(delta), std::move(set), {}};
    if (!step.set.intervals.empty()) {
      const auto largest = lti::exact(step.set.intervals.back().high.value);
      if (largest) step.felt = felt(design.equations(asked.parameter), *largest);
    }
    result.steps.push_back(std::move(step));
    if (progress) progress(i + 1, excess.steps);
  }
  return result;
}

/// The least and the largest admissible value against the excess, with the measured one.
Chart excess_chart(const ExcessSweep& sweep, const std::optional<OperatorShortage>& shortage) {
  ChartSeries least{"smallest stable", {}, {}, {}, ChartSeries::Drawn::line}, largest = least;
  largest.name = "largest stable";
  for (const ExcessStep& step : sweep.steps) {
    if (step.set.intervals.empty()) continue;
    least.x.push_back(step.excess);
    least.y.push_back(step.set.intervals.front().low.value);
    largest.x.push_back(step.excess);
    largest.y.push_back(step.set.intervals.back().high.value);
  }
  Chart chart;
  chart.title = "Stable values against excess of passivity: " + sweep.parameter;
  chart.x = {"excess of passivity of the operator", "N·s/m"};
  chart.y = {sweep.parameter, sweep.unit};
  chart.series = {std::move(least), std::move(largest)};
  if (shortage && shortage->excess95) {
    chart.vertical = {{shortage->excess95->first, "measured, low"}, {shortage->excess95->second, "measured, high"}};
  } else if (shortage) {
    chart.vertical = {{-shortage->a, "operator"}};
  }
  return chart;
}

Result<Rational> number(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return bad_usage("not a number");
  return bounded(value);
}

}  // namespace

Result<Question::Sweep> parse_sweep(std::string_view text) {
  const auto wrong = [&] {
    return bad_usage(fmt::format("--parameter: '{}' is not NAME=LOW:HIGH with LOW < HIGH", text),
                     "as in --parameter slave.k=0:1000, in SI units");
  };
  const auto equal = text.find('='), colon = text.find(':', equal == text.npos ? 0 : equal);
  if (equal == text.npos || equal == 0 || colon == text.npos) return wrong();
  const auto low = number(text.substr(equal + 1, colon - equal - 1)), high = number(text.substr(colon + 1));
  for (const auto* end : {&low, &high}) {
    if (!*end) return tl::unexpected(end->error().in(fmt::format("--parameter {}", text)));
  }
  if (!(*low < *high)) return wrong();
  return Question::Sweep{std::string(text.substr(0, equal)), *low, *high};
}

Result<Question::Excess> parse_excess(std::string_view text) {
  constexpr int kMax = 201;
  const auto wrong = [&] {
    return bad_usage(
        fmt::format("--excess: '{}' is not LOW:HIGH or LOW:HIGH:STEPS with LOW < HIGH, 2 to {} steps", text, kMax),
        "as in --excess 0:10, in N·s/m");
  };
  const auto first = text.find(':'), second = text.find(':', first == text.npos ? text.npos : first + 1);
  if (first == text.npos) return wrong();
  const auto low = number(text.substr(0, first)), high = number(text.substr(first + 1, second - first - 1));
  for (const auto* end : {&low, &high}) {
    if (!*end) return tl::unexpected(end->error().in(fmt::format("--excess {}", text)));
  }
  if (!(*low < *high)) return wrong();
  Question::Excess excess{*low, *high};
  if (second == text.npos) return excess;
  const std::string_view word = text.substr(second + 1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), excess.steps);
  if (error != std::errc() || end != word.data() + word.size() || excess.steps < 2 || excess.steps > kMax) {
    return wrong();
  }
  return excess;
}

Result<TeleoperationFinding> judge(const Design& design, const Question& question) {
  TeleoperationFinding finding;
  describe(design, finding);
  auto passive = judge_with(design, design.operator_port, 0);
  if (!passive) return tl::unexpected(passive.error().in(design.file));
  finding.grid = passive->grid;
  const std::vector<double> delays = delays_of(design);
  if (design.pade && !delays.empty()) {
    finding.pade_limit = pade_limit(std::get<Teleoperator>(design.network).pade_order, std::ranges::max(delays));
  }

  finding.operator_shortage = question.operator_shortage;
  if (design.shortage) {
    if (question.operator_shortage) {
      return bad_usage("a of the operator is given both by --operator and by shortage_N_s_per_m",
                       "keep one of the two");
    }
    finding.operator_shortage = OperatorShortage{lti::to_double(*design.shortage), "[operator] of the design", {}};
  }
  Rational a = 0;
  if (finding.operator_shortage) {
    const auto exact = bounded(finding.operator_shortage->a);
    if (!exact) return tl::unexpected(exact.error().in("a of the operator"));
    a = *exact;
    auto with = judge_with(design, design.operator_port, a);
    if (!with) return tl::unexpected(with.error().in(design.file));
    finding.with_operator = std::move(with->stability);
    finding.operator_grid = with->grid;
  }
  for (const Port port : {Port::one, Port::two}) {
    auto largest = largest_shortage_of(design, port);
    if (!largest) return tl::unexpected(largest.error().in(design.file));
    finding.largest_shortages.push_back(*largest);
  }
  if (question.sweep) {
    finding.admissible = MBK_TRY(sweep(design, *question.sweep, a, question.sweep_progress));
  }
  if (question.excess) {
    if (!question.sweep)
      return bad_usage("--excess needs a parameter to sweep", "name one, as in --parameter slave.k=0:1000");
    auto swept = MBK_TRY(sweep_excess(design, *question.sweep, *question.excess, question.progress));
    swept.chart = excess_chart(swept, finding.operator_shortage);
    finding.excess = std::move(swept);
  }

  const auto* const teleoperator = std::get_if<Teleoperator>(&design.network);
  const TwoPort two_port = MBK_TRY(design.equations().at(0));
  const TwoPort at_once = teleoperator != nullptr ? MBK_TRY(teleoperator->without_delay().at(0)) : two_port;
  Immittance immittance = [&](RadPerSec omega) -> Eigen::MatrixXcd { return two_port.matrix(omega); };
  if (design.has_true_delay()) {
    immittance = [&](RadPerSec omega) -> Eigen::MatrixXcd {
      return teleop::immittance(teleoperator->with_exact_delay(omega), Form::z);
    };
  }
  const FrequencyGrid range = design.exact_delay
                                  ? *design.exact_delay
                                  : range_of_charts(at_once, delays, passive->stability, finding.pade_limit);
  finding.charts = charts(immittance, chart_frequencies(range, passive->stability), passive->stability.form);
  finding.stability = std::move(passive->stability);
  add_notes_on_delay(design, question, finding);
  return finding;
}

}  // namespace mbk::teleop
