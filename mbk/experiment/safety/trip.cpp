#include "mbk/experiment/safety/trip.h"

#include <fmt/format.h>

#include <array>
#include <cstring>

namespace mbk::safety {
namespace {

struct Sentence {
  Reason reason;
  std::string_view what;    // with a unit: "the measured force was"; without: the whole sentence
  std::string_view unit;    // "" where no value belongs to it
  std::string_view advice;  // what to look at
};

constexpr std::array<Sentence, kReasons> kSentences = {{
    {Reason::none, "nothing tripped", "", ""},
    {Reason::stop_button, "the stop button was pressed", "", "release it, then reset"},
    {Reason::operator_stop, "the operator stopped it", "", ""},
    {Reason::link_lost, "the robot was silent for", "s", "look at its cable, power and program"},
    {Reason::late, "a command left late by", "s", "use a real-time kernel or fewer programs beside it"},
    {Reason::recording_failed, "the recording could not be kept up", "", "look at the disk and its free space"},
    {Reason::controller_not_finite, "the controller asked for a non-finite torque", "",
     "look at its gains and references"},
    {Reason::encoder_not_finite, "an encoder gave a non-finite value", "", "look at its wiring"},
    {Reason::force_not_finite, "the force sensor gave a non-finite value", "", "look at its wiring"},
    {Reason::accelerometer_not_finite, "the accelerometer gave a non-finite value", "", "look at its wiring"},
    {Reason::encoder_jump, "an encoder jumped by", "rad", "look at its wiring and counter"},
    {Reason::force_jump, "the measured force jumped by", "N", "look at the sensor's wiring, or a knock"},
    {Reason::encoder_frozen, "an encoder stood still to the bit, under a changing torque, for", "s",
     "look at its wiring"},
    {Reason::force_frozen, "the force reading stood still to the bit for", "s", "look at the sensor's supply"},
    {Reason::accelerometer_frozen, "the accelerometer's reading stood still to the bit for", "s",
     "look at the sensor's supply"},
    {Reason::accelerometer_disagrees, "the accelerations by the encoders and by the accelerometer differed by", "m/s²",
     "one of the two is wrong: look at signs, mounting and wiring"},
    {Reason::measured_force, "the measured force was", "N", "somebody or something pushes the handle"},
    {Reason::speed, "the hand's speed was", "m/s", ""},
    {Reason::acceleration, "the hand's acceleration was", "m/s²", ""},
    {Reason::workspace, "the hand left the workspace by", "m", ""},
    {Reason::joint_margin, "what was left before a joint's limit was", "rad", ""},
    {Reason::excursion, "the hand was away from the test location by", "m", ""},
    {Reason::tracking, "a joint was away from its reference by", "rad", "look at the gains, or who holds the handle"},
    {Reason::limited_too_long, "the controller asked for more than its limits for", "s",
     "it may run away: look at its gains and at the limits"},
    {Reason::robot_fault, "the robot reports a fault of its own", "", "see its manual for the code"},
    {Reason::robot_watchdog, "the robot says that no command reached it in time", "",
     "look at its cable, and at watchdog_ms"},
    {Reason::robot_clock, "the robot's clock was off, from one state to the next or against this one, by", "s",
     "its program must stamp each state with the time of the sample"},
    {Reason::state_old, "the robot's states were too old by its own clock:", "s",
     "look at the network and at what delays its program"},
    {Reason::answer_late, "the robot obeyed a command that was too old:", "s",
     "its drives may hold the last torque: look at its program and cable"},
    {Reason::answer_wrong, "the robot acknowledged a command that it cannot have", "",
     "its program must send back the number of the newest command that it obeys"},
    {Reason::motors_off, "the robot said that its motors are off, while they were commanded on, for", "s",
     "look at its enabling switch, brakes and drives"},
    {Reason::motors_on, "the robot did not confirm that its motors are off", "",
     "cut the motors' power with the hardware stop button"},
    {Reason::sensor_missing, "the robot says that a sensor is gone that was there at the start", "",
     "look at its plug and supply"},
    {Reason::torque_disagrees, "the torque of a motor was beside its command by", "N·m",
     "drives, force sensor, or inertia and friction in [robot]: one of them is wrong"},
    {Reason::loop_stalled, "the robot's driver did not return for", "s",
     "its read and write must return within a tick; with lock_step lower answer_within_s"},
}};

const Sentence& parts(Reason reason) {
  return kSentences[static_cast<std::size_t>(reason)];
}

static_assert([] {
  for (std::size_t i = 0; i < kSentences.size(); ++i) {
    if (static_cast<std::size_t>(kSentences[i].reason) != i) return false;
  }
  return true;
}());

}  // namespace

std::string_view unit(Reason reason) {
  return parts(reason).unit;
}

std::string sentence(const Trip& trip) {
  const Sentence& w = parts(trip.reason);
  std::string text(w.what);
  if (trip.reason == Reason::operator_stop && trip.value != 0.0) {
    const char* const name = sigabbrev_np(static_cast<int>(trip.value));
    text = fmt::format("the signal {} stopped it", name != nullptr ? fmt::format("SIG{}", name) : "that came");
  }
  if (!w.unit.empty()) text += fmt::format(" {:.4g} {} (limit {:.4g} {})", trip.value, w.unit, trip.limit, w.unit);
  if (trip.reason == Reason::robot_fault) text += fmt::format(" (code {:.0f})", trip.value);
  text += fmt::format(", at {:.3f} s", trip.time);
  if (!w.advice.empty()) text += fmt::format("; {}", w.advice);
  return text;
}

}  // namespace mbk::safety
