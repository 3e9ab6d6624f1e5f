#include "mbk/present/result/exploration_parts_json.h"

namespace mbk {

using document::Fields;
using document::kDigits;
using document::kTimeDigits;

void describe(Fields<StretchValue>& fields) {
  fields.type("StretchValue", "An estimate from stretches at constant velocity.");
  fields.add("value", &StretchValue::value);
  fields.add("interval95", &StretchValue::interval95, "absent if the data give none");
}

void describe(Fields<StretchMovement>& fields) {
  fields.type("StretchMovement", "A movement at constant velocity.");
  fields.add("input", &StretchMovement::recording, "0 for the first of `inputs`");
  fields.add_rounded("from_s", &StretchMovement::from_s, kTimeDigits,
                     "start of the plateau of velocity, from the recording's first sample [s]");
  fields.add_rounded("to_s", &StretchMovement::to_s, kTimeDigits, "its end [s]");
  fields.add_rounded("from", &StretchMovement::from, kDigits, "position at the start [rad or m]");
  fields.add_rounded("to", &StretchMovement::to, kDigits, "position at the end [rad or m]");
  fields.add_rounded("speed", &StretchMovement::speed, kDigits, "mean on the plateau [rad/s or m/s]");
  fields.add_rounded("mean_torque", &StretchMovement::mean_torque, kDigits,
                     "that resists, mean over the analysed positions [N·m or N]");
  fields.add_rounded("begin_s", &StretchMovement::begin_s, kTimeDigits, "where the movement leaves rest [s]");
  fields.add_rounded("end_s", &StretchMovement::end_s, kTimeDigits, "where it comes to rest [s]");
}

void describe(Fields<StretchSpeed>& fields) {
  fields.type("StretchSpeed", "Stretches in one direction at one speed.");
  fields.add("speed", &StretchSpeed::speed, "[rad/s or m/s]");
  fields.add("repetitions", &StretchSpeed::repetitions);
  fields.add("mean_torque", &StretchSpeed::mean_torque, "that resists, over the analysed positions [N·m or N]");
  fields.add_rounded("excess", &StretchSpeed::excess, kDigits,
                     "torque less the passive curve, at the positions in `angle`; empty for the slowest speed");
  fields.add("catch", &StretchSpeed::catch_finding, "whether torque rises within the stretch");
  fields.add("catch_angle", &StretchSpeed::catch_angle, "where it starts to rise, if a catch was found [rad or m]");
  fields.add("work", &StretchSpeed::work,
             "absorbed by the limb in stretch and return over the analysed positions [J]; absent without returns");
}

void describe(Fields<StretchMuscleSpeed>& fields) {
  fields.type("StretchMuscleSpeed", "EMG of one muscle in the stretches of one direction at one speed.");
  fields.add("speed", &StretchMuscleSpeed::speed, "[rad/s or m/s]");
  fields.add("stretches", &StretchMuscleSpeed::stretches, "with a rest before them, from which the background follows");
  fields.add("onsets", &StretchMuscleSpeed::onsets, "of them with an onset of the EMG");
  fields.add("onset_angle", &StretchMuscleSpeed::onset_angle,
             "mean position at these onsets [rad or m]; absent without onsets");
}

void describe(Fields<StretchMuscle>& fields) {
  fields.type("StretchMuscle", "EMG of one muscle in the stretches of one direction.");
  fields.add("name", &StretchMuscle::name);
  fields.add("usable", &StretchMuscle::usable);
  fields.add("reason", &StretchMuscle::reason, "why it is not usable");
  fields.add("speeds", &StretchMuscle::speeds, "increasing; empty if not usable");
  fields.add("threshold", &StretchMuscle::threshold,
             "position of the onset extrapolated to speed 0 [rad or m]; absent if it cannot be identified");
  fields.add("shift", &StretchMuscle::shift, "change of the position of the onset with speed [s]");
  fields.add("threshold_note", &StretchMuscle::threshold_note, "why the threshold is absent, or what it rests on");
}

void describe(Fields<StretchDirection>& fields) {
  fields.type("StretchDirection", "Stretches in one direction.");
  fields.add("direction", &StretchDirection::direction, "1: the position increases, −1: it decreases");
  fields.add("range", &StretchDirection::range, "analysed positions, common to all stretches [rad or m]");
  fields.add_rounded("angle", &StretchDirection::angle, kDigits, "centres of the bins of the curves [rad or m]");
  fields.add_rounded("passive", &StretchDirection::passive, kDigits,
                     "mean resisting torque of the slowest stretches [N·m or N]");
  fields.add("speeds", &StretchDirection::speeds, "increasing");
  fields.add("slope", &StretchDirection::slope, "of the mean resisting torque over speed [N·m·s/rad or N·s/m]");
  fields.add("rise", &StretchDirection::rise, "slope over speed of the torque in the last less the first third");
  fields.add("interval_basis", &StretchDirection::interval_basis, "what the intervals of slope and rise rest on");
  fields.add("verdict", &StretchDirection::verdict);
  fields.add("verdict_reason", &StretchDirection::verdict_reason);
  fields.add("reflex_threshold", &StretchDirection::reflex_threshold,
             "catch angle extrapolated to speed 0 [rad or m]; absent if it cannot be identified");
  fields.add("threshold_shift", &StretchDirection::threshold_shift, "change of the catch angle with speed [s]");
  fields.add("threshold_note", &StretchDirection::threshold_note);
  fields.add("stretches", &StretchDirection::stretches);
  fields.add("muscles", &StretchDirection::muscles, "empty without EMG");
}

void describe(Fields<StretchEstimate>& fields) {
  fields.type("StretchEstimate", "Resistance of a limb to stretches at several constant velocities.");
  fields.add("axis", &StretchEstimate::axis, "that was stretched, 0 for the first");
  fields.add("inertia", &StretchEstimate::inertia, "whose torque was subtracted [kg·m² or kg]");
  fields.add("inertia_found", &StretchEstimate::inertia_found, "from the acceleration phases [kg·m² or kg]");
  fields.add("directions", &StretchEstimate::directions, "the one with more speeds first");
  fields.add("limits", &StretchEstimate::limits, "what these data cannot show");
  fields.add("usable", &StretchEstimate::usable);
}

}  // namespace mbk
