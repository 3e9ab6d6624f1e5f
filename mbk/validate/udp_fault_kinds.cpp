#include "mbk/validate/udp_fault_kinds.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "mbk/base/core/nan.h"

namespace mbk::validation {
namespace {

using drivers::CommandDatagram;
using drivers::StateDatagram;
using numeric::Random;
using Make = std::function<void(RobotFault&, Random&)>;
using Reasons = std::vector<std::string_view>;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kLatchedTorque = 0.6;   // more than Limits::torque_error, which the motion can show [N·m]
constexpr double kMeasuredTorque = 0.3;  // what drives that measure can show all the more [N·m]

// What a robot that does not obey its drives' commands leads to, whatever it says of them.
const Reasons kMoves = {"torque-disagrees",
                        "tracking",
                        "speed",
                        "acceleration",
                        "excursion",
                        "measured-force",
                        "limited-too-long",
                        "accelerometer-disagrees",
                        "force-jump",
                        "encoder-jump",
                        "joint-margin"};

Reasons with(Reasons reasons, const Reasons& more) {
  reasons.insert(reasons.end(), more.begin(), more.end());
  return reasons;
}

int below(Random& random, int least, int most) {
  return least + static_cast<int>(random.below(static_cast<std::uint64_t>(most - least + 1)));
}

Eigen::Index axis_by_lot(Random& random) {
  return static_cast<Eigen::Index>(random.below(2));
}

double sign_by_lot(Random& random) {
  return random.below(2) == 0 ? 1.0 : -1.0;
}

Vector2d direction(Random& random) {
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  return {std::cos(angle), std::sin(angle)};
}

/// Several parts of one fault.
Make all(std::vector<Make> parts) {
  return [parts = std::move(parts)](RobotFault& fault, Random& random) {
    for (const Make& part : parts) part(fault, random);
  };
}

Make at_stop() {
  return [](RobotFault& fault, Random&) { fault.begins = RobotFault::Begins::at_stop; };
}

// ---- drives

/// The torque of the first tick, for ever: it begins where there is so much of it.
Make latched(double least = kLatchedTorque) {
  return [=](RobotFault& fault, Random&) {
    fault.min_torque = least;
    fault.drive = [held = Vector2d(0.0, 0.0)](const Vector2d& told, int k) mutable {
      if (k == 0) held = told;
      return held;
    };
  };
}

/// As `latched`, with a torque by lot that is too small for the motion to show it.
Make latched_small() {
  return [](RobotFault& fault, Random& random) {
    const Vector2d held = random.uniform(0.15, 0.3) * direction(random);
    fault.drive = [held](const Vector2d&, int) { return held; };
  };
}

/// A torque that they take up as they are told to switch off.
Make on_at_stop() {
  return [](RobotFault& fault, Random&) {
    fault.begins = RobotFault::Begins::at_stop;
    fault.drive = [](const Vector2d&, int) { return Vector2d(0.8, -0.8); };
  };
}

Make torque(std::function<Vector2d(const Vector2d& told)> change) {
  return [change](RobotFault& fault, Random&) {
    fault.drive = [change](const Vector2d& told, int) { return change(told); };
  };
}

/// The factor of one motor, or of both.
Make gain(double factor, bool both) {
  return [=](RobotFault& fault, Random& random) {
    const Eigen::Index axis = axis_by_lot(random);
    fault.drive = [=](Vector2d told, int) {
      if (both) return Vector2d(factor * told);
      told[axis] *= factor;
      return told;
    };
  };
}

// ---- what the robot says

Make says(std::function<void(StateDatagram& state, int k)> change) {
  return [change](RobotFault& fault, Random&) {
    fault.say = [before = fault.say, change](StateDatagram& state, int k) {
      if (before) before(state, k);
      change(state, k);
    };
  };
}

Make says_motors(bool on) {
  return says([on](StateDatagram& state, int) { state.enabled = on; });
}

/// `answered` is what `change` makes of it; `held` is that of the first tick.
Make answers(std::function<std::uint64_t(std::uint64_t now, std::uint64_t held, int k)> change) {
  return [change](RobotFault& fault, Random& random) {
    says([change, held = std::uint64_t{0}](StateDatagram& state, int k) mutable {
      if (held == 0) held = state.answered;
      state.answered = change(state.answered, held, k);
    })(fault, random);
  };
}

/// The robot's time is what `change` makes of it; `held` is that of the first tick.
Make clock(std::function<double(double now, double held)> change) {
  return [change](RobotFault& fault, Random& random) {
    says([change, held = kNaN](StateDatagram& state, int) mutable {
      if (std::isnan(held)) held = state.raw.time;
      state.raw.time = change(state.raw.time, held);
    })(fault, random);
  };
}

/// What sensors read, and where asked the answer too, grows older by a tick in every second tick, to an age by lot
/// [ticks]; sequence and time stay new.
Make aged_samples(int least, int most, bool answer) {
  return [=](RobotFault& fault, Random& random) {
    const int oldest = below(random, least, most);
    says([=, past = std::deque<StateDatagram>()](StateDatagram& state, int k) mutable {
      past.push_back(state);
      while (std::cmp_greater(past.size(), std::min(oldest, k / 2) + 1)) past.pop_front();
      const StateDatagram& old = past.front();
      state.raw.encoder = old.raw.encoder;
      state.raw.force = old.raw.force;
      state.raw.acceleration = old.raw.acceleration;
      if (answer) state.answered = old.answered;
    })(fault, random);
  };
}

// ---- sensors

Make senses(std::function<void(device::State& state, int k)> change) {
  return [change](RobotFault& fault, Random&) { fault.sense = change; };
}

using Pair = Vector2d device::State::*;

/// axis −1: both.
Make frozen(Pair pair, int axis) {
  return senses([=, held = Vector2d(kNaN, 0.0)](device::State& state, int) mutable {
    if (std::isnan(held[0])) held = state.*pair;
    for (Eigen::Index i = 0; i < 2; ++i) {
      if (axis < 0 || i == axis) (state.*pair)[i] = held[i];
    }
  });
}

Make one_reads(Pair pair, double value) {
  return [=](RobotFault& fault, Random& random) {
    const Eigen::Index axis = axis_by_lot(random);
    fault.sense = [=](device::State& state, int) { (state.*pair)[axis] = value; };
  };
}

/// The reading of one axis is off by so much, or drifts by so much in a second.
Make off_by(Pair pair, double least, double most, bool drifts) {
  return [=](RobotFault& fault, Random& random) {
    const Eigen::Index axis = axis_by_lot(random);
    const double by = sign_by_lot(random) * random.uniform(least, most);
    fault.sense = [=](device::State& state, int k) { (state.*pair)[axis] += drifts ? by * kTick * (k + 1) : by; };
  };
}

/// Counts backwards from where it is.
Make backwards(int axis) {
  return [=](RobotFault& fault, Random&) {
    fault.sense = [=, at = kNaN](device::State& state, int) mutable {
      if (std::isnan(at)) at = state.joint[axis];
      state.joint[axis] = 2.0 * at - state.joint[axis];
    };
  };
}

// ---- link

Make from_robot(std::function<Passage(int k, Random& random)> passage) {
  return [passage](RobotFault& fault, Random& random) {
    fault.from_robot = [passage, own = Random(random.below(1U << 30U))](int k) mutable { return passage(k, own); };
  };
}

Make to_robot(std::function<Passage(int k, Random& random)> passage) {
  return [passage](RobotFault& fault, Random& random) {
    fault.to_robot = [passage, own = Random(random.below(1U << 30U))](int k) mutable { return passage(k, own); };
  };
}

/// States come late: by a tick more in each `every` ticks, up to a delay by lot [ticks].
Make states_late(int every, int least, int most) {
  return [=](RobotFault& fault, Random& random) {
    const int longest = below(random, least, most);
    fault.from_robot = [=](int k) { return Passage{1, every > 0 ? std::min(longest, k / every) : longest}; };
  };
}

Make commands_late(int every, int least, int most) {
  return [=](RobotFault& fault, Random& random) {
    const int longest = below(random, least, most);
    fault.to_robot = [=](int k) { return Passage{1, std::min(longest, k / every)}; };
  };
}

Passage lost_where(bool lost) {
  return {lost ? 0 : 1};
}

std::vector<UdpFaultKind> drives() {
  const Reasons answer_or_moves = with({"answer-late"}, kMoves);
  const std::string_view cut = "a stop button that cuts the motors' power; drives that fall back to zero torque";
  return {
      {"latched-frozen-answer",
       "the drives keep the torque of one moment; the robot answers no command any more",
       Expected::trip,
       {30, 30},
       answer_or_moves,
       SafeState::not_confirmed,
       cut,
       1,
       all({latched(), answers([](auto, auto held, int) { return held; })})},
      {"latched-says-on",
       "the drives keep the torque of one moment; the robot answers as if it obeyed, motors on",
       Expected::trip,
       {600, 1500},
       kMoves,
       SafeState::not_confirmed,
       cut,
       1,
       all({latched(), says_motors(true)})},
      {"latched-says-off",
       "the drives keep the torque of one moment; the robot says that its motors are off",
       Expected::trip,
       {110, 110},
       with({"motors-off"}, kMoves),
       SafeState::not_confirmed,
       cut,
       1,
       all({latched(), says_motors(false)})},
      {"latched-obedient",
       "the drives keep the torque of one moment; the robot says that it does as it is told",
       Expected::trip,
       {600, 1500},
       kMoves,
       SafeState::not_confirmed,
       cut,
       1,
       latched()},
      {"latched-measured",
       "the drives keep the torque of one moment, and measure it",
       Expected::trip,
       {600, 1000},
       kMoves,
       SafeState::not_confirmed,
       cut,
       2,
       latched(kMeasuredTorque)},
      {"latched-measured-falsely",
       "the drives keep the torque of one moment, and report what they were told",
       Expected::trip,
       {600, 1500},
       kMoves,
       SafeState::not_confirmed,
       cut,
       2,
       [](RobotFault& fault, Random& random) {
         latched()(fault, random);
         auto told = std::make_shared<Vector2d>(0.0, 0.0);
         fault.drive = [told, drive = fault.drive](const Vector2d& torque, int k) {
           *told = torque;
           return drive(torque, k);
         };
         fault.say = [told](StateDatagram& state, int) { state.measured = *told; };
       }},
      {"latched-small",
       "the drives keep a torque of 0.15 to 0.3 N·m; the robot says that it does as it is told",
       Expected::not_detected,
       {0, 0},
       kMoves,
       SafeState::unresolved,
       "less than torque_error_Nm, which encoders and force sensor do not show; a stop button that cuts the motors' "
       "power",
       1,
       latched_small()},
      {"latched-small-measured",
       "the drives keep a torque of 0.15 to 0.3 N·m, and measure it",
       Expected::not_detected,
       {0, 0},
       kMoves,
       SafeState::not_confirmed,
       "less than torque_error_Nm while it is driven; after the stop nothing may be left",
       2,
       latched_small()},
      {"drives-dead",
       "the drives have no torque; the robot says that its motors are on",
       Expected::trip,
       {600, 1500},
       kMoves,
       SafeState::confirmed,
       "",
       1,
       torque([](const Vector2d&) { return Vector2d(0.0, 0.0); })},
      {"drives-dead-measured",
       "the drives have no torque, and measure it",
       Expected::trip,
       {1500, 1500},
       kMoves,
       SafeState::confirmed,
       "",
       2,
       torque([](const Vector2d&) { return Vector2d(0.0, 0.0); })},
      {"one-motor-dead",
       "one motor has no torque",
       Expected::trip,
       {1500, 2500},
       kMoves,
       SafeState::confirmed,
       "",
       1,
       gain(0.0, false)},
      {"sign-flipped",
       "both motors pull the wrong way",
       Expected::trip,
       {500, 1000},
       kMoves,
       SafeState::confirmed,
       "motors that cannot injure at their largest current",
       1,
       gain(-1.0, true)},
      {"one-sign-flipped",
       "one motor pulls the wrong way",
       Expected::trip,
       {500, 1500},
       kMoves,
       SafeState::confirmed,
       "motors that cannot injure at their largest current",
       1,
       gain(-1.0, false)},
      {"torque-doubled",
       "both motors pull twice as strongly",
       Expected::not_detected,
       {0, 0},
       kMoves,
       SafeState::confirmed,
       "the limits of speed, force, place and acceleration; version 2 measures it",
       1,
       gain(2.0, true)},
      {"torque-doubled-measured",
       "both motors pull twice as strongly, and measure it",
       Expected::not_detected,
       {0, 0},
       kMoves,
       SafeState::confirmed,
       "found 50 ms after the torque has been torque_error_Nm beside its command; a trial of smaller torques goes on",
       2,
       gain(2.0, true)},
      {"torque-weak",
       "both motors pull with 0.3 of the torque",
       Expected::not_detected,
       {0, 0},
       kMoves,
       SafeState::confirmed,
       "it only weakens; version 2 measures it",
       1,
       gain(0.3, true)},
      {"torque-weak-measured",
       "both motors pull with 0.3 of the torque, and measure it",
       Expected::trip,
       {1500, 1500},
       kMoves,
       SafeState::confirmed,
       "",
       2,
       gain(0.3, true)},
      {"torque-offset",
       "a torque of 2 to 4 N·m besides, whatever is commanded, while the motors are on",
       Expected::trip,
       {300, 300},
       kMoves,
       SafeState::confirmed,
       "",
       1,
       [](RobotFault& fault, Random& random) {
         const Vector2d by = random.uniform(2.0, 4.0) * direction(random);
         fault.drive = [by](const Vector2d& told, int) { return told.isZero(0.0) ? told : Vector2d(told + by); };
       }},
      {"torque-late",
       "the drives do 40 ms later what they answer at once",
       Expected::not_detected,
       {0, 0},
       kMoves,
       SafeState::confirmed,
       "the limits of speed, tracking and acceleration; a commissioning test of the drives",
       1,
       [](RobotFault& fault, Random&) {
         fault.drive = [queue = std::deque<Vector2d>()](const Vector2d& told, int k) mutable {
           queue.push_back(told);
           if (k < 40) return Vector2d(queue.front());
           const Vector2d late = queue.front();
           queue.pop_front();
           return late;
         };
       }},
      {"off-late",
       "the motors go off 300 ms after they were told, and the robot says so honestly",
       Expected::no_harm,
       {0, 0},
       {},
       SafeState::confirmed,
       "",
       1,
       all({at_stop(),
            [](RobotFault& fault, Random&) {
              fault.drive = [](const Vector2d& told, int k) { return k < 300 ? Vector2d(0.8, -0.8) : told; };
            },
            says([](StateDatagram& state, int k) { state.enabled = k < 300; })})},
      {"stays-on",
       "told to switch off, the motors keep a torque; the robot says that they are on",
       Expected::at_stop,
       {0, 0},
       {"motors-on"},
       SafeState::not_confirmed,
       cut,
       1,
       all({on_at_stop(), says_motors(true)})},
      {"stays-on-says-off",
       "told to switch off, the motors keep a torque; the robot says that they are off",
       Expected::at_stop,
       {0, 0},
       {"motors-on", "torque-disagrees"},
       SafeState::not_confirmed,
       cut,
       1,
       on_at_stop()},
      {"stays-on-measured",
       "told to switch off, the motors keep a torque and measure it; the robot says they are off",
       Expected::at_stop,
       {0, 0},
       {"motors-on", "torque-disagrees"},
       SafeState::not_confirmed,
       cut,
       2,
       on_at_stop()},
      {"stays-on-without-torque",
       "told to switch off, the robot says that its motors are on; they have no torque",
       Expected::at_stop,
       {0, 0},
       {"motors-on"},
       SafeState::not_confirmed,
       "",
       1,
       all({at_stop(), says_motors(true)})},
  };
}

std::vector<UdpFaultKind> words() {
  return {
      {"answer-frozen",
       "the robot obeys, and answers no command any more",
       Expected::trip,
       {30, 30},
       {"answer-late"},
       SafeState::not_confirmed,
       "",
       1,
       answers([](auto, auto held, int) { return held; })},
      {"answer-ahead",
       "the robot answers commands that were never sent",
       Expected::trip,
       {5, 5},
       {"answer-wrong", "answer-late"},
       SafeState::either,
       "",
       1,
       answers([](auto now, auto, int) { return now + 1000; })},
      {"answer-backwards",
       "the answers run backwards",
       Expected::trip,
       {25, 25},
       {"answer-wrong", "answer-late"},
       SafeState::not_confirmed,
       "",
       1,
       answers([](auto, auto held, int k) { return held - std::min<std::uint64_t>(held, static_cast<unsigned>(k)); })},
      {"answer-lags",
       "the answers lag by a tick more in each ten",
       Expected::trip,
       {250, 250},
       {"answer-late", "answer-wrong"},
       SafeState::either,
       "",
       1,
       answers([](auto now, auto, int k) { return now - static_cast<unsigned>(k / 10); })},
      {"says-off-drives",
       "the robot says that its motors are off, and obeys all the same",
       Expected::trip,
       {110, 110},
       {"motors-off"},
       SafeState::confirmed,
       "",
       1,
       says_motors(false)},
      {"goes-off",
       "the motors go off, and the robot says so",
       Expected::trip,
       {110, 110},
       with({"motors-off"}, kMoves),
       SafeState::confirmed,
       "",
       1,
       all({torque([](const Vector2d&) { return Vector2d(0.0, 0.0); }), says_motors(false)})},
      {"says-off-once",
       "one sample says that the motors are off",
       Expected::no_harm,
       {0, 0},
       {},
       SafeState::confirmed,
       "",
       1,
       says([](StateDatagram& state, int k) { state.enabled = state.enabled && k > 0; })},
      {"on-at-greeting",
       "the robot answers the greeting with motors that are on",
       Expected::refusal,
       {0, 0},
       {"motors-on"},
       SafeState::either,
       "",
       1,
       all({[](RobotFault& fault, Random&) { fault.begins = RobotFault::Begins::at_greeting; }, says_motors(true)})},
      {"watchdog-flag",
       "the robot says that its watchdog has expired",
       Expected::trip,
       {5, 5},
       {"robot-watchdog", "link-lost", "motors-off"},
       SafeState::confirmed,
       "",
       1,
       all({torque([](const Vector2d&) { return Vector2d(0.0, 0.0); }), says([](StateDatagram& state, int) {
              state.watchdog_expired = true;
              state.enabled = false;
            })})},
      {"watchdog-disabled",
       "the robot's watchdog never expires",
       Expected::not_detected,
       {0, 0},
       {},
       SafeState::confirmed,
       "a watchdog in the drive, tested before every session: it matters where mbk or the link dies",
       1,
       [](RobotFault& fault, Random&) {
         fault.hear = [](CommandDatagram& command, int) {
           command.watchdog = std::numeric_limits<std::uint32_t>::max();
         };
       }},
      {"stop-button",
       "the stop button is pressed and cuts the motors",
       Expected::trip,
       {5, 5},
       {"stop-button"},
       SafeState::confirmed,
       "",
       1,
       all({torque([](const Vector2d&) { return Vector2d(0.0, 0.0); }), says([](StateDatagram& state, int) {
              state.raw.stop = true;
              state.enabled = false;
            })})},
      {"stop-button-flickers",
       "one sample says that the stop button is pressed",
       Expected::trip,
       {5, 5},
       {"stop-button"},
       SafeState::confirmed,
       "",
       1,
       says([](StateDatagram& state, int k) { state.raw.stop = k == 1; })},
      {"fault-code",
       "the robot's own fault code is set",
       Expected::trip,
       {5, 5},
       {"robot-fault"},
       SafeState::confirmed,
       "",
       2,
       says([](StateDatagram& state, int) { state.fault = 17; })},
      {"measured-contradicts",
       "the measured torque is 2 N·m more than what acts",
       Expected::trip,
       {70, 70},
       {"torque-disagrees"},
       SafeState::either,
       "",
       2,
       says([](StateDatagram& state, int) { state.measured += Vector2d(2.0, -2.0); })},
      {"measured-not-finite",
       "the measured torque is not a number (NaN)",
       Expected::trip,
       {300, 300},
       {"torque-disagrees", "sensor-missing"},
       SafeState::either,
       "",
       2,
       says([](StateDatagram& state, int) { state.measured[0] = kNaN; })},
      {"measured-gone",
       "the measured torque is withdrawn",
       Expected::trip,
       {110, 110},
       {"sensor-missing", "torque-disagrees"},
       SafeState::either,
       "",
       2,
       says([](StateDatagram& state, int) { state.drives_measure = false; })},
      {"version-changes",
       "the states change from version 2 to version 1",
       Expected::trip,
       {110, 110},
       {"sensor-missing", "torque-disagrees", "robot-fault", "link-lost"},
       SafeState::either,
       "",
       2,
       says([](StateDatagram& state, int) { state.version = 1; })},
  };
}

std::vector<UdpFaultKind> clocks() {
  const Reasons clock_reason = with({"robot-clock", "state-old"}, kMoves);  // motion is measured by this clock
  return {
      {"clock-still",
       "the robot's clock stands still",
       Expected::trip,
       {60, 60},
       clock_reason,
       SafeState::either,
       "",
       1,
       clock([](double, double held) { return held; })},
      {"clock-backwards",
       "the robot's clock runs backwards",
       Expected::trip,
       {60, 60},
       clock_reason,
       SafeState::either,
       "",
       1,
       clock([](double now, double held) { return 2.0 * held - now; })},
      {"clock-jumps",
       "the robot's clock jumps ahead by 1 s",
       Expected::trip,
       {60, 60},
       clock_reason,
       SafeState::either,
       "",
       1,
       clock([](double now, double) { return now + 1.0; })},
      {"clock-jumps-back",
       "the robot's clock jumps back by 1 s",
       Expected::trip,
       {60, 60},
       clock_reason,
       SafeState::either,
       "",
       1,
       clock([](double now, double) { return now - 1.0; })},
      {"clock-not-finite",
       "the robot's clock is not a number (NaN)",
       Expected::trip,
       {60, 60},
       clock_reason,
       SafeState::either,
       "",
       1,
       clock([](double, double) { return kNaN; })},
      {"clock-infinite",
       "the robot's clock is infinite",
       Expected::trip,
       {60, 60},
       clock_reason,
       SafeState::either,
       "",
       1,
       clock([](double, double) { return kInfinite; })},
      {"clock-fast",
       "the robot's clock runs twice as fast",
       Expected::trip,
       {60, 60},
       clock_reason,
       SafeState::either,
       "",
       1,
       clock([](double now, double held) { return 2.0 * now - held; })},
      {"clock-slow",
       "the robot's clock runs half as fast",
       Expected::trip,
       {70, 70},
       clock_reason,
       SafeState::either,
       "",
       1,
       clock([](double now, double held) { return 0.5 * (now + held); })},
  };
}

std::vector<UdpFaultKind> sensors() {
  const Pair joint = &device::State::joint, force = &device::State::force, accel = &device::State::acceleration;
  const Reasons stuck = with({"encoder-frozen"}, kMoves);
  return {
      {"encoder-still",
       "one encoder stands still",
       Expected::trip,
       {2500, 2500},
       stuck,
       SafeState::confirmed,
       "",
       1,
       [](RobotFault& fault, Random& random) {
         frozen(&device::State::joint, static_cast<int>(random.below(2)))(fault, random);
       }},
      {"encoders-still",
       "both encoders stand still",
       Expected::trip,
       {2500, 2500},
       stuck,
       SafeState::confirmed,
       "",
       1,
       frozen(joint, -1)},
      {"encoder-not-finite",
       "one encoder gives not a number (NaN)",
       Expected::trip,
       {5, 5},
       {"encoder-not-finite"},
       SafeState::either,
       "",
       1,
       one_reads(joint, kNaN)},
      {"encoder-jumps",
       "one encoder jumps by 0.1 to 0.5 rad",
       Expected::trip,
       {5, 5},
       with({"encoder-jump"}, kMoves),
       SafeState::confirmed,
       "",
       1,
       off_by(joint, 0.1, 0.5, false)},
      {"encoder-drifts",
       "one encoder drifts by 0.05 to 0.2 rad/s",
       Expected::not_detected,
       {0, 0},
       kMoves,
       SafeState::confirmed,
       "the limits of speed and place; an encoder at the motor and one at the joint: a slow slip moves the robot's "
       "frame unseen",
       1,
       off_by(joint, 0.05, 0.2, true)},
      {"encoder-sign",
       "encoder 1 counts backwards",
       Expected::trip,
       {2500, 2500},
       kMoves,
       SafeState::confirmed,
       "",
       1,
       backwards(0)},
      {"encoder-2-sign",
       "encoder 2 counts backwards",
       Expected::trip,
       {2500, 2500},
       kMoves,
       SafeState::confirmed,
       "",
       1,
       backwards(1)},
      {"force-flag",
       "the robot says that it has no force sensor any more",
       Expected::trip,
       {5, 5},
       {"sensor-missing"},
       SafeState::either,
       "",
       1,
       says([](StateDatagram& state, int) { state.has_force = false; })},
      {"accelerometer-flag",
       "the robot says that it has no accelerometer any more",
       Expected::trip,
       {5, 5},
       {"sensor-missing"},
       SafeState::either,
       "",
       1,
       says([](StateDatagram& state, int) { state.has_acceleration = false; })},
      {"force-drifts",
       "the force drifts by 20 to 100 N/s",
       Expected::trip,
       {500, 500},
       with({"measured-force"}, kMoves),
       SafeState::either,
       "",
       1,
       off_by(force, 20.0, 100.0, true)},
      {"force-jumps",
       "the force jumps by 30 to 100 N",
       Expected::trip,
       {5, 5},
       {"force-jump", "measured-force"},
       SafeState::either,
       "",
       1,
       off_by(force, 30.0, 100.0, false)},
      {"force-still",
       "the force stands still",
       Expected::trip,
       {300, 300},
       with({"force-frozen"}, kMoves),
       SafeState::either,
       "",
       1,
       frozen(force, -1)},
      {"force-not-finite",
       "the force is not a number (NaN)",
       Expected::trip,
       {5, 5},
       {"force-not-finite"},
       SafeState::either,
       "",
       1,
       one_reads(force, kNaN)},
      {"force-sign",
       "the force changes its sign",
       Expected::not_detected,
       {0, 0},
       with({"force-jump"}, kMoves),
       SafeState::either,
       "the limits of force and speed; 'mbk robot check --live' before the session",
       1,
       senses([](device::State& state, int) { state.force = -state.force; })},
      {"accelerometer-still",
       "the acceleration stands still",
       Expected::trip,
       {400, 400},
       {"accelerometer-frozen", "accelerometer-disagrees"},
       SafeState::confirmed,
       "",
       1,
       frozen(accel, -1)},
      {"accelerometer-not-finite",
       "the acceleration is not a number (NaN)",
       Expected::trip,
       {5, 5},
       {"accelerometer-not-finite"},
       SafeState::confirmed,
       "",
       1,
       one_reads(accel, kNaN)},
      {"samples-aged",
       "all readings are 20 to 200 ms old, under new stamps",
       Expected::not_detected,
       {0, 0},
       with({"encoder-frozen", "answer-late"}, kMoves),
       SafeState::either,
       "the limits of speed, tracking and place; a robot that stamps where it samples",
       1,
       aged_samples(20, 200, false)},
      {"samples-and-answers-aged",
       "readings and answers are 30 to 200 ms old, under new stamps",
       Expected::trip,
       {60, 60},
       with({"answer-late"}, kMoves),
       SafeState::either,
       "",
       1,
       aged_samples(30, 200, true)},
  };
}

std::vector<UdpFaultKind> links() {
  const Reasons old = {"state-old", "answer-late", "link-lost", "robot-clock"};
  const Reasons silent = {"link-lost", "answer-late", "state-old"};
  const std::string_view watchdog = "a watchdog that switches the motors off where commands stay away";
  return {
      {"states-held",
       "the states are held up for 20 to 500 ms",
       Expected::trip,
       {20, 20},
       old,
       SafeState::either,
       watchdog,
       1,
       states_late(0, 20, 500)},
      {"states-age",
       "the states come later by a tick in every second, up to 30 to 500 ms",
       Expected::trip,
       {70, 70},
       old,
       SafeState::either,
       watchdog,
       1,
       states_late(2, 30, 500)},
      {"states-age-slowly",
       "the states come later by a tick in every tenth",
       Expected::trip,
       {260, 260},
       old,
       SafeState::either,
       watchdog,
       1,
       states_late(10, 300, 300)},
      {"states-age-very-slowly",
       "the states come later by a tick in every fortieth",
       Expected::trip,
       {1000, 1000},
       old,
       SafeState::either,
       watchdog,
       1,
       states_late(40, 300, 300)},
      {"commands-late",
       "the robot obeys 30 to 45 ms late",
       Expected::trip,
       {110, 110},
       {"answer-late"},
       SafeState::either,
       watchdog,
       1,
       commands_late(2, 30, 45)},
      {"commands-later",
       "the robot obeys later by a tick in every tenth",
       Expected::trip,
       {270, 270},
       {"answer-late"},
       SafeState::either,
       watchdog,
       1,
       commands_late(10, 500, 500)},
      {"states-lost",
       "no state comes any more",
       Expected::trip,
       {15, 15},
       silent,
       SafeState::not_confirmed,
       watchdog,
       1,
       from_robot([](int, Random&) { return lost_where(true); })},
      {"commands-lost",
       "no command reaches the robot any more; the watchdog switches the motors off",
       Expected::trip,
       {35, 35},
       with({"robot-watchdog", "motors-off"}, silent),
       SafeState::either,
       watchdog,
       1,
       to_robot([](int, Random&) { return lost_where(true); })},
      {"cable-pulled",
       "nothing goes through in either direction; the watchdog switches the motors off",
       Expected::trip,
       {35, 35},
       silent,
       SafeState::not_confirmed,
       watchdog,
       1,
       all({from_robot([](int, Random&) { return lost_where(true); }),
            to_robot([](int, Random&) { return lost_where(true); })})},
      {"silent-after-stop",
       "no state comes once the motors are told to switch off",
       Expected::at_stop,
       {0, 0},
       {"motors-on", "link-lost"},
       SafeState::not_confirmed,
       watchdog,
       1,
       all({at_stop(), from_robot([](int, Random&) { return lost_where(true); })})},
      {"third-lost",
       "30 % of all datagrams get lost",
       Expected::no_harm,
       {0, 0},
       silent,
       SafeState::confirmed,
       "",
       1,
       all({from_robot([](int, Random& random) { return lost_where(random.uniform() < 0.3); }),
            to_robot([](int, Random& random) { return lost_where(random.uniform() < 0.3); })})},
      {"third-damaged",
       "one bit is wrong in 30 % of all datagrams",
       Expected::no_harm,
       {0, 0},
       silent,
       SafeState::confirmed,
       "",
       1,
       all({from_robot([](int, Random& random) {
              return Passage{1, 0, random.uniform() < 0.3};
            }),
            to_robot([](int, Random& random) {
              return Passage{1, 0, random.uniform() < 0.3};
            })})},
      {"reordered",
       "states overtake each other by up to 4 ms",
       Expected::no_harm,
       {0, 0},
       silent,
       SafeState::confirmed,
       "",
       1,
       from_robot([](int, Random& random) {
         return Passage{1, static_cast<int>(random.below(5))};
       })},
      {"doubled",
       "every datagram comes twice",
       Expected::no_harm,
       {0, 0},
       silent,
       SafeState::confirmed,
       "",
       1,
       all({from_robot([](int, Random&) { return Passage{2}; }), to_robot([](int, Random&) { return Passage{2}; })})},
      {"short-bursts",
       "states are held for 6 ms and come all at once",
       Expected::no_harm,
       {0, 0},
       silent,
       SafeState::confirmed,
       "",
       1,
       from_robot([](int k, Random&) {
         return Passage{1, 5 - k % 6};
       })},
      {"bursts",
       "states are held for 30 ms and come all at once",
       Expected::trip,
       {60, 60},
       silent,
       SafeState::either,
       "",
       1,
       from_robot([](int k, Random&) {
         return Passage{1, 29 - k % 30};
       })},
      {"sequence-jumps",
       "the states' numbers jump ahead by a million",
       Expected::no_harm,
       {0, 0},
       {"link-lost", "robot-clock"},
       SafeState::confirmed,
       "",
       1,
       says([](StateDatagram& state, int) { state.raw.sequence += 1'000'000; })},
      {"sequence-restarts",
       "the states are numbered from 1 again",
       Expected::trip,
       {15, 15},
       silent,
       SafeState::not_confirmed,
       watchdog,
       1,
       says([](StateDatagram& state, int k) { state.raw.sequence = static_cast<unsigned>(k) + 1; })},
      {"sequence-still",
       "every state has the same number",
       Expected::trip,
       {15, 15},
       silent,
       SafeState::not_confirmed,
       watchdog,
       1,
       says([held = std::uint64_t{0}](StateDatagram& state, int) mutable {
         if (held == 0) held = state.raw.sequence;
         state.raw.sequence = held;
       })},
      {"session-gone",
       "the robot begins anew: session 0, motors off",
       Expected::trip,
       {15, 15},
       silent,
       SafeState::not_confirmed,
       "motors off after a restart",
       1,
       all({torque([](const Vector2d&) { return Vector2d(0.0, 0.0); }), says([](StateDatagram& state, int) {
              state.session = 0;
              state.enabled = false;
            })})},
      {"dies",
       "the robot's program dies, and the torque with it",
       Expected::trip,
       {15, 15},
       silent,
       SafeState::not_confirmed,
       "motors off where the program dies",
       1,
       [](RobotFault& fault, Random&) { fault.gone = -1; }},
      {"dies-and-returns",
       "the robot's program dies, and another one begins after 5 to 200 ms at the same port",
       Expected::trip,
       {15, 15},
       silent,
       SafeState::not_confirmed,
       "motors off where the program dies, and after a restart",
       1,
       [](RobotFault& fault, Random& random) { fault.gone = below(random, 5, 200); }},
      {"second-robot",
       "a second robot that nobody greeted sends states from the same port",
       Expected::no_harm,
       {0, 0},
       silent,
       SafeState::confirmed,
       "",
       1,
       [](RobotFault& fault, Random&) {
         fault.second_robot = [](StateDatagram& state, int k) {
           state.session = 0;
           state.raw.sequence = static_cast<unsigned>(k) + 1;
           state.raw.encoder = {0.4, 1.2};
         };
       }},
      {"twin-robot",
       "a second robot of the same session sends states from the same port",
       Expected::trip,
       {15, 15},
       {"encoder-jump", "answer-late", "answer-wrong", "robot-clock", "state-old", "force-jump", "motors-off"},
       SafeState::either,
       "one robot at one address",
       1,
       [](RobotFault& fault, Random&) {
         fault.second_robot = [](StateDatagram& state, int) {
           state.raw.sequence += 5;
           state.raw.encoder += Vector2d(0.2, -0.2);
           state.raw.force.setZero();
           state.raw.acceleration.setZero();
         };
       }},
      {"foreign-robot",
       "a second robot of the same session sends states from another port",
       Expected::no_harm,
       {0, 0},
       silent,
       SafeState::confirmed,
       "",
       1,
       [](RobotFault& fault, Random&) {
         fault.elsewhere = true;
         fault.second_robot = [](StateDatagram& state, int) {
           state.raw.sequence += 5;
           state.raw.encoder += Vector2d(0.2, -0.2);
         };
       }},
  };
}

}  // namespace

std::span<const UdpFaultKind> udp_fault_kinds() {
  static const std::vector<UdpFaultKind> kKinds = [] {
    std::vector<UdpFaultKind> all;
    for (auto some : {drives(), words(), clocks(), sensors(), links()})
      std::ranges::move(some, std::back_inserter(all));
    return all;
  }();
  return kKinds;
}

std::span<const std::string_view> motion_reasons() {
  return kMoves;
}

const UdpFaultKind* find_udp_fault(std::string_view name) {
  const auto kinds = udp_fault_kinds();
  const auto found = std::ranges::find(kinds, name, &UdpFaultKind::name);
  return found == kinds.end() ? nullptr : &*found;
}

}  // namespace mbk::validation
