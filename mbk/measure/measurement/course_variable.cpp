#include "mbk/measure/measurement/course_variable.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/measure/explore/reference_onsets.h"
#include "mbk/measure/preprocess/band.h"

namespace mbk::measurement {
namespace course_variable_detail {

/// Instants of one trial to which it is aligned, [s] from its first row.
std::vector<double> instants_of(const ExplorationTrial& trial, const std::string& align) {
  std::vector<double> instants;
  if (align == kAlignOnReference) {
    constexpr double kRest = 0.1;  // [s]
    const Index rest = std::max<Index>(2, std::llround(kRest / trial.sample_time));
    for (const explore::Onset& onset : explore::reference_onsets(trial.reference, rest)) {
      instants.push_back(static_cast<double>(onset.sample) * trial.sample_time);
    }
    return instants;
  }
  for (const Event& event : trial.events) {
    if (event.name == align) instants.push_back(event.time - trial.from_s);
  }
  std::ranges::sort(instants);
  return instants;
}

tl::unexpected<Error> nothing_to_align(std::span<const ExplorationTrial> trials, const std::string& align) {
  if (align == kAlignOnReference) {
    return bad_data("the reference never steps from rest", "name an event with --align, or omit it");
  }
  std::set<std::string> names;
  for (const ExplorationTrial& trial : trials) {
    for (const Event& event : trial.events) names.insert(event.name);
  }
  if (names.empty()) {
    return bad_data(fmt::format("there is no event '{}': no events were recorded", align), "use --align reference");
  }
  return bad_data(fmt::format("there is no event '{}'; the events are {}", align, fmt::join(names, ", ")),
                  "name one of them with --align, or use --align reference");
}

Result<explore::CourseVariable> aligned(std::span<const ExplorationTrial> trials, const std::string& align) {
  constexpr double kBefore = 1.0, kShortest = 0.5, kBetween = 0.1;  // [s]
  std::vector<std::vector<double>> all;
  double gap = 1e9, before = kBefore;
  Index count = 0;
  for (const ExplorationTrial& trial : trials) {
    const double duration = static_cast<double>(trial.samples()) * trial.sample_time;
    std::vector<double> instants = instants_of(trial, align);
    std::erase_if(instants, [&](double instant) { return instant < 0.0 || instant >= duration; });
    for (std::size_t k = 0; k + 1 < instants.size(); ++k) gap = std::min(gap, instants[k + 1] - instants[k]);
    if (!instants.empty()) before = std::min(before, instants.front());
    count += static_cast<Index>(instants.size());
    all.push_back(std::move(instants));
  }
  if (count == 0) return nothing_to_align(trials, align);
  before = std::min(before, 0.25 * gap);
  double after = gap - before - kBetween;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (all[k].empty()) continue;
    const double duration = static_cast<double>(trials[k].samples()) * trials[k].sample_time;
    after = std::min(after, duration - all[k].back());
  }
  if (after < kShortest) {
    return bad_data(fmt::format("only {:.2g} s follow each '{}' before the next one or the end", after, align),
                    "align to a less frequent event");
  }
  explore::CourseVariable variable;
  variable.name = align == kAlignOnReference ? "time since the onset of the reference"
                                             : fmt::format("time since the event '{}'", align);
  variable.repetitions = count;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    Vector values = Vector::Constant(trials[k].samples(), kNaN);
    for (const double instant : all[k]) {
      const double step = trials[k].sample_time;
      const auto begin = std::max<Index>(0, static_cast<Index>(std::ceil((instant - before) / step - 1e-9)));
      const auto end = std::min<Index>(values.size(), static_cast<Index>(std::floor((instant + after) / step + 1e-9)));
      for (Index i = begin; i < end; ++i) values[i] = static_cast<double>(i) * step - instant;
    }
    variable.values.push_back(std::move(values));
  }
  return variable;
}

}  // namespace course_variable_detail

Result<explore::CourseVariable> course_variable(std::span<const ExplorationTrial> trials, bool scheduled,
                                                const std::optional<std::string>& align) {
  if (align) return course_variable_detail::aligned(trials, *align);
  explore::CourseVariable variable;
  variable.repetitions = static_cast<Index>(trials.size());
  if (scheduled) {
    variable.name = trials.front().scheduling_label.name;
    variable.unit = trials.front().scheduling_label.unit;
    variable.repetitions = 1;
    for (const ExplorationTrial& trial : trials) variable.values.push_back(trial.scheduling);
    return variable;
  }
  for (const ExplorationTrial& trial : trials) {
    const Index rows = trial.samples();
    variable.values.push_back(
        Vector::LinSpaced(rows, trial.from_s, trial.from_s + static_cast<double>(rows - 1) * trial.sample_time));
  }
  return variable;
}

double moved_up_to(std::span<const ExplorationTrial> trials) {
  double top = 0.0;
  for (const ExplorationTrial& trial : trials) {
    const auto band = preprocess::excited_band(Columns(trial.input), {preprocess::Cut{0, trial.samples(), {}}},
                                               Hertz(1.0 / trial.sample_time));
    top = std::max(top, band ? band->high.value : explore::kResponseBand);
  }
  return top;
}

}  // namespace mbk::measurement
