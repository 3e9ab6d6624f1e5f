#include "mbk/study/longitudinal/stretch_extent.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/units.h"

namespace mbk::longitudinal {
namespace {

/// Largest difference of speeds that are the same, as a share of the faster one.
constexpr double kSameSpeed = 0.1;

/// Positions of each result that both results must have.
constexpr double kSharedPositions = 0.8;

constexpr std::string_view kStretchOutcome = "stretch_";

/// What an outcome of stretches depends on, apart from the limb.
struct ExtentDependence {
  int direction = 1;
  bool speed = false;
};

/// Nothing for outcomes that are not of stretches.
std::optional<ExtentDependence> dependence_of(std::string_view outcome) {
  if (!outcome.starts_with(kStretchOutcome)) return std::nullopt;
  const bool range_alone = outcome.ends_with("_slope") || outcome.ends_with("_rise") || outcome.ends_with("_threshold");
  return ExtentDependence{outcome.starts_with("stretch_decreasing") ? -1 : 1, !range_alone};
}

bool same_positions(const StretchExtent& one, const StretchExtent& other) {
  const double shared = std::min(one.to, other.to) - std::max(one.from, other.from);
  return shared >= kSharedPositions * std::max(one.to - one.from, other.to - other.from);
}

/// A clause; "": comparable.
std::string difference_between(const StretchExtent* one, const StretchExtent* other, bool speed,
                               std::string_view before_one, std::string_view before_other) {
  if (one == nullptr || other == nullptr) return "the stretched positions are not known";
  if (one->unit != other->unit || !same_positions(*one, *other)) {
    return fmt::format("{}{:.0f} to {:.0f}{}, {}{:.0f} to {:.0f}{}", before_one, one->from, one->to,
                       one->unit == "°" ? "°" : " " + one->unit, before_other, other->from, other->to,
                       other->unit == "°" ? "°" : " " + other->unit);
  }
  if (speed && !same_speed(one->fastest, other->fastest)) {
    return fmt::format("{}{:.0f} {}/s, {}{:.0f} {}/s", before_one, one->fastest, one->unit, before_other,
                       other->fastest, other->unit);
  }
  return "";
}

}  // namespace

bool same_speed(double one, double other) {
  return std::abs(one - other) <= kSameSpeed * std::max(one, other);
}

tl::unexpected<Error> damaged_stretches() {
  return bad_data("a stored result of stretches cannot be read", "'mbk study check' finds what is damaged");
}

void StretchExtents::set(std::int64_t recording, int direction, StretchExtent extent) {
  recordings_[recording][direction] = std::move(extent);
}

const StretchExtent* StretchExtents::of(std::int64_t recording, int direction) const {
  const auto found = recordings_.find(recording);
  if (found == recordings_.end()) return nullptr;
  const auto extent = found->second.find(direction);
  return extent == found->second.end() ? nullptr : &extent->second;
}

std::string StretchExtents::difference(const std::string& outcome, const std::vector<std::int64_t>& one,
                                       const std::vector<std::int64_t>& other, std::string_view before_one,
                                       std::string_view before_other) const {
  const auto depends = dependence_of(outcome);
  if (!depends) return "";
  const auto first_difference = [&](const std::vector<std::int64_t>& a, const std::vector<std::int64_t>& b,
                                    std::string_view before_a, std::string_view before_b) -> std::string {
    for (const std::int64_t first : a) {
      for (const std::int64_t second : b) {
        std::string found = difference_between(of(first, depends->direction), of(second, depends->direction),
                                               depends->speed, before_a, before_b);
        if (!found.empty()) return found;
      }
    }
    return "";
  };
  for (const auto* const set : {&one, &other}) {
    const std::string within = first_difference(*set, *set, "recordings of one session, ", "and ");
    if (!within.empty()) return within;
  }
  return first_difference(one, other, before_one, before_other);
}

Result<StretchExtents> stretch_extents(const store::Store& study, const store::StudyList& list,
                                       const store::OutcomeColumns& columns) {
  using Json = nlohmann::json;
  StretchExtents extents;
  const auto is_of_stretches = [](const store::OutcomeColumn& one) { return one.name.starts_with(kStretchOutcome); };
  if (std::ranges::none_of(columns.outcomes, is_of_stretches)) return extents;
  for (const store::ListedRecording& one : list.recordings) {
    if (one.state != store::RecordingState::usable) continue;
    const std::string text = MBK_TRY(study.document(one.result));
    const Json document = Json::parse(text, nullptr, false);
    if (!document.is_object()) return damaged_stretches();
    if (!document.contains("stretch") || !document["stretch"].is_object()) continue;
    try {
      const bool turns = document.at("units").at("K") == "N·m/rad";
      const double scale = turns ? kDegrees : kMillimetres;
      for (const Json& found : document["stretch"].at("directions")) {
        const Json& speeds = found.at("speeds");
        if (speeds.empty()) continue;
        extents.set(one.recording.number, found.at("direction").get<int>(),
                    {.fastest = scale * speeds.back().at("speed").get<double>(),
                     .from = scale * found.at("range").at(0).get<double>(),
                     .to = scale * found.at("range").at(1).get<double>(),
                     .unit = turns ? "°" : "mm"});
      }
    } catch (const Json::exception&) {
      return damaged_stretches();
    }
  }
  return extents;
}

store::OutcomeColumns comparable_columns(store::OutcomeColumns columns, const StretchExtents& extents,
                                         std::int64_t participant) {
  for (store::OutcomeColumn& column : columns.outcomes) {
    if (!column.name.starts_with(kStretchOutcome)) continue;
    struct Reference {
      std::int64_t session = 0;
      std::vector<std::int64_t> recordings;
    };
    std::map<int, Reference> references;  // by condition
    for (std::size_t k = 0; k < columns.trials.size(); ++k) {
      const store::TrialRow& trial = columns.trials[k];
      if (trial.participant != participant || !std::isfinite(column.values[k])) continue;
      Reference& last = references[trial.condition];
      if (trial.session > last.session) last = {trial.session, {}};
      if (trial.session == last.session) last.recordings.push_back(trial.recording);
    }
    std::erase_if(references,
                  [&](const auto& one) { return !extents.comparable(column.name, one.second.recordings, {}); });
    for (std::size_t k = 0; k < columns.trials.size(); ++k) {
      const auto own = references.find(columns.trials[k].condition);
      if (own == references.end() ||
          extents.comparable(column.name, {columns.trials[k].recording}, own->second.recordings)) {
        continue;
      }
      column.values[k] = kNaN;
      if (!column.standard_errors.empty()) column.standard_errors[k] = kNaN;
    }
  }
  return columns;
}

}  // namespace mbk::longitudinal
