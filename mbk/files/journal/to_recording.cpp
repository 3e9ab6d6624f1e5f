#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/files/journal/journal.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::journal {
namespace {

constexpr std::uint64_t kMaxLost = 100'000, kMaxLostPerTick = 100;  // rows of NaN: a number in a file may claim any

/// The samples of the recording: each a tick, or the place of one that was lost.
struct Rows {
  std::vector<const Tick*> ticks;  ///< null: lost
  std::vector<double> times;       ///< [s]
  std::uint64_t left_open = 0;     ///< lost ticks without a row
};

/// Of the ticks [s]: what the header says, else the median of those that follow each other.
double period_of(const Journal& journal) {
  if (!journal.damage.header) return 1.0 / journal.header.rate;
  std::vector<double> periods;
  for (std::size_t i = 1; i < journal.ticks.size(); ++i) {
    const Tick &one = journal.ticks[i - 1], &other = journal.ticks[i];
    if (other.number == one.number + 1 && other.time > one.time) periods.push_back(other.time - one.time);
  }
  if (periods.empty()) return 1e-3;
  return numeric::upper_median(std::move(periods));
}

Rows rows_of(const Journal& journal) {
  const std::vector<Tick>& ticks = journal.ticks;
  const double period = period_of(journal);
  std::uint64_t room = kMaxLost + kMaxLostPerTick * ticks.size();
  Rows rows;
  rows.ticks.reserve(ticks.size() + std::min(room, journal.damage.ticks_lost()));
  rows.times.reserve(rows.ticks.capacity());
  const auto add_lost = [&](std::uint64_t count, double first, double step) {
    if (count > room) {
      rows.left_open += count;
      return;
    }
    room -= count;
    for (std::uint64_t k = 0; k < count; ++k) {
      rows.ticks.push_back(nullptr);
      rows.times.push_back(first + static_cast<double>(k) * step);
    }
  };
  std::uint64_t next = 0;
  double time = 0.0;  // of the tick before; tick 0 is at 0 by definition
  for (const Tick& tick : ticks) {
    if (const std::uint64_t count = tick.number - next; tick.number > next) {
      // Where the loop missed ticks in the same gap, there is more time than the lost ones take.
      const bool begin = next == 0;
      const double step = std::min(period, (tick.time - time) / static_cast<double>(begin ? count : count + 1));
      add_lost(count, begin ? 0.0 : time + step, step);
    }
    rows.ticks.push_back(&tick);
    rows.times.push_back(tick.time);
    next = tick.number + 1;
    time = tick.time;
  }
  if (!journal.damage.lost.empty() && journal.damage.lost.back().first >= next) {
    add_lost(journal.damage.lost.back().count, time + period, period);
  }
  return rows;
}

/// The value of every row as a channel; with a latency, the value `latency` ticks later, which belongs to it. The
/// last rows, whose own has not come, keep the last one.
template <class Get>
Channel channel(const Rows& rows, const QuantityChannels& quantity, std::size_t axis, int latency, const Get& get) {
  const Index samples = std::ssize(rows.ticks);
  Channel made{quantity.several[axis], quantity.unit, quantity.frame, Vector(samples)};
  for (Index i = 0; i < samples; ++i) {
    const Tick* const tick = rows.ticks[static_cast<std::size_t>(i)];
    const Tick* const later = rows.ticks[static_cast<std::size_t>(std::min(i + latency, samples - 1))];
    const bool its_own =
        tick != nullptr && later != nullptr &&
        (i + latency >= samples || later->number - tick->number == static_cast<std::uint64_t>(latency));
    made.values[i] = its_own ? get(*later) : kNaN;
  }
  return made;
}

using Pair = std::array<double, 2> Tick::*;

void add_pair(Recording& recording, const Rows& rows, const QuantityChannels& quantity, Pair values, int latency = 0) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    recording.channels.push_back(
        channel(rows, quantity, axis, latency, [&](const Tick& tick) { return (tick.*values)[axis]; }));
  }
}

void add_hand(Recording& recording, const Rows& rows, const robot::Geometry& geometry) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    recording.channels.push_back(channel(rows, kPositionChannels, axis, 0, [&](const Tick& tick) {
      return robot::hand_position(geometry, {tick.joint[0], tick.joint[1]})[static_cast<Index>(axis)];
    }));
  }
}

/// A perturbation whose first tick was lost began where the next one says, and one whose last was lost ends with the
/// first tick behind the gap: what was lost counts as perturbed, so that nobody measures across it unawares.
void add_events(Recording& recording, const Journal& journal) {
  double start = 0.0;
  bool perturbing = false;
  std::uint64_t next = 0;
  for (const Tick& tick : journal.ticks) {
    if (tick.triggered != 0) recording.events.push_back({tick.time, "trigger", 0.0});
    const bool behind_a_gap = tick.number != std::exchange(next, tick.number + 1);
    if (tick.perturbing() == perturbing) continue;
    perturbing = tick.perturbing();
    const double begun = tick.time - tick.perturbation_time;
    const double time = perturbing && behind_a_gap ? begun : tick.time;
    recording.events.push_back({time, perturbing ? "perturbation_start" : "perturbation_end", 0.0});
    if (!perturbing) continue;
    start = begun;
    for (const Event& event : journal.header.events) {
      if (start + event.time <= journal.ticks.back().time) {
        recording.events.push_back({start + event.time, event.name, event.value});
      }
    }
  }
  std::ranges::stable_sort(recording.events, {}, &Event::time);
}

/// Says how the trial ended, and what of it is missing.
void add_ending(Recording& recording, const Journal& journal, const Rows& rows) {
  const Ending ending = journal.ending.value_or(
      Ending{Ending::How::interrupted, "the program or the computer stopped during the recording"});
  auto& metadata = recording.metadata;
  metadata["ended"] = journal.ended();
  std::string detail = ending.detail;
  if (!journal.ending && journal.damage.bytes > 0) detail += ", or the end of the journal is damaged";
  if (ending.how == Ending::How::other) {
    detail += fmt::format("{}'{}' is unknown to this version of mbk", detail.empty() ? "" : "; ", ending.word());
  }
  if (!detail.empty()) metadata["ended_detail"] = detail;
  if (!ending.trip.empty()) metadata["trip"] = ending.trip;
  if (!ending.motors.empty()) metadata["motors_off"] = ending.motors;
  if (ending.dropped > 0) metadata["ticks_dropped"] = std::to_string(ending.dropped);
  if (ending.overruns > 0) metadata["ticks_missed"] = std::to_string(ending.overruns);
  if (!journal.damage.any()) return;
  auto said = journal.damage.sentences();
  if (!journal.damage.lost.empty()) {
    metadata["ticks_lost"] = std::to_string(journal.damage.ticks_lost());
    metadata["gaps"] = journal.damage.gaps();
  }
  if (rows.left_open > 0) said.push_back(fmt::format("{} missing ticks have no row of NaN", rows.left_open));
  metadata["journal_damage"] = fmt::format("{}", fmt::join(said, "; "));
}

}  // namespace

std::string Journal::ended() const {
  const std::string how(ending ? ending->word() : word_of(Ending::How::interrupted));
  const std::uint64_t lost = damage.ticks_lost();
  if (lost > 0) return fmt::format("{}, but {} of {} ticks were lost", how, lost, lost + ticks.size());
  if (damage.header) return how + ", but the journal's header was lost";
  return incomplete() && ending ? how + ", but ticks may have been lost" : how;
}

Result<Recording> to_recording(const Journal& journal) {
  if (journal.ticks.empty()) return bad_data("the journal contains no ticks", "the trial ended before it began");
  const Header& header = journal.header;
  const bool known = !journal.damage.header;
  const Rows rows = rows_of(journal);
  Recording recording;
  recording.time = Eigen::Map<const Vector>(rows.times.data(), std::ssize(rows.times));
  if (known) add_hand(recording, rows, header.geometry);
  add_pair(recording, rows, kJointChannels, &Tick::joint);
  if (header.has_force) {
    add_pair(recording, rows, kForceChannels, &Tick::force, header.force_latency);
  }
  if (known) {
    QuantityChannels reference = kReferenceChannels;
    reference.unit = header.reference_unit.c_str();
    add_pair(recording, rows, reference, &Tick::reference);
  }
  add_pair(recording, rows, kTorqueChannels, &Tick::torque);
  if (header.has_acceleration) {
    add_pair(recording, rows, kAccelerationChannels, &Tick::acceleration, header.force_latency);
  }
  add_events(recording, journal);

  recording.metadata = header.metadata;
  if (known) recording.metadata["rate_hz"] = fmt::format("{:g}", header.rate);
  add_ending(recording, journal, rows);
  double latest = 0.0;
  for (const Tick& tick : journal.ticks) latest = std::max(latest, tick.late);
  recording.metadata["latest_tick_ms"] = fmt::format("{:.3f}", 1e3 * latest);
  return recording;
}

}  // namespace mbk::journal
