#include <fmt/format.h>

#include <algorithm>

#include "mbk/journal/journal.h"

namespace mbk::journal {
namespace {

/// The value of every tick as a channel; with a latency, that of so many ticks later.
template <class Get>
Channel channel(const Journal& journal, const char* name, const char* unit, const char* frame, int latency,
                const Get& get) {
  const Index samples = std::ssize(journal.ticks);
  Channel made{name, unit, frame, Vector(samples)};
  for (Index i = 0; i < samples; ++i) {
    made.values[i] = get(journal.ticks[static_cast<std::size_t>(std::min(i + latency, samples - 1))]);
  }
  return made;
}

using Pair = std::array<double, 2> Tick::*;

void add_pair(Recording& recording, const Journal& journal, std::array<const char*, 2> names, const char* unit,
              const char* frame, Pair values, int latency = 0) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    recording.channels.push_back(
        channel(journal, names[axis], unit, frame, latency, [&](const Tick& tick) { return (tick.*values)[axis]; }));
  }
}

void add_hand(Recording& recording, const Journal& journal) {
  for (Index axis = 0; axis < 2; ++axis) {
    recording.channels.push_back(
        channel(journal, axis == 0 ? "hand_x" : "hand_y", "m", "base", 0, [&](const Tick& tick) {
          return robot::hand_position(journal.header.geometry, {tick.joint[0], tick.joint[1]})[axis];
        }));
  }
}

void add_events(Recording& recording, const Journal& journal) {
  double start = 0.0;
  bool perturbing = false;
  for (const Tick& tick : journal.ticks) {
    if (tick.perturbing() == perturbing) continue;
    perturbing = tick.perturbing();
    recording.events.push_back({tick.time, perturbing ? "perturbation_start" : "perturbation_end", 0.0});
    if (!perturbing) continue;
    start = tick.time - tick.perturbation_time;
    for (const Event& event : journal.header.events) {
      if (start + event.time <= journal.ticks.back().time) {
        recording.events.push_back({start + event.time, event.name, event.value});
      }
    }
  }
  std::ranges::stable_sort(recording.events, {}, &Event::time);
}

}  // namespace

Result<Recording> to_recording(const Journal& journal) {
  if (journal.ticks.empty()) return bad_data("the journal holds no ticks", "the trial ended before it began");
  const Header& header = journal.header;
  Recording recording;
  recording.time.resize(std::ssize(journal.ticks));
  for (Index i = 0; i < recording.time.size(); ++i) {
    recording.time[i] = journal.ticks[static_cast<std::size_t>(i)].time;
  }
  add_hand(recording, journal);
  add_pair(recording, journal, {"joint_1", "joint_2"}, "rad", "joint", &Tick::joint);
  if (header.has_force) {
    add_pair(recording, journal, {"force_x", "force_y"}, "N", "base", &Tick::force, header.force_latency);
  }
  add_pair(recording, journal, {"reference_x", "reference_y"}, header.reference_unit.c_str(), "base", &Tick::reference);
  add_pair(recording, journal, {"torque_1", "torque_2"}, "N.m", "joint", &Tick::torque);
  if (header.has_acceleration) {
    add_pair(recording, journal, {"acceleration_x", "acceleration_y"}, "m/s2", "base", &Tick::acceleration,
             header.force_latency);
  }
  add_events(recording, journal);

  recording.metadata = header.metadata;
  recording.metadata["rate_hz"] = fmt::format("{:g}", header.rate);
  const Ending ending =
      journal.ending.value_or(Ending{"interrupted", "the program or the machine went down while it recorded"});
  recording.metadata["ended"] = ending.how;
  if (!ending.detail.empty()) recording.metadata["ended_detail"] = ending.detail;
  if (!ending.trip.empty()) recording.metadata["trip"] = ending.trip;
  if (!ending.motors.empty()) recording.metadata["motors_off"] = ending.motors;
  if (ending.dropped > 0) recording.metadata["ticks_dropped"] = std::to_string(ending.dropped);
  if (ending.overruns > 0) recording.metadata["ticks_missed"] = std::to_string(ending.overruns);
  double latest = 0.0;
  for (const Tick& tick : journal.ticks) latest = std::max(latest, tick.late);
  recording.metadata["latest_tick_ms"] = fmt::format("{:.3f}", 1e3 * latest);
  return recording;
}

}  // namespace mbk::journal
