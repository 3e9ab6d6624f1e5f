#include "mbk/model/perturbation/axis_pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mbk/model/perturbation/largest_value.h"

namespace mbk::perturbation {
namespace {

Result<void> check_period(const Multisine& first, const Multisine& second) {
  if (first.period() == second.period()) return {};
  return bad_usage(
      fmt::format("period {} s of the first axis is not that of the second, {} s", first.period(), second.period()),
      "give both axes the same period");
}

std::set<int> harmonics(const Multisine& signal) {
  std::set<int> found;
  for (const Multisine::Line& line : signal.lines()) found.insert(line.harmonic);
  return found;
}

}  // namespace

Result<double> peak_norm(const AxisPair& pair) {
  MBK_TRY(check_period(pair.first, pair.second));
  const int samples = 64 * std::max(*harmonics(pair.first).rbegin(), *harmonics(pair.second).rbegin());
  const auto norm = [&](double t) { return std::hypot(pair.first.at(t).value, pair.second.at(t).value); };
  std::vector<double> times, values;
  for (int k = 0; k <= samples; ++k) {
    times.push_back(pair.first.period() * k / samples);
    values.push_back(norm(times.back()));
  }
  return largest_value(times, values, norm).value;
}

Result<AxisPair> interleaved(const Multisine& signal) {
  if (signal.lines().size() < 2) return bad_usage("one line cannot go to two axes", "give at least two lines");
  std::vector<Multisine::Line> lines = signal.lines();
  std::ranges::sort(lines, {}, &Multisine::Line::harmonic);
  std::array<std::vector<Multisine::Line>, 2> axes;
  for (std::size_t i = 0; i < lines.size(); ++i) axes[i % 2].push_back(lines[i]);
  auto first = Multisine::create(signal.period(), std::move(axes[0]));
  auto second = Multisine::create(signal.period(), std::move(axes[1]));
  if (!first) return tl::unexpected(first.error());
  if (!second) return tl::unexpected(second.error());
  return AxisPair{*std::move(first), *std::move(second)};
}

Result<std::array<AxisPair, 2>> hadamard_experiments(const Multisine& first, const Multisine& second) {
  MBK_TRY(check_period(first, second));
  if (harmonics(first) != harmonics(second)) {
    return bad_usage("the axes have different harmonics", "give both the same, or interleave them");
  }
  return std::array<AxisPair, 2>{AxisPair{first, second}, AxisPair{first, second.scaled(-1.0)}};
}

}  // namespace mbk::perturbation
