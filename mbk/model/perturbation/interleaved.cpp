#include "mbk/model/perturbation/interleaved.h"

#include <fmt/format.h>

#include <algorithm>

namespace mbk::perturbation {

Result<std::vector<Multisine>> interleaved(const Multisine& signal, int axes) {
  std::vector<Multisine::Line> lines = signal.lines();
  const auto count = static_cast<std::size_t>(axes);
  if (count == 2 && lines.size() < 2)
    return bad_usage("one harmonic cannot be split between two axes", "give at least two harmonics");
  if (lines.size() < count) {
    return bad_usage(fmt::format("{} harmonics cannot be split between {} axes", lines.size(), count),
                     fmt::format("give at least {} harmonics", count));
  }
  std::ranges::sort(lines, {}, &Multisine::Line::harmonic);
  std::vector<std::vector<Multisine::Line>> parts(count);
  for (std::size_t i = 0; i < lines.size(); ++i) parts[i % count].push_back(lines[i]);
  std::vector<Multisine> all;
  for (std::vector<Multisine::Line>& part : parts) {
    auto axis = MBK_TRY(Multisine::create(signal.period(), std::move(part)));
    all.push_back(std::move(axis));
  }
  return all;
}

}  // namespace mbk::perturbation
