#include "mbk/model/perturbation/axis_pair.h"

#include <algorithm>
#include <array>

namespace mbk::perturbation {
Result<AxisPair> interleaved(const Multisine& signal) {
  if (signal.lines().size() < 2)
    return bad_usage("one harmonic cannot be split between two axes", "give at least two harmonics");
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

}  // namespace mbk::perturbation
