#include "mbk/measure/explore/alike.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mbk::explore {

Result<void> check_alike(std::span<const ExplorationTrial> trials) {
  if (trials.empty()) return bad_data("no recording was given");
  const ExplorationTrial& first = trials.front();
  for (const ExplorationTrial& trial : trials) {
    if (trial.input.cols() != first.input.cols() || trial.output.cols() != first.output.cols()) {
      return bad_data("recordings with different axes have no common frequency response", "explore them one by one",
                      trial.source.label());
    }
    if (std::abs(trial.sample_time - first.sample_time) > 1e-6 * first.sample_time) {
      return bad_data(
          fmt::format(
              "the sample rates are {:.6g} Hz and {:.6g} Hz; only recordings with the same rate can be averaged",
              1.0 / trial.sample_time, 1.0 / first.sample_time),
          "resample them to one rate with --resample", trial.source.label());
    }
  }
  return {};
}

bool all_have_reference(std::span<const ExplorationTrial> trials) {
  return std::ranges::all_of(trials, [](const ExplorationTrial& trial) { return trial.reference.size() > 0; });
}

}  // namespace mbk::explore
