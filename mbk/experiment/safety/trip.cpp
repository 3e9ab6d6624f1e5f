#include "mbk/experiment/safety/trip.h"

#include <fmt/format.h>

#include <array>

#include "mbk/base/system/process.h"

namespace mbk::safety {
namespace {

struct Sentence {
  Reason reason;
  std::string_view what;    // with a unit: "the measured force was"; without: the whole sentence
  std::string_view unit;    // "" where no value belongs to it
  std::string_view advice;  // what to check
};

constexpr std::array<Sentence, kReasons> kSentences = {{
    {Reason::none, "nothing tripped", "", ""},
    {Reason::stop_button, "the stop button was pressed", "", "release it, then reset"},
    {Reason::operator_stop, "the operator stopped it", "", ""},
    {Reason::link_lost, "the robot was silent for", "s", "check its cable, power and program"},
    {Reason::late, "a command was sent late by", "s", "use a real-time kernel, or end other programs"},
    {Reason::recording_failed, "the recording failed", "", "check the disk and its free space"},
    {Reason::controller_not_finite, "the controller requested a non-finite torque", "",
     "check its gains and references"},
    {Reason::encoder_not_finite, "an encoder gave a non-finite value", "", "check its wiring"},
    {Reason::force_not_finite, "the force sensor gave a non-finite value", "", "check its wiring"},
    {Reason::accelerometer_not_finite, "the accelerometer gave a non-finite value", "", "check its wiring"},
    {Reason::encoder_jump, "an encoder jumped by", "rad", "check its wiring and counter"},
    {Reason::force_jump, "the measured force jumped by", "N",
     "check the sensor's wiring, or whether the handle was knocked"},
    {Reason::encoder_frozen, "an encoder reading was constant under a changing torque for", "s", "check its wiring"},
    {Reason::force_frozen, "the force reading was constant for", "s", "check the sensor's supply"},
    {Reason::accelerometer_frozen, "the accelerometer reading was constant for", "s", "check the sensor's supply"},
    {Reason::accelerometer_disagrees, "the accelerations from encoders and accelerometer differed by", "m/s²",
     "one of the two is wrong: check signs, mounting and wiring"},
    {Reason::measured_force, "the measured force was", "N", "somebody or something pushes the handle"},
    {Reason::speed, "the hand's speed was", "m/s", ""},
    {Reason::acceleration, "the hand's acceleration was", "m/s²", ""},
    {Reason::workspace, "the hand left the workspace by", "m", ""},
    {Reason::joint_margin, "the margin to a joint limit was", "rad", ""},
    {Reason::excursion, "the hand's distance from the test location was", "m", ""},
    {Reason::tracking, "a joint's tracking error was", "rad", "check the gains, and who holds the handle"},
    {Reason::limited_too_long, "the controller exceeded its limits for", "s",
     "it may run away: check its gains and the limits"},
    {Reason::robot_fault, "the robot reported a fault", "", "look the code up in its manual"},
    {Reason::robot_watchdog, "the robot reported that no command arrived in time", "",
     "check its cable, and watchdog_ms"},
    {Reason::robot_clock, "the robot's clock was wrong, between two states or against mbk's clock, by", "s",
     "its program must stamp each state with the time of the sample"},
    {Reason::state_old, "the age of the robot's state, by its own clock, was", "s",
     "check the network, and what delays its program"},
    {Reason::answer_late, "the age of the command that the robot obeyed was", "s",
     "its drives may hold the last torque: check its program and cable"},
    {Reason::answer_wrong, "the robot acknowledged a command that was never sent, or took an acknowledgement back", "",
     "its program must send back the number of the newest command that it obeys"},
    {Reason::motors_off, "the robot reported its motors off, although commanded on, for", "s",
     "check its enabling switch, brakes and drives"},
    {Reason::motors_on, "the robot did not confirm that its motors are off", "",
     "cut the motors' power with the hardware stop button"},
    {Reason::sensor_missing, "the robot reported that a sensor present at the start is missing", "",
     "check its plug and supply"},
    {Reason::torque_disagrees, "a motor's torque differed from its command by", "N·m",
     "check drives, force sensor, and inertia and friction in [robot]: one of them is wrong"},
    {Reason::loop_stalled, "the robot's driver did not return for", "s",
     "its read and write must return within a tick; with lock_step, lower answer_within_s"},
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
    const std::string name = system::signal_name(static_cast<int>(trip.value));
    text = fmt::format("the signal {} stopped it", name.empty() ? "that came" : name);
  }
  if (!w.unit.empty()) text += fmt::format(" {:.4g} {} (limit {:.4g} {})", trip.value, w.unit, trip.limit, w.unit);
  if (trip.reason == Reason::robot_fault) text += fmt::format(" (code {:.0f})", trip.value);
  text += fmt::format(", at {:.3f} s", trip.time);
  if (!w.advice.empty()) text += fmt::format("; {}", w.advice);
  return text;
}

}  // namespace mbk::safety
