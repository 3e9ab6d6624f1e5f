#include "mbk/experiment/session/loop.h"

#include <algorithm>
#include <ctime>

namespace mbk::session {
namespace {

using realtime::monotonic_ns;

constexpr std::int64_t kLongestWait = 2'000'000'000;  // [ns]

/// False where the recorder makes no room in time.
bool wait_for_room(const realtime::BoundedRing<journal::Tick>& ticks) noexcept {
  if (ticks.room() > 0) return true;
  const std::int64_t until = monotonic_ns() + kLongestWait;
  constexpr timespec kNap{0, 200'000};
  while (ticks.room() < ticks.capacity() / 2) {
    if (monotonic_ns() > until) return false;
    nanosleep(&kNap, nullptr);
  }
  return true;
}

std::array<double, 2> pair(const Eigen::Vector2d& v) noexcept {
  return {v[0], v[1]};
}

/// The tick as it is recorded.
journal::Tick tick_of(std::uint64_t number, const safety::Observation& seen, const control::Sequencer::Step& step,
                      const safety::Gate::Decision& decision, const safety::Trip& trip) noexcept {
  journal::Tick tick;
  tick.number = number;
  tick.time = seen.time;
  tick.late = seen.late;
  tick.perturbation_time = step.perturbation_time;
  tick.joint = pair(seen.state.joint);
  tick.force = pair(seen.state.force);
  tick.acceleration = pair(seen.state.acceleration);
  tick.reference = pair(step.reference);
  tick.asked = pair(step.torque);
  tick.torque = pair(decision.torque);
  tick.sequence = seen.state.sequence;
  tick.phase = static_cast<std::uint8_t>(step.phase);
  tick.reason = static_cast<std::uint8_t>(trip.reason);
  tick.enabled = decision.enabled ? 1 : 0;
  tick.triggered = step.triggered ? 1 : 0;
  tick.cut = decision.cut ? 1 : 0;
  return tick;
}

}  // namespace

void run_loop(device::Device& robot, control::Sequencer& sequence, safety::Gate& gate, realtime::Clock& clock,
              realtime::BoundedRing<journal::Tick>& ticks, LoopFlags& flags, LoopTimes& times) noexcept {
  const device::Facts& facts = robot.facts();
  safety::Observation seen;
  device::State& state = seen.state;
  seen.robot = facts;
  std::uint64_t last_sequence = 0;
  double compute = 0.0, first_time = 0.0, left = 0.0, interval = 0.0;
  bool link = true;
  clock.start();
  bool awaited = flags.beat();
  for (std::uint64_t number = 0; awaited && !gate.settled(); ++number) {
    const double late = clock.wait();
    const std::int64_t begin = monotonic_ns();
    const bool reads = robot.read(state);
    if (awaited = flags.beat(); !awaited) break;
    const double now = clock.now();  // when the state was here
    link = link && reads;
    if (flags.end_trial.load(std::memory_order_relaxed)) sequence.end_early();
    const bool over = gate.tripped() || gate.off();
    const control::Sequencer::Step step = over ? control::Sequencer::Step{} : sequence.step(state.joint);
    if (step.phase == control::Phase::done && !gate.tripped()) gate.release();

    if (number == 0) {
      first_time = now;
      left = now - clock.period();
    }
    seen.time = now - first_time;
    // a stall inside a tick is in it, before the command left or behind it
    seen.late = std::max(0.0, std::max(now - left, interval) - clock.period());
    seen.fresh = state.sequence != last_sequence;
    seen.link = gate.off() ? reads : link;
    seen.operator_stop = flags.operator_stop.load(std::memory_order_relaxed);
    seen.recording = flags.recording.load(std::memory_order_relaxed) &&
                     (facts.keeps_time ? ticks.room() > ticks.capacity() / 4 : wait_for_room(ticks));
    seen.perturbing = step.phase == control::Phase::perturbing;
    seen.follows = step.follows;
    seen.joint_reference = step.joint_reference;
    const safety::Gate::Decision decision = gate.step(seen, step.torque);
    link = robot.write({number, decision.torque, decision.enabled}) && link;
    if (awaited = flags.beat(); !awaited) break;
    last_sequence = state.sequence;
    const double leaves = clock.now();
    if (number > 0) {
      interval = leaves - left;
      times.interval.add(static_cast<std::int64_t>(1e9 * interval));
    }
    left = leaves;

    journal::Tick tick = tick_of(number, seen, step, decision, gate.trip());
    tick.compute = static_cast<float>(compute);
    ticks.push(tick);

    const std::int64_t took = monotonic_ns() - begin;
    compute = 1e-9 * static_cast<double>(took);
    times.compute.add(took);
    times.lateness.add(static_cast<std::int64_t>(1e9 * late));
    ++times.ticks;
  }
  if (awaited) {
    times.missed += clock.missed();
    times.early += clock.early();
  }
  robot.stop();
}

}  // namespace mbk::session
