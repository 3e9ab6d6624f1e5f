#include "mbk/experiment/safety/trip.h"

#include <fmt/format.h>

#include <array>

namespace mbk::safety {
namespace {

struct Words {
  Reason reason;
  std::string_view code;
  std::string_view what;    // with a unit: "the measured force was"; without: the whole sentence
  std::string_view unit;    // "" where no value belongs to it
  std::string_view advice;  // what to look at
};

constexpr std::array<Words, kReasons> kWords = {{
    {Reason::none, "none", "nothing tripped", "", ""},
    {Reason::stop_button, "stop-button", "the stop button was pressed", "", "release it, then reset"},
    {Reason::operator_stop, "operator-stop", "the operator stopped it", "", ""},
    {Reason::link_lost, "link-lost", "the robot was silent for", "s", "look at its cable, power and program"},
    {Reason::late, "late", "a command left late by", "s", "use a real-time kernel or fewer programs beside it"},
    {Reason::recording_failed, "recording-failed", "the recording could not be kept up", "",
     "look at the disk and its free space"},
    {Reason::controller_not_finite, "controller-not-finite", "the controller asked for a torque that is no number", "",
     "look at its gains and references"},
    {Reason::encoder_not_finite, "encoder-not-finite", "an encoder gave no number", "", "look at its wiring"},
    {Reason::force_not_finite, "force-not-finite", "the force sensor gave no number", "", "look at its wiring"},
    {Reason::accelerometer_not_finite, "accelerometer-not-finite", "the accelerometer gave no number", "",
     "look at its wiring"},
    {Reason::encoder_jump, "encoder-jump", "an encoder jumped by", "rad", "look at its wiring and counter"},
    {Reason::force_jump, "force-jump", "the measured force jumped by", "N", "look at the sensor's wiring, or a knock"},
    {Reason::encoder_frozen, "encoder-frozen", "an encoder stood still to the bit, under a changing torque, for", "s",
     "look at its wiring"},
    {Reason::force_frozen, "force-frozen", "the force reading stood still to the bit for", "s",
     "look at the sensor's supply"},
    {Reason::accelerometer_frozen, "accelerometer-frozen", "the accelerometer's reading stood still to the bit for",
     "s", "look at the sensor's supply"},
    {Reason::accelerometer_disagrees, "accelerometer-disagrees",
     "the accelerations by the encoders and by the accelerometer differed by", "m/s²",
     "one of the two is wrong: look at signs, mounting and wiring"},
    {Reason::measured_force, "measured-force", "the measured force was", "N",
     "somebody or something pushes the handle"},
    {Reason::speed, "speed", "the hand's speed was", "m/s", ""},
    {Reason::acceleration, "acceleration", "the hand's acceleration was", "m/s²", ""},
    {Reason::workspace, "workspace", "the hand left the workspace by", "m", ""},
    {Reason::joint_margin, "joint-margin", "what was left before a joint's limit was", "rad", ""},
    {Reason::excursion, "excursion", "the hand was away from the test location by", "m", ""},
    {Reason::tracking, "tracking", "a joint was away from its reference by", "rad",
     "look at the gains, or who holds the handle"},
    {Reason::limited_too_long, "limited-too-long", "the controller asked for more than its limits for", "s",
     "it may run away: look at its gains and at the limits"},
    {Reason::robot_fault, "robot-fault", "the robot reports a fault of its own", "", "see its manual for the code"},
    {Reason::robot_watchdog, "robot-watchdog", "the robot says that no command reached it in time", "",
     "look at its cable, and at watchdog_ms"},
    {Reason::robot_clock, "robot-clock",
     "the robot's clock was off, from one state to the next or against this one, by", "s",
     "its program must stamp each state with the time of the sample"},
    {Reason::state_old, "state-old", "the robot's states were too old by its own clock:", "s",
     "look at the network and at what delays its program"},
    {Reason::answer_late, "answer-late", "the robot obeyed a command that was too old:", "s",
     "its drives may hold the last torque: look at its program and cable"},
    {Reason::answer_wrong, "answer-wrong", "the robot acknowledged a command that it cannot have", "",
     "its program must send back the number of the newest command that it obeys"},
    {Reason::motors_off, "motors-off", "the robot said that its motors are off, while they were commanded on, for", "s",
     "look at its enabling switch, brakes and drives"},
    {Reason::motors_on, "motors-on", "the robot did not confirm that its motors are off", "",
     "cut the motors' power with the hardware stop button"},
    {Reason::sensor_missing, "sensor-missing", "the robot says that a sensor is gone that was there at the start", "",
     "look at its plug and supply"},
    {Reason::torque_disagrees, "torque-disagrees", "the torque of a motor was beside its command by", "N·m",
     "drives, force sensor, or inertia and friction in [robot]: one of them is wrong"},
}};

const Words& words(Reason reason) {
  return kWords[static_cast<std::size_t>(reason)];
}

static_assert([] {
  for (std::size_t i = 0; i < kWords.size(); ++i) {
    if (static_cast<std::size_t>(kWords[i].reason) != i) return false;
  }
  return true;
}());

}  // namespace

std::string_view code(Reason reason) {
  return words(reason).code;
}

std::string_view unit(Reason reason) {
  return words(reason).unit;
}

std::string sentence(const Trip& trip) {
  const Words& w = words(trip.reason);
  std::string text(w.what);
  if (!w.unit.empty()) text += fmt::format(" {:.4g} {} (limit {:.4g} {})", trip.value, w.unit, trip.limit, w.unit);
  if (trip.reason == Reason::robot_fault) text += fmt::format(" (code {:.0f})", trip.value);
  text += fmt::format(", at {:.3f} s", trip.time);
  if (!w.advice.empty()) text += fmt::format("; {}", w.advice);
  return text;
}

}  // namespace mbk::safety
