#include "mbk/study/longitudinal/stretch_curves.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "mbk/base/core/units.h"
#include "mbk/study/longitudinal/normal_range.h"
#include "mbk/study/longitudinal/stretch_extent.h"

namespace mbk::longitudinal {
namespace {

using Json = nlohmann::json;

/// A control who was stretched over less of the positions than that does not count.
constexpr double kCoveredShare = 0.8;

/// What stretches must share to be compared.
struct StretchKind {
  int direction = 1, axis = 0;
  bool turns = true;
  friend auto operator<=>(const StretchKind&, const StretchKind&) = default;
};

/// Stretches of one recording in one direction [°, °/s, N·m or mm, mm/s, N].
struct RecordedStretches {
  Vector position;
  std::map<double, Vector> torque;  ///< by speed
};
using RecordedKinds = std::map<StretchKind, RecordedStretches>;

Vector vector_of(const Json& values, double scale) {
  Vector all(static_cast<Index>(values.size()));
  for (Index i = 0; i < all.size(); ++i) {
    const Json& one = values[static_cast<std::size_t>(i)];
    all[i] = one.is_number() ? scale * one.get<double>() : kNaN;
  }
  return all;
}

/// The curves of a document of `mbk explore`; none where it has no stretches.
Result<RecordedKinds> read_stretches(const std::string& text) {
  RecordedKinds kinds;
  const Json document = Json::parse(text, nullptr, false);
  if (!document.is_object()) return damaged_stretches();
  if (!document.contains("stretch") || !document["stretch"].is_object()) return kinds;
  try {
    const Json& stretch = document["stretch"];
    const bool turns = document.at("units").at("K") == "N·m/rad";
    const double scale = turns ? kDegrees : kMillimetres;
    for (const Json& found : stretch.at("directions")) {
      RecordedStretches one{vector_of(found.at("angle"), scale), {}};
      const Vector passive = vector_of(found.at("passive"), 1.0);
      for (const Json& speed : found.at("speeds")) {
        const Vector excess = vector_of(speed.at("excess"), 1.0);
        if (passive.size() != one.position.size() || (excess.size() > 0 && excess.size() != passive.size())) {
          return damaged_stretches();
        }
        one.torque[scale * speed.at("speed").get<double>()] = excess.size() > 0 ? Vector(passive + excess) : passive;
      }
      const int direction = found.at("direction").get<int>();
      kinds[{direction, stretch.at("axis").get<int>(), turns}] = std::move(one);
    }
  } catch (const Json::exception&) {
    return damaged_stretches();
  }
  return kinds;
}

/// At a position, between those of the curve; NaN beyond them.
double torque_at(const Vector& position, const Vector& torque, double at) {
  if (position.size() == 0 || at < position[0] || at > position[position.size() - 1]) return kNaN;
  const auto* const above = std::lower_bound(position.data(), position.data() + position.size(), at);
  const Index i = above - position.data();
  if (position[i] == at) return torque[i];
  const double share = (at - position[i - 1]) / (position[i] - position[i - 1]);
  return (1.0 - share) * torque[i - 1] + share * torque[i];
}

/// Of the speed that is nearest; nothing where none is near.
const Vector* torque_near(const RecordedStretches& recorded, double speed) {
  const Vector* found = nullptr;
  double nearest = 0.0;
  for (const auto& [other, torque] : recorded.torque) {
    if (!same_speed(other, speed) || (found != nullptr && std::abs(other - speed) > nearest)) continue;
    nearest = std::abs(other - speed);
    found = &torque;
  }
  return found;
}

/// The mean over recordings that have that speed, at each position that they have; NaN elsewhere.
Vector mean_torque(const std::vector<const RecordedStretches*>& recordings, const Vector& position, double speed) {
  Vector sum = Vector::Zero(position.size()), count = Vector::Zero(position.size());
  for (const RecordedStretches* const one : recordings) {
    const Vector* const torque = torque_near(*one, speed);
    for (Index i = 0; torque != nullptr && i < position.size(); ++i) {
      const double value = torque_at(one->position, *torque, position[i]);
      if (!std::isfinite(value)) continue;
      sum[i] += value;
      count[i] += 1.0;
    }
  }
  return (count.array() > 0.0).select(sum.cwiseQuotient(count.cwiseMax(1.0)), kNaN);
}

/// The recordings of a person's last session under one condition.
struct LastStretches {
  std::int64_t session = 0;
  std::vector<RecordedKinds> recordings;

  [[nodiscard]] std::vector<const RecordedStretches*> of(const StretchKind& kind) const {
    std::vector<const RecordedStretches*> found;
    for (const RecordedKinds& one : recordings) {
      if (const auto there = one.find(kind); there != one.end()) found.push_back(&there->second);
    }
    return found;
  }
};

/// Positions of the first recording that all have, so that the mean has no steps.
Vector common_positions(const std::vector<const RecordedStretches*>& recordings) {
  std::vector<double> common;
  for (const double at : recordings.front()->position) {
    const bool all = std::ranges::all_of(recordings, [&](const RecordedStretches* one) {
      return one->position.size() > 0 && at >= one->position[0] && at <= one->position[one->position.size() - 1];
    });
    if (all) common.push_back(at);
  }
  return Eigen::Map<const Vector>(common.data(), static_cast<Index>(common.size()));
}

StretchCurve curve_of(double speed, const std::vector<const RecordedStretches*>& own, const Vector& position,
                      const std::vector<std::vector<const RecordedStretches*>>& controls) {
  const Index count = position.size();
  StretchCurve curve{.speed = speed,
                     .torque = mean_torque(own, position, speed),
                     .mean = Vector::Constant(count, kNaN),
                     .low95 = Vector::Constant(count, kNaN),
                     .high95 = Vector::Constant(count, kNaN)};
  std::vector<Vector> others;
  for (const auto& one : controls) {
    Vector torque = mean_torque(one, position, speed);
    const auto covered = static_cast<double>(torque.array().isFinite().count());
    if (covered >= kCoveredShare * static_cast<double>(count)) others.push_back(std::move(torque));
  }
  curve.controls = static_cast<int>(others.size());
  for (Index i = 0; i < count; ++i) {
    std::vector<double> values;
    for (const Vector& one : others) values.push_back(one[i]);
    const NormalRange range = normal_range(values);
    curve.mean[i] = range.mean;
    std::tie(curve.low95[i], curve.high95[i]) = range.range95;
  }
  // What is compared with NaN is beyond nothing.
  if (const auto known = static_cast<double>(curve.low95.array().isFinite().count()); known > 0.0) {
    curve.above = static_cast<double>((curve.torque.array() > curve.high95.array()).count()) / known;
    curve.below = static_cast<double>((curve.torque.array() < curve.low95.array()).count()) / known;
  }
  return curve;
}

}  // namespace

Result<std::vector<StretchCurves>> stretch_curves(const store::Store& study, const store::StudyList& list,
                                                  std::int64_t participant, const std::set<std::int64_t>& controls) {
  using People = std::map<std::int64_t, LastStretches>;
  std::map<std::string, People> conditions;
  const auto counts = [&](const store::ListedRecording& one) {
    return one.state == store::RecordingState::usable &&
           (one.recording.participant == participant || controls.contains(one.recording.participant));
  };
  for (const store::ListedRecording& one : list.recordings) {
    if (!counts(one)) continue;
    std::int64_t& last = conditions[one.recording.condition][one.recording.participant].session;
    last = std::max(last, one.recording.session);
  }
  for (const store::ListedRecording& one : list.recordings) {
    if (!counts(one)) continue;
    LastStretches& last = conditions[one.recording.condition][one.recording.participant];
    if (one.recording.session != last.session) continue;
    const std::string text = MBK_TRY(study.document(one.result));
    last.recordings.push_back(MBK_TRY(read_stretches(text)));
  }
  std::vector<StretchCurves> all;
  for (const auto& [condition, people] : conditions) {
    const auto own = people.find(participant);
    if (own == people.end()) continue;
    std::set<StretchKind> kinds;
    for (const RecordedKinds& one : own->second.recordings) {
      for (const auto& [kind, recorded] : one) kinds.insert(kind);
    }
    for (const StretchKind& kind : kinds) {
      const auto recordings = own->second.of(kind);
      StretchCurves curves{.condition = condition,
                           .session = own->second.session,
                           .results = static_cast<int>(recordings.size()),
                           .direction = kind.direction,
                           .position_unit = kind.turns ? "°" : "mm",
                           .torque_unit = kind.turns ? "N·m" : "N",
                           .position = common_positions(recordings)};
      std::vector<std::vector<const RecordedStretches*>> others;
      for (const auto& [person, last] : people) {
        if (person != participant) others.push_back(last.of(kind));
      }
      for (const auto& [speed, torque] : recordings.front()->torque) {
        curves.speeds.push_back(curve_of(speed, recordings, curves.position, others));
      }
      if (curves.position.size() > 0) all.push_back(std::move(curves));
    }
  }
  return all;
}

}  // namespace mbk::longitudinal
