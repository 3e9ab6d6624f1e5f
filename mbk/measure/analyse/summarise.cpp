#include "mbk/measure/analyse/summarise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::analyse {
namespace {

std::string file_of(const Identification& id) {
  return id.sources.empty() ? "" : id.sources.front().label();
}

/// A property that trials of one mean share; empty where a trial does not say it.
using Property = std::pair<const char*, std::string>;

std::vector<Property> properties_of(const Identification& id) {
  std::vector<Property> all = {{"axes", std::to_string(id.axes)},
                               {"unit", units_of(id.motion).stiffness},
                               {"method", std::string(word_of(id.method))},
                               {"structure", std::string(word_of(id.structure))},
                               {"handle mass", fmt::format("{:g} kg", id.handle_mass)}};
  if (!id.conditions.empty()) {
    const TrialConditions& said = id.conditions.front();
    all.insert(all.end(),
               {{"participant", said.participant}, {"condition", said.condition}, {"posture", said.posture}});
  }
  if (!id.preparations.empty()) {
    const Preparation& how = id.preparations.front();
    all.insert(all.end(), {{"protocol", std::string(word_of(how.protocol))},
                           {"mode", std::string(word_of(how.mode))},
                           {"force source", std::string(word_of(how.force_source))}});
  }
  return all;
}

Result<void> check_alike(const Identification& first, const Identification& other) {
  const std::vector<Property> ours = properties_of(first), theirs = properties_of(other);
  for (const auto& [name, value] : ours) {
    const auto twin = std::ranges::find(theirs, std::string_view(name),
                                        [](const Property& one) { return std::string_view(one.first); });
    if (twin == theirs.end() || value.empty() || twin->second.empty() || twin->second == value) continue;
    return bad_data(fmt::format("the recordings differ in {}: '{}' in {}, '{}' in {}", name, value, file_of(first),
                                twin->second, file_of(other)),
                    "measure only recordings of the same kind in one command");
  }
  return {};
}

}  // namespace

Result<Summary> summarise(const std::vector<Identification>& identifications) {
  Summary summary;
  std::vector<const Identification*> kept;
  std::vector<std::pair<std::string, std::string>> seen;  // hash with trial, and file
  for (const Identification& one : identifications) {
    const bool single = one.sources.size() == 1 && !one.sources.front().sha256.empty();
    const std::string hash = single ? one.sources.front().sha256 + " " + one.sources.front().trial : "";
    const auto twin = std::ranges::find(seen, hash, &std::pair<std::string, std::string>::first);
    if (!hash.empty() && twin != seen.end()) {
      summary.omitted.push_back({file_of(one), fmt::format("the same file as {}", twin->second)});
      continue;
    }
    seen.emplace_back(hash, file_of(one));
    const auto excluded = std::ranges::find(one.warnings, WarningCode::excluded_trial, &Warning::code);
    if (!one.usable) {
      summary.omitted.push_back({file_of(one), "not usable"});
    } else if (excluded != one.warnings.end()) {
      summary.omitted.push_back({file_of(one), excluded->message});
    } else {
      kept.push_back(&one);
    }
  }
  if (kept.size() < 2) {
    std::string message = "fewer than two usable, different trials";
    for (const OmittedTrial& one : summary.omitted) message += fmt::format("; {}: {}", one.file, one.why);
    return bad_data(std::move(message), "record more trials");
  }
  const Identification& first = *kept.front();
  for (const Identification* one : kept) {
    MBK_TRY(check_alike(first, *one));
  }
  const auto count = static_cast<double>(kept.size());
  const double t = numeric::student_quantile(0.975, static_cast<int>(kept.size()) - 1);
  summary.trials = static_cast<int>(kept.size());
  summary.method = first.method;
  summary.motion = first.motion;
  const auto over_trials = [&](auto part) {  // part: pointer to one member of impedance::Model
    using Member = std::remove_cvref_t<decltype(summary.mean.*part)>;
    Member mean = first.model.*part, squares = mean;
    mean.setZero();
    squares.setZero();
    for (const Identification* one : kept) mean += one->model.*part / count;
    for (const Identification* one : kept) squares += (one->model.*part - mean).cwiseAbs2();
    summary.mean.*part = mean;
    summary.between_trial_standard_error.*part = (squares / ((count - 1.0) * count)).cwiseSqrt();
    summary.half_width95.*part = t * summary.between_trial_standard_error.*part;
  };
  over_trials(&impedance::Model::M);
  over_trials(&impedance::Model::B);
  over_trials(&impedance::Model::K);
  over_trials(&impedance::Model::x0);
  return summary;
}

}  // namespace mbk::analyse
