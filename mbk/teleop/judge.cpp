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
#include "mbk/teleop/largest_shortage.h"
#include "mbk/teleop/llewellyn.h"
#include "mbk/teleop/sampled.h"

namespace mbk::teleop {
namespace {

using Immittance = std::function<Eigen::MatrixXcd(RadPerSec)>;

/// A range around everything that happens: poles and zeros of the entries, and the ends of violated bands.
FrequencyGrid range_of_charts(const TwoPort& two_port, const AbsoluteStability& stability) {
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
        for (const std::complex<double> root : lti::complex_roots(*p)) add(std::abs(root));
      }
    }
  }
  for (const StabilityOutcome& outcome : stability.conditions) {
    for (const ViolatedBand& band : outcome.violated) {
      add(band.low.value);
      add(band.high.value);
    }
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

/// How a design is judged, exactly or on a grid, with a shortage at a port.
struct Judged {
  AbsoluteStability stability;
  TwoPort two_port;  // that was judged; with an exact delay, the one without it
};

Result<Judged> judge_with(const Design& design, Port port, const Rational& a) {
  const auto two_port = MBK_TRY(design.equations().with_shortage(port, Polynomial{a}).at(0));
  if (!design.exact_delay) return Judged{llewellyn(two_port), two_port};
  auto stability = MBK_TRY(llewellyn_on_grid(std::get<Teleoperator>(design.network), *design.exact_delay, port, a));
  return Judged{std::move(stability), two_port};
}

Result<LargestShortage> largest_shortage_of(const Design& design, Port port) {
  if (!design.exact_delay) return largest_shortage(design.equations(), port);
  return largest_shortage_on_grid(std::get<Teleoperator>(design.network), *design.exact_delay, port);
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
  if (design.exact_delay) {
    finding.grid = design.exact_delay;
    finding.notes.push_back(
        "the delay is exact, so the verdict applies to the grid frequencies only: a violation between grid points is "
        "not detected; use pade instead of exact to decide every frequency");
  } else if (teleoperator.has_delay()) {
    finding.notes.push_back(
        fmt::format("each delay is a Padé approximation of order {}: the verdict is exact for this approximation; the "
                    "phase of a true delay differs above about {}/T rad/s",
                    teleoperator.pade_order, 2 * teleoperator.pade_order));
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
  if (design.exact_delay) {
    return bad_usage("--parameter: an exact delay has no polynomial form", "use pade in [delay]");
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

  Immittance immittance = [&](RadPerSec omega) -> Eigen::MatrixXcd { return passive->two_port.matrix(omega); };
  if (design.exact_delay) {
    immittance = [&](RadPerSec omega) -> Eigen::MatrixXcd {
      return teleop::immittance(std::get<Teleoperator>(design.network).with_exact_delay(omega), Form::z);
    };
  }
  const FrequencyGrid range =
      design.exact_delay ? *design.exact_delay : range_of_charts(passive->two_port, passive->stability);
  finding.charts = charts(immittance, chart_frequencies(range, passive->stability), passive->stability.form);
  finding.stability = std::move(passive->stability);
  return finding;
}

}  // namespace mbk::teleop
