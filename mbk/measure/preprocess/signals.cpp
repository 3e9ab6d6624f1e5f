#include "mbk/measure/preprocess/signals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/preprocess/recording_checks.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {
namespace {

Result<Columns> require(const Recording& recording, const QuantityChannels& quantity, int axes) {
  Columns columns = channels_of(recording, quantity, axes);
  if (columns.size() > 0) return columns;
  std::string missing, present, first;
  int count = 0;
  for (Index axis = 0; axis < axes; ++axis) {
    const char* name = quantity.name(axes, axis);
    if (recording.find(name) != nullptr) continue;
    missing += fmt::format("{}'{}'", missing.empty() ? "" : " and ", name);
    if (first.empty()) first = name;
    ++count;
  }
  for (const Channel& channel : recording.channels) present += (present.empty() ? "" : ", ") + channel.name;
  return bad_data(
      fmt::format("channel{} {} {} missing (the channels are: {}){}", count == 1 ? "" : "s", missing,
                  count == 1 ? "is" : "are", present.empty() ? "none" : present, why_missing(recording, first)),
      fmt::format("name all columns with --channels, as in {}=COLUMN; 'mbk new channels FILE' guesses them", first));
}

/// What moves, by the units of position and force; where one is unknown the other decides.
Result<Motion> motion_of(const Recording& recording, int axes) {
  if (axes > 1) return Motion::translation;
  const std::string &position = recording.find("position")->unit, &reaction = recording.find("reaction")->unit;
  const bool rotates = position == "rad" || reaction == "N.m", shifts = position == "m" || reaction == "N";
  if (rotates && shifts) {
    return bad_data(fmt::format("position in {} and reaction in {} are inconsistent", position, reaction),
                    "correct the units in --channels, as in x=2:deg,F=3:N.m");
  }
  return rotates ? Motion::rotation : (shifts ? Motion::translation : Motion::unknown);
}

ReferenceQuantity reference_quantity(const Recording& recording, int axes) {
  const Channel* channel = recording.find(kReferenceChannels.name(axes, 0));
  if (channel == nullptr) return ReferenceQuantity::unknown;
  if (channel->unit == "m" || channel->unit == "rad") return ReferenceQuantity::position;
  if (channel->unit == "N" || channel->unit == "N.m") return ReferenceQuantity::force;
  return ReferenceQuantity::unknown;
}

double deviation(const Vector& values) {
  const double square = numeric::variance(values);
  return std::isfinite(square) ? std::sqrt(square) : 0.0;
}

/// Whether the hand was measured along z too, and moved along it: not that of a robot in the plane.
bool moves_in_space(const Recording& recording) {
  constexpr double kMoves = 0.05;  // of the larger motion along x or y: less is on one line or in one plane
  if (recording.find(kForceChannels.name(3, 2)) == nullptr) return false;
  const Columns position = channels_of(recording, kPositionChannels, 3);
  if (position.size() == 0) return false;
  const double plane = std::max(deviation(position.col(0)), deviation(position.col(1)));
  return deviation(position.col(2)) > kMoves * plane;
}

}  // namespace

Result<Signals> select_signals(const Recording& recording, int axes, bool acceleration_from_sensor) {
  Signals signals;
  const bool one_axis = recording.find("position") != nullptr || recording.find("reaction") != nullptr;
  signals.axes = axes != 0 ? axes : (one_axis ? 1 : (moves_in_space(recording) ? 3 : 2));
  const auto take = [&](const QuantityChannels& quantity, Columns& target) -> Result<void> {
    target = MBK_TRY(require(recording, quantity, signals.axes));
    return {};
  };
  MBK_TRY(take(kPositionChannels, signals.position));
  MBK_TRY(take(kForceChannels, signals.force_hand_on_robot));
  if (acceleration_from_sensor) {
    MBK_TRY(take(kAccelerationChannels, signals.acceleration));
  }
  signals.reference = channels_of(recording, kReferenceChannels, signals.axes);
  signals.reference_quantity = reference_quantity(recording, signals.axes);
  const auto motion = MBK_TRY(motion_of(recording, signals.axes));
  signals.motion = motion;
  return signals;
}

}  // namespace mbk::preprocess
