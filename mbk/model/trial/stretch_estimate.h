#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/findings.h"

namespace mbk {

/// Whether the torque that resists a stretch rises with its speed by more than a passive viscosity explains.
enum class VelocityDependence { velocity_dependent, not_shown, cannot_be_judged };

[[nodiscard]] constexpr auto word_table(VelocityDependence) {
  using enum VelocityDependence;
  return std::to_array<Word<VelocityDependence>>(
      {{velocity_dependent, "velocity-dependent"}, {not_shown, "not-shown"}, {cannot_be_judged, "cannot-be-judged"}});
}

/// Whether the torque of stretches at one speed rises abruptly.
enum class CatchFinding { found, none, cannot_be_judged };

[[nodiscard]] constexpr auto word_table(CatchFinding) {
  using enum CatchFinding;
  return std::to_array<Word<CatchFinding>>({{found, "found"}, {none, "none"}, {cannot_be_judged, "cannot-be-judged"}});
}

/// An estimate with its 95 % interval, which is absent where the data give none.
struct StretchValue {
  double value = 0;
  std::optional<Interval> interval95;
};

/// A movement at constant velocity.
struct StretchMovement {
  int recording = 0;            ///< 0 for the first
  double from_s = 0, to_s = 0;  ///< the plateau of velocity, on the clock of its recording [s]
  double from = 0, to = 0;      ///< position at its begin and end [rad]
  double speed = 0;             ///< mean |velocity| on it [rad/s]
  double mean_torque = 0;       ///< that resists, mean over the analysed angles [N·m]
  double begin_s = 0;           ///< where it leaves rest [s]
  double end_s = 0;             ///< where it comes to rest [s]
};

/// Stretches of one direction at one speed.
struct StretchSpeed {
  double speed = 0;          ///< mean [rad/s]
  int repetitions = 0;       ///< stretches
  StretchValue mean_torque;  ///< that resists, over the analysed angles [N·m]
  Vector excess;             ///< by angle: resisting torque less the passive curve [N·m]; empty for the slowest speed
  CatchFinding catch_finding = CatchFinding::cannot_be_judged;
  std::optional<StretchValue> catch_angle;  ///< if a catch was found [rad]
  std::optional<StretchValue> work;  ///< that the limb absorbs in stretch and return over the analysed angles [J]
};

/// EMG of one muscle in the stretches of one direction at one speed.
struct StretchMuscleSpeed {
  double speed = 0;                         ///< mean [rad/s]
  int stretches = 0;                        ///< with a rest before them, from which the background follows
  int onsets = 0;                           ///< of them with an onset of the EMG
  std::optional<StretchValue> onset_angle;  ///< mean position at these onsets [rad]
};

/// EMG of one muscle in the stretches of one direction.
struct StretchMuscle {
  std::string name;                        ///< of the channel
  bool usable = true;                      ///< false: its onsets were not sought
  std::string reason;                      ///< why it is not usable
  std::vector<StretchMuscleSpeed> speeds;  ///< as StretchDirection::speeds; empty if not usable
  std::optional<StretchValue> threshold;   ///< onset extrapolated to speed 0: tonic stretch reflex threshold λ [rad]
  std::optional<double> shift;             ///< change of the onset angle with speed [rad/(rad/s)]
  std::string threshold_note;              ///< why the threshold is absent, or what it rests on
  /// Whether the EMG rose in any stretch.
  [[nodiscard]] bool responds() const {
    return std::any_of(speeds.begin(), speeds.end(), [](const StretchMuscleSpeed& one) { return one.onsets > 0; });
  }
};

/// Stretches in one direction.
struct StretchDirection {
  int direction = 1;                 ///< 1: the position increases, −1: it decreases
  Interval range;                    ///< analysed positions, common to all speeds [rad]
  Vector angle;                      ///< centres of the bins in it, increasing [rad]
  Vector passive;                    ///< mean torque of the slowest stretches by angle [N·m]
  std::vector<StretchSpeed> speeds;  ///< increasing
  StretchValue slope;                ///< of the mean resisting torque over speed [N·m·s/rad]
  StretchValue rise;                 ///< the same of last third less first third of the stretch [N·m·s/rad]
  std::string interval_basis;        ///< what the intervals of slope and rise rest on
  VelocityDependence verdict = VelocityDependence::cannot_be_judged;
  std::string verdict_reason;
  std::optional<StretchValue> reflex_threshold;  ///< catch angle extrapolated to speed 0 [rad]
  std::optional<double> threshold_shift;         ///< its change with speed [rad/(rad/s)]
  std::string threshold_note;                    ///< why it is absent, or what it is worth
  std::vector<StretchMovement> stretches;
  std::vector<StretchMuscle> muscles;  ///< channels emg_* that all recordings have
};

/// Resistance of a limb to stretches at several constant velocities.
struct StretchEstimate {
  int axis = 0;                               ///< that was stretched, 0 for the first
  double inertia = 0;                         ///< whose torque was subtracted [kg·m²]
  std::optional<StretchValue> inertia_found;  ///< from the acceleration phases [kg·m²]
  std::vector<StretchDirection> directions;   ///< the one with more speeds first; then that of the first movement
  std::vector<std::string> limits;            ///< what these data cannot show
  bool usable = true;
};

}  // namespace mbk
