#include "mbk/measure/explore/frequency_response_of.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace mbk::explore {
namespace {

bool by_pulses(std::span<const ExplorationTrial> trials) {
  return std::ranges::any_of(trials, [](const ExplorationTrial& trial) {
    return trial.protocol == Protocol::underdamped && trial.reference.size() > 0;
  });
}

std::string periods_text(const FrequencyResponseEstimate& found) {
  const PeriodicFacts& facts = *found.periodic;
  return fmt::format("the {} repeats every {:g} s{}; {} realisation{} of {} period{}{}",
                     found.by_reference ? "reference" : "input", facts.period_s, facts.period_found ? "" : ", as given",
                     facts.realisations, facts.realisations == 1 ? "" : "s", facts.periods,
                     facts.periods == 1 ? "" : "s", facts.realisations > 1 ? " or more" : "");
}

}  // namespace

Result<FrequencyResponseEstimate> frequency_response(std::span<const ExplorationTrial> trials,
                                                     const FrequencyResponseOptions& options) {
  using enum FrequencyResponseMethod;
  const auto requested = [&](FrequencyResponseMethod method) { return !options.method || *options.method == method; };
  const std::string given = options.method ? "as requested; " : "";
  std::string refused;
  if (requested(robust) || requested(fast)) {
    if (!options.method && by_pulses(trials)) {
      refused = "pulses are not periodic; ";
    } else {
      auto found = periodic_response(trials, {options.period_s, options.max_frequency_hz, options.method == fast});
      if (found && options.method == robust && found->method != robust) {
        return bad_data(fmt::format("the robust method needs several realisations, but there {} {}",
                                    found->periodic->realisations == 1 ? "is" : "are", found->periodic->realisations),
                        "record trials with different phases, or use --method fast");
      }
      if (found) {
        found->method_rule = given + periods_text(*found);
        return found;
      }
      if (options.method || found.error().kind == ErrorKind::usage) return found;
      refused = found.error().message + "; ";
    }
  }
  if (requested(local_polynomial)) {
    auto found = local_polynomial_response(trials, {1.0 / options.segment_s, options.max_frequency_hz});
    if (found) found->method_rule = given + refused + "suitable for any perturbation";
    if (found || options.method || found.error().kind == ErrorKind::usage) return found;
    refused += found.error().message + "; ";
  }
  auto found = welch_response(trials, {options.segment_s, options.max_frequency_hz});
  if (found) found->method_rule = given + refused + "suitable for any perturbation";
  return found;
}

std::vector<Warning> warnings_of(const FrequencyResponseEstimate& found) {
  std::vector<Warning> warnings;
  for (Index i = 0; i < found.multiple_coherence.cols(); ++i) {
    constexpr double kHalf = 0.5;
    const Vector coherence = found.multiple_coherence.col(i);
    const Index low = (coherence.array() < kHalf).count();
    if (2 * low <= coherence.size()) continue;
    warnings.push_back(
        {WarningCode::low_coherence,
         fmt::format("at {} of {} frequencies less than half of {} follows the motion: noise, or a nonlinear limb", low,
                     coherence.size(), found.outputs[static_cast<std::size_t>(i)].name),
         "perturb more strongly, average more trials, or choose --max-frequency within the excited band"});
    break;
  }
  if (!found.periodic) return warnings;
  const PeriodicFacts& facts = *found.periodic;
  constexpr double kFew = 3.0;
  if (found.method == FrequencyResponseMethod::robust && found.degrees_of_freedom[0] < kFew) {
    warnings.push_back(
        {WarningCode::few_realisations,
         fmt::format("{} realisations leave {:g} degree{} of freedom for the intervals, which are wide",
                     facts.realisations, found.degrees_of_freedom[0], found.degrees_of_freedom[0] == 1.0 ? "" : "s"),
         "add trials with different phases of the perturbation"});
  }
  const bool by_realisations = facts.total_over_noise && facts.total_over_noise_p < 0.01;
  const bool by_lines = (facts.even && facts.even->detected()) || (facts.odd_lines && facts.odd_lines->detected());
  if (by_realisations || by_lines) {
    warnings.push_back({WarningCode::nonlinear_distortion,
                        by_realisations ? fmt::format("the variance between realisations is {:.3g} times that of "
                                                      "noise: the limb is nonlinear at this amplitude of perturbation",
                                                      *facts.total_over_noise)
                                        : "lines that the perturbation does not excite contain more than noise: the "
                                          "limb is nonlinear at this amplitude of perturbation",
                        "perturb less, and compare the responses"});
  }
  return warnings;
}

}  // namespace mbk::explore
