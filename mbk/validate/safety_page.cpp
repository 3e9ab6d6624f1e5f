#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "mbk/experiment/safety/gate.h"
#include "mbk/experiment/safety/limits.h"
#include "mbk/experiment/session/loop_watch.h"
#include "mbk/validate/fault_kinds.h"
#include "mbk/validate/udp_fault_kinds.h"
#include "mbk/validate/udp_faults.h"

namespace mbk::validation {
namespace {

constexpr std::string_view kBegin = R"(# Safety: every single fault
What can go wrong with one thing at a time, what detects it, how soon the motors are off, who confirms that they are, and what stays the robot's duty. `mbk validate faults --page` writes this page from the tables that the tests run: `mbk validate faults` for a robot behind a function call on a virtual clock, `mbk validate faults --link udp` for one in a process of its own, behind a socket, in real time. A test compares the two.

The way of thinking is that of IEC 80601-2-78 (robots for rehabilitation): no single fault may lead to an unacceptable risk, and the safe state is the one without torque. **This page claims no conformity**: mbk is no certified safety function, it has no independent channel and no proven failure rate ([run.md](run.md)).

## The safe state, and who knows
mbk can only *command* zero torque. After a stop the torque falls to zero in {ramp} ticks of 1 ms, the next command switches the motors off, and from there on mbk waits for the robot's word, at most {off:g} ms (`motors_off_ms`):

| What is asked | Why it is not enough alone |
|---|---|
| a state that came after the stop | a dead link says nothing |
| it acknowledges the stop, or a later command | an older command may still be obeyed |
| its flag says that the motors are off | the flag is what its program believes |
| its drives measure no torque, where they measure (version 2 of the states) | they measure themselves |
| encoders and force sensor show no motion that only a torque of the motors explains | it takes 41 states, and sensors that are trusted |

With all of that the stop is **confirmed**, "as reported by the robot". Where one is missing for so long, mbk says **MOTORS NOT CONFIRMED OFF** in the terminal, in the console and in the recording (`motors_off`), refuses `reset`, and ends with exit code 7. Then cut the motors' power by hand. mbk never says "confirmed" without the robot's word, but a robot whose acknowledgement, flag and sensors all lie together can deceive it, and a torque that is left and smaller than `torque_error_Nm` ({error:g} N·m of a joint) does not show in the motion.

## What stays the robot's duty
- **A stop button that cuts the motors' power without software**, in reach of the person and of the operator. It alone ends a torque that the drives do not give up.
- **A watchdog in the drives** that switches them off where commands stay away (`watchdog_ms`), whatever became of mbk, the link and the robot's own program. mbk cannot see whether there is one: pull the cable before every study.
- **Drives that fall back to zero torque** where their controller, encoder or supply fails.
- **Motors and stops that cannot injure** at their largest torque for as long as a fault may take to be found: the tables say how long.
- **An honest stamp**: the time of the sample, the number of the command that the drives obey, the flag of the power stage and not of a variable. Version 2 of the states with measured currents turns faults that are found by their motion, or not at all, into ones that are found within {drives} ms of the moment at which the torque is {error:g} N·m (`torque_error_Nm`) beside its command ([devices.md](devices.md)).
)";

constexpr std::string_view kUdp = R"(
## A robot behind UDP
The program `mbk_misbehaving_robot` is a simulated robot that misbehaves in these ways (`--list`). Ticks are of 1 ms of the robot's own clock, from the fault until its motors are off or, where they do not obey, until it was told so; the ramp of {ramp} ticks and {link} for the link are in them. A dash: nothing trips. *Confirmed* is what mbk says of the motors afterwards; "it depends" on the moment or on sensors that are no longer trusted, and then mbk says loudly that they are not confirmed.

*Motion* is what a hand or a joint does that was not commanded, whichever of these is first: {motion}.

)";

constexpr std::string_view kFunction = R"(
## A robot behind a function call
The same gate on a virtual clock, in which every tick is exact. Ticks from the fault to zero torque, with the ramp of {ramp}. The robot confirms the safe state, as its link and its drives are sound.

)";

constexpr std::string_view kBeside = R"(
## What fails beside the robot
These need a real clock, a plug-in or a disk; `tests/end_to_end` (`run`, `udp`, `recover`) brings each of them about through `mbk run`.

| Fault | On the screen | Exit code | In the recording |
|---|---|---|---|
| the driver does not return from a read or write for {stall:g} ms | **MOTORS NOT CONFIRMED OFF**, on terminal and page, from a second thread; where it returns, that is reported, and the gate judges the delay | – | ticks missed |
| it still has not returned when somebody stops the trial, or after 1 s with a robot that keeps its own time | the same, with the reason; mbk waits until a signal ends it | 7 | what came until then, `loop-stalled` |
| the driver calls `exit()` | MOTORS NOT CONFIRMED OFF | 7 | the journal, for `mbk recover` |
| a sleep returns early | "the clock woke the loop too early", with the count | as the trial | nothing: the loop waits until the time has come |
| the recording cannot be written after a stop (its name was taken, the disk is full) | the stop, its cause, the motors and the journal first, then the error | 5, or 7 | the journal, for `mbk recover` |
| the folder of the recording is removed | safety stop `recording-failed`, and where the recording is now | 5 | all of it, in the nearest folder above that is left, or among temporary files |
| somebody recovers, or records over, a journal that is being recorded | "is being recorded by process N", to them alone | 2 | nothing: the trial goes on |
)";

constexpr std::string_view kEnd = R"(
## What no table shows
- Two faults at a time, except where one of them is the robot's report of itself.
- A slow slip of an encoder, below what the accelerometer's comparison sees; a force sensor whose gain is wrong.
- A fault between the tick at which mbk's process dies and the robot's watchdog: that time is the robot's alone. Any signal that can be caught ramps down first ([run.md](run.md)).
- Reactions of the person. Limits by default are those of [run.md](run.md); a study sets its own, from its own risk analysis.
)";

std::string codes(const auto& reasons, const auto& code_of) {
  std::string text;
  for (const auto& reason : reasons) text += fmt::format("{}{}", text.empty() ? "" : ", ", code_of(reason));
  return text;
}

std::string ticks(int detection, int more) {
  return detection < 0 ? "–" : std::to_string(detection + more);
}

std::string_view detects(const UdpFaultKind& kind) {
  switch (kind.expected) {
    case Expected::trip:
      return "";
    case Expected::at_stop:
      return "the missing confirmation of the stop";
    case Expected::refusal:
      return "the start, which is refused";
    case Expected::no_harm:
      return "nothing has to: the trial goes on";
    case Expected::not_detected:
      return "**not detected for certain**";
  }
  return "";
}

std::string_view text(SafeState state) {
  switch (state) {
    case SafeState::confirmed:
      return "confirmed";
    case SafeState::not_confirmed:
      return "**not confirmed**, said loudly";
    case SafeState::either:
      return "it depends";
    case SafeState::unresolved:
      return "**confirmed, with a small torque left**";
  }
  return "";
}

/// All reasons of motion together are one word.
std::string reasons_of(const UdpFaultKind& kind) {
  const auto moves = motion_reasons();
  const auto is_of_motion = [&](std::string_view one) { return std::ranges::find(moves, one) != moves.end(); };
  if (std::ranges::count_if(kind.reasons, is_of_motion) < std::ssize(moves)) {
    return codes(kind.reasons, [](std::string_view one) { return one; });
  }
  std::string listed;
  for (const std::string_view one : kind.reasons) {
    if (!is_of_motion(one)) listed += fmt::format("{}, ", one);
  }
  return listed + "*motion*";
}

std::string udp_table() {
  std::string table =
      "| Fault | What happens | What detects it | Position, force: off within | The motors are | Robot's duty, or what "
      "limits the harm |\n|---|---|---|---|---|---|\n";
  for (const UdpFaultKind& kind : udp_fault_kinds()) {
    std::string found(detects(kind));
    const std::string reasons = reasons_of(kind);
    if (!reasons.empty()) found += (found.empty() ? "" : "; may be: ") + reasons;
    constexpr int kMore = safety::kRampTicks + kLinkTicks;
    const std::string soon = kind.expected == Expected::trip
                                 ? ticks(kind.detection[0], kMore) + ", " + ticks(kind.detection[1], kMore)
                                 : "–";
    table += fmt::format("| `{}`{} | {} | {} | {} | {} | {} |\n", kind.name, kind.version > 1 ? " (version 2)" : "",
                         kind.what, found, soon, text(kind.safe_state), kind.bound);
  }
  return table;
}

std::string function_table() {
  std::string table = "| Fault | What detects it | Position, force: off within |\n|---|---|---|\n";
  for (const FaultKind& kind : fault_kinds()) {
    table += fmt::format("| {} | {} | {}, {} |\n", kind.name,
                         codes(kind.reasons, [](safety::Reason one) { return word_of(one); }),
                         ticks(kind.detection[0], safety::kRampTicks), ticks(kind.detection[1], safety::kRampTicks));
  }
  return table;
}

}  // namespace

std::string safety_page() {
  constexpr int kDrivesFound = 60;  // [ms]: the gate waits 50 ms, and a few states
  const auto ramp = fmt::arg("ramp", safety::kRampTicks);
  return fmt::format(fmt::runtime(kBegin), ramp, fmt::arg("off", 1e3 * safety::Limits{}.motors_off),
                     fmt::arg("drives", kDrivesFound), fmt::arg("error", safety::Limits{}.torque_error)) +
         fmt::format(fmt::runtime(kUdp), ramp, fmt::arg("link", kLinkTicks),
                     fmt::arg("motion", codes(motion_reasons(), [](std::string_view one) { return one; }))) +
         udp_table() + fmt::format(fmt::runtime(kFunction), ramp) + function_table() +
         fmt::format(fmt::runtime(kBeside), fmt::arg("stall", 1e3 * session::LoopWatch::kLongest)) + std::string(kEnd);
}

}  // namespace mbk::validation
