#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/experiment/safety/gate.h"
#include "mbk/experiment/safety/limits.h"
#include "mbk/experiment/session/loop_watch.h"
#include "mbk/validate/fault_kinds.h"
#include "mbk/validate/udp_fault_kinds.h"
#include "mbk/validate/udp_faults.h"

namespace mbk::validation {
namespace {

constexpr std::string_view kBegin = R"(# Safety: every single fault
What detects each fault, how soon the motors are off, whether that is confirmed, and the robot's duty. `mbk validate faults --page` writes this page from the tables of two tests: `mbk validate faults` (function call, virtual clock) and `mbk validate faults --link udp` (UDP, real time).

The principle is that of IEC 80601-2-78 (rehabilitation robots): no single fault may lead to an unacceptable risk, and the safe state is zero torque. **This page claims no conformity.** mbk is not a certified safety function: it has no independent channel and no proven failure rate ([run.md](run.md)).

## Safe state
mbk can only *command* zero torque. After a stop the torque falls to zero in {ramp} ticks of 1 ms, and the next command switches the motors off. mbk then waits up to {off:g} ms (`motors_off_ms`) for the robot's confirmation:

| Required | Not sufficient alone, because |
|---|---|
| a state that arrived after the stop | the link may be dead without it |
| an acknowledgement of the stop or a later command | the drives may still obey an older one |
| the flag "motors off" | it is what the robot's program believes |
| no torque measured by the drives, if they measure (v2: version 2 of the states) | they measure themselves |
| no motion that only motor torque explains | it takes 41 states and trusted encoders and force sensor |

If all are present, the stop is **confirmed**, as reported by the robot. Otherwise mbk shows **MOTORS NOT CONFIRMED OFF** in terminal, console and recording (`motors_off`), refuses `reset`, and exits with code 7. Then cut the motors' power by hand. mbk never reports "confirmed" without the robot's confirmation. But a robot whose acknowledgement, flag and sensors are all wrong can deceive it, and a remaining torque below `torque_error_Nm` ({error:g} N·m per joint) does not show in the motion.

## What remains the robot's duty
The tables name these duties by the italic word.

- ***stop button***: cuts the motors' power without software, in reach of participant and operator. Nothing else ends a torque that the drives do not release.
- ***watchdog***: in the drives; switches the motors off if commands stop (`watchdog_ms`), whatever happened to mbk, the link and the robot's program. mbk cannot see whether there is one: pull the cable before every study.
- ***drives***: fall back to zero torque if their controller, encoder or supply fails.
- ***motors*** and mechanical stops: cannot injure at maximum torque for as long as a fault may go undetected.
- ***reports***: the time of the sample, the number of the command that the drives obey, the flag of the power stage, not a variable. If the drives report measured torque (v2), faults that otherwise show only in the motion, or not at all, are found within {drives} ms after the torque differs from its command by {error:g} N·m (`torque_error_Nm`) ([own_robot.md](own_robot.md)).
)";

constexpr std::string_view kUdp = R"(
## Robot behind UDP
`mbk_misbehaving_robot`, which `tools/test` builds, simulates these faults.

- **Detected by**: reasons of the safety stop. *motion*: the first of {motion}. *silence*: one of {silence}. *none needed*: the trial continues. *possibly*: may stop the trial, but need not.
- **Off within**: ticks of 1 ms of the robot's clock, in a position / a force trial (one number if equal), from the fault until the motors are off or, if they do not obey, until they are told to be off. Includes {ramp} ticks of ramp and {link} of the link. A dash: no trip is required.
- **Confirmed**: whether mbk confirms the stop. If not, it raises the alarm. *varies*: with the moment, or because sensors are no longer trusted.
- **Duty**: of the robot, or what limits the harm.

)";

constexpr std::string_view kFunction = R"(
## Robot behind a function call
The same gate on a virtual clock: ticks from the fault to zero torque, including {ramp} of ramp. Link and drives work, so the robot confirms the safe state. *runaway*: *motion* without {not_runaway}. A dash: not in that trial.

)";

constexpr std::string_view kBeside = R"(
## Faults beside the robot
`tests/end_to_end` (`run`, `udp`, `recover`) tests these with `mbk run` in real time.

| Fault | Message | Exit code | Recording |
|---|---|---|---|
| the driver does not return from a read or write for {stall:g} ms | **MOTORS NOT CONFIRMED OFF**, from a second thread; if the driver returns, mbk reports it and the gate checks the delay | – | ticks missed |
| it has not returned when somebody stops the trial, or after 1 s if the robot keeps its own time | the same, with the reason; mbk waits until a signal ends it | 7 | everything until then, `loop-stalled` |
| the driver calls `exit()` | MOTORS NOT CONFIRMED OFF | 7 | the journal, for `mbk recover` |
| a sleep returns early | "the clock woke the loop too early", with the count | as the trial | unaffected: the loop waits |
| the recording cannot be written after a stop (name taken, disk full) | stop, cause, motors and journal first, then the error | 5 or 7 | the journal, for `mbk recover` |
| the folder of the recording is removed | safety stop `recording-failed`, and the new place | 5 | complete, in the nearest parent folder left or among temporary files |
| somebody recovers or overwrites a journal being recorded | "is being recorded by process N", only to them | 2 | unaffected |
)";

constexpr std::string_view kEnd = R"(
## Not covered
- Two simultaneous faults, except if one is the robot's report about itself.
- An encoder slip too slow for the comparison with the accelerometer; a force sensor with the wrong gain.
- The time between the death of mbk's process and the robot's watchdog. On signals that can be caught, mbk ramps down first ([run.md](run.md)).
- Reactions of the participant. Defaults of the limits are in [run.md](run.md); set those of a study by its own risk analysis.
)";

/// Reasons of a link that brings nothing new.
constexpr std::array kSilence = {word_of(safety::Reason::link_lost), word_of(safety::Reason::answer_late),
                                 word_of(safety::Reason::state_old)};
/// The only reason of motion that a runaway does not have.
constexpr safety::Reason kNotRunaway = safety::Reason::joint_margin;

std::string listed(std::span<const std::string_view> reasons) {
  return fmt::format("{}", fmt::join(reasons, ", "));
}

std::string ticks(int detection, int more) {
  return detection < 0 ? "–" : std::to_string(detection + more);
}

/// In a position and in a force trial; one number if equal.
std::string off_within(const std::array<int, 2>& detection, int more) {
  const std::string position = ticks(detection[0], more), force = ticks(detection[1], more);
  return position == force ? position : position + " / " + force;
}

std::string_view detects(const UdpFaultKind& kind) {
  switch (kind.expected) {
    case Expected::trip:
      return "";
    case Expected::at_stop:
      return "missing confirmation";
    case Expected::refusal:
      return "refusal to start";
    case Expected::no_harm:
      return "none needed";
    case Expected::not_detected:
      return "**not reliably**";
  }
  return "";
}

std::string_view text(SafeState state) {
  switch (state) {
    case SafeState::confirmed:
      return "yes";
    case SafeState::not_confirmed:
      return "**no**";
    case SafeState::either:
      return "varies";
    case SafeState::unresolved:
      return "**yes, but a small torque remains**";
  }
  return "";
}

/// Reasons that one word of the page stands for.
struct Group {
  std::string_view word;
  std::vector<std::string_view> reasons;
};

/// The largest first.
std::vector<Group> groups() {
  const auto moves = motion_reasons();
  Group motion, runaway, silence;
  motion.word = "motion";
  motion.reasons.assign(moves.begin(), moves.end());
  runaway = {"runaway", motion.reasons};
  std::erase(runaway.reasons, word_of(kNotRunaway));
  silence.word = "silence";
  silence.reasons.assign(kSilence.begin(), kSilence.end());
  return {motion, runaway, silence};
}

bool contains(const std::vector<std::string_view>& list, std::string_view one) {
  return std::ranges::find(list, one) != list.end();
}

/// Each complete group of reasons is one word.
std::string grouped(std::vector<std::string_view> reasons) {
  std::string words;
  for (const Group& group : groups()) {
    if (!std::ranges::all_of(group.reasons, [&](std::string_view one) { return contains(reasons, one); })) continue;
    std::erase_if(reasons, [&](std::string_view one) { return contains(group.reasons, one); });
    words += fmt::format("{}*{}*", words.empty() ? "" : ", ", group.word);
  }
  return listed(reasons) + (reasons.empty() || words.empty() ? "" : ", ") + words;
}

struct Row {
  std::string faults, outcome;
};

/// One row for all faults of the same outcome.
void add(std::string fault, std::string outcome, std::vector<Row>& rows) {
  const auto same = std::ranges::find(rows, outcome, &Row::outcome);
  if (same == rows.end()) {
    rows.push_back({std::move(fault), std::move(outcome)});
  } else {
    same->faults += "<br>" + fault;
  }
}

std::string text(const std::vector<Row>& rows) {
  std::string all;
  for (const Row& row : rows) all += fmt::format("| {} | {} |\n", row.faults, row.outcome);
  return all;
}

std::string udp_table() {
  std::vector<Row> rows;
  for (const UdpFaultKind& kind : udp_fault_kinds()) {
    std::string found(detects(kind));
    const std::string reasons = grouped(kind.reasons);
    if (!reasons.empty()) found += (found.empty() ? "" : "; possibly ") + reasons;
    constexpr int kMore = safety::kRampTicks + kLinkTicks;
    const std::string soon = kind.expected == Expected::trip ? off_within(kind.detection, kMore) : "–";
    add(fmt::format("`{}`{}: {}", kind.name, kind.version > 1 ? " (v2)" : "", kind.what),
        fmt::format("{} | {} | {} | {}", found, soon, text(kind.safe_state), kind.bound), rows);
  }
  return "| Fault | Detected by | Off within | Confirmed | Duty |\n|---|---|---|---|---|\n" + text(rows);
}

std::string function_table() {
  std::vector<Row> rows;
  for (const FaultKind& kind : fault_kinds()) {
    std::vector<std::string_view> reasons;
    for (const safety::Reason one : kind.reasons) reasons.push_back(word_of(one));
    add(kind.name, grouped(std::move(reasons)) + " | " + off_within(kind.detection, safety::kRampTicks), rows);
  }
  return "| Fault | Detected by | Off within |\n|---|---|---|\n" + text(rows);
}

}  // namespace

std::string safety_page() {
  constexpr int kDrivesFound = 60;  // [ms]: the gate waits 50 ms, and a few states
  const auto ramp = fmt::arg("ramp", safety::kRampTicks);
  return fmt::format(fmt::runtime(kBegin), ramp, fmt::arg("off", 1e3 * safety::Limits{}.motors_off),
                     fmt::arg("drives", kDrivesFound), fmt::arg("error", safety::Limits{}.torque_error)) +
         fmt::format(fmt::runtime(kUdp), ramp, fmt::arg("link", kLinkTicks),
                     fmt::arg("motion", listed(motion_reasons())), fmt::arg("silence", listed(kSilence))) +
         udp_table() + fmt::format(fmt::runtime(kFunction), ramp, fmt::arg("not_runaway", word_of(kNotRunaway))) +
         function_table() + fmt::format(fmt::runtime(kBeside), fmt::arg("stall", 1e3 * session::LoopWatch::kLongest)) +
         std::string(kEnd);
}

}  // namespace mbk::validation
