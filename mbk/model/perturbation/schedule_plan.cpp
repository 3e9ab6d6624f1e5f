#include "mbk/model/perturbation/schedule_plan.h"

#include <cmath>
#include <utility>

#include "mbk/model/perturbation/interleaved.h"
#include "mbk/model/perturbation/odd_grid.h"
#include "mbk/model/perturbation/optimal_power.h"
#include "mbk/model/perturbation/phases.h"

namespace mbk::perturbation {
namespace {

/// Streams of the seed for the phases of the axes, one after another.
constexpr std::uint32_t kPhases = 10;

/// Seed of the lines that an odd grid leaves out: realisations are compared line by line.
constexpr std::uint64_t kGrid = 1;

/// Amplitudes up to a common factor.
Result<std::vector<double>> relative_amplitudes(const MultisinePlan& plan) {
  std::vector<double> amplitudes(plan.harmonics.size(), 1.0);
  if (!plan.optimal_power) return amplitudes;
  const auto power = MBK_TRY(optimal_power(plan.period, plan.harmonics, *plan.optimal_power));
  for (std::size_t k = 0; k < amplitudes.size(); ++k) {
    amplitudes[k] = std::sqrt(power.shares[static_cast<Index>(k)]);
  }
  return amplitudes;
}

/// One axis with its phases, its size still open.
Result<Multisine> sines(const MultisinePlan& plan, std::uint64_t seed, std::uint32_t axis) {
  const auto amplitudes = MBK_TRY(relative_amplitudes(plan));
  return Multisine::with_random_phases(plan.period, plan.harmonics, amplitudes, seed, kPhases + axis);
}

Result<Multisine> with_phases(const MultisinePlan& plan, const Multisine& signal, std::uint64_t seed) {
  switch (plan.phases) {
    case MultisinePlan::Phases::random:
      break;
    case MultisinePlan::Phases::schroeder:
      return with_schroeder_phases(signal);
    case MultisinePlan::Phases::low_crest:
      return with_low_crest_phases(signal, {.seed = seed});
  }
  return signal;
}

Result<std::vector<Multisine>> all_axes(const MultisinePlan& plan, std::uint64_t seed, int count) {
  std::vector<Multisine> axes;
  for (int i = 0; i < count; ++i) {
    auto axis = MBK_TRY(sines(plan, seed, static_cast<std::uint32_t>(i)));
    axes.push_back(std::move(axis));
  }
  if (plan.axes == MultisinePlan::Axes::interleaved) return interleaved(axes.front(), count);
  return axes;
}

Result<Schedule> schedule_of(const MultisinePlan& given, std::uint64_t schedule_seed, int count) {
  MultisinePlan plan = given;
  if (plan.odd_grid) {
    plan.harmonics = MBK_TRY(odd_grid(plan.odd_grid->highest, plan.odd_grid->group, kGrid));
  }
  const std::uint64_t seed = plan.phase_seed.value_or(schedule_seed);
  using Axes = MultisinePlan::Axes;
  if (count != 2 && (plan.axes == Axes::hadamard_first || plan.axes == Axes::hadamard_second)) {
    return bad_usage("orthogonal pairs of experiments need two axes", "use independent or interleaved axes");
  }
  auto axes = MBK_TRY(all_axes(plan, seed, count));
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto axis = MBK_TRY(with_phases(plan, axes[i], seed + i));
    axes[i] = axis.scaled(plan.peak / axis.peak());
  }
  if (plan.axes == Axes::hadamard_second) axes[1] = axes[1].scaled(-1.0);
  return Schedule::multisine(std::move(axes), plan.quantity, plan.space, plan.duration, plan.moving_in);
}

Result<Schedule> schedule_of(const PulsePlan& plan, std::uint64_t seed, int axes) {
  PulseSchedule::Options pulses = plan.pulses;
  pulses.axes = axes;
  pulses.seed = seed;
  return Schedule::pulses(pulses, plan.quantity, plan.tail, plan.space);
}

Result<Schedule> schedule_of(const RandomBinaryPlan& plan, std::uint64_t seed, int /*axes*/) {
  RandomBinaryOptions sequence = plan.sequence;
  sequence.seed = seed;
  return Schedule::random_binary(sequence, plan.angle, plan.quantity, plan.duration, plan.space);
}

Result<Schedule> schedule_of(const RampPlan& plan, std::uint64_t seed, int /*axes*/) {
  RampAndHold::Options ramps = plan.ramps;
  ramps.seed = seed;
  return Schedule::ramps(ramps, plan.tail, plan.space);
}

Result<Schedule> schedule_of(const StretchPlan& plan, std::uint64_t seed, int /*axes*/) {
  Stretches::Options stretches = plan.stretches;
  stretches.seed = seed;
  return Schedule::stretches(stretches, plan.tail, plan.space);
}

Result<Schedule> schedule_of(const ReachPlan& plan, std::uint64_t seed, int /*axes*/) {
  ReachSchedule::Options reaches = plan.reaches;
  reaches.seed = seed;
  return Schedule::reaches(reaches, plan.tail);
}

Result<Schedule> schedule_of(const RestPlan& plan, std::uint64_t /*seed*/, int /*axes*/) {
  return Schedule::rest(plan.duration);
}

}  // namespace

Result<Schedule> make_schedule(const Plan& plan, std::uint64_t seed) {
  auto schedule = std::visit([&](const auto& kind) { return schedule_of(kind, seed, plan.axes); }, plan.kind);
  if (!schedule) return tl::unexpected(schedule.error().in("perturbation"));
  if (auto ok = schedule->check(plan.limits); !ok) return tl::unexpected(ok.error().in("perturbation"));
  return schedule;
}

}  // namespace mbk::perturbation
