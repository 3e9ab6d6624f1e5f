#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/model/perturbation/optimal_power.h"
#include "mbk/model/perturbation/ramp_and_hold.h"
#include "mbk/model/perturbation/random_binary.h"
#include "mbk/model/perturbation/reach_schedule.h"
#include "mbk/model/perturbation/schedule.h"
#include "mbk/model/perturbation/stretches.h"
#include "mbk/model/perturbation/underdamped_pulse.h"

namespace mbk::perturbation {

/// Sums of sines, one for each axis or joint, with phases and power by a stated rule.
struct MultisinePlan {
  enum class Phases { random, schroeder, low_crest };
  /// Separate phases for each axis, lines dealt out to the axes in turn (interleaved.h), or the first or second of a
  /// pair of experiments that differ in the sign of the second axis.
  enum class Axes { independent, interleaved, hadamard_first, hadamard_second };
  /// Only odd lines, with one omitted per group (odd_grid.h), the same for all seeds.
  struct OddGrid {
    int highest = 59;
    int group = 4;
  };
  Quantity quantity = Quantity::position;
  Space space = Space::joint;
  double peak = 0.034906585039886591;  ///< of each axis: ±2° by default [rad, m, N or N·m]
  double period = 10.0;                ///< [s]
  std::vector<int> harmonics = {1, 4, 7, 10, 13, 16, 20, 23, 26, 29};
  std::optional<OddGrid> odd_grid;  ///< in place of `harmonics`
  Phases phases = Phases::random;
  /// Seed of the phases; absent: the schedule's seed. A different seed gives a different realisation; a pair of
  /// orthogonal experiments shares it.
  std::optional<std::uint64_t> phase_seed;
  std::optional<OptimalPowerOptions> optimal_power;  ///< absent: the same at every line
  Axes axes = Axes::independent;
  double duration = 62.1;  ///< [s]
  double moving_in = 5.0;  ///< from rest [s]
};

[[nodiscard]] constexpr auto word_table(MultisinePlan::Phases) {
  using enum MultisinePlan::Phases;
  return std::to_array<Word<MultisinePlan::Phases>>(
      {{random, "random"}, {schroeder, "schroeder"}, {low_crest, "low_crest"}});
}

[[nodiscard]] constexpr auto word_table(MultisinePlan::Axes) {
  using enum MultisinePlan::Axes;
  return std::to_array<Word<MultisinePlan::Axes>>({{independent, "independent"},
                                                   {interleaved, "interleaved"},
                                                   {hadamard_first, "hadamard_first"},
                                                   {hadamard_second, "hadamard_second"}});
}

/// Underdamped pulses in random order.
struct PulsePlan {
  Quantity quantity = Quantity::position;
  Space space = Space::hand;
  PulseSchedule::Options pulses;
  double tail = 3.0;  ///< recorded after the last pulse [s]
};

/// A filtered random binary sequence along one line.
struct RandomBinaryPlan {
  Quantity quantity = Quantity::force;
  Space space = Space::hand;
  RandomBinaryOptions sequence;
  double angle = 1.5707963267948966;  ///< of the line from +x [rad]
  double duration = 62.1;             ///< [s]
};

/// Ramps and holds of the position in random order.
struct RampPlan {
  Space space = Space::hand;
  RampAndHold::Options ramps;
  double tail = 1.0;  ///< recorded after the last return [s]
};

/// Stretches at constant velocity.
struct StretchPlan {
  Space space = Space::joint;
  Stretches::Options stretches;
  double tail = 1.0;  ///< recorded after the last return [s]
};

/// Servo displacements of a hand that reaches.
struct ReachPlan {
  ReachSchedule::Options reaches;
  double tail = 1.0;  ///< recorded after the last interval [s]
};

/// Nothing is commanded.
struct RestPlan {
  double duration = 10.0;  ///< [s]
};

struct Plan {
  std::variant<RestPlan, MultisinePlan, PulsePlan, RandomBinaryPlan, RampPlan, StretchPlan, ReachPlan> kind =
      MultisinePlan{};
  Limits limits;  ///< limits of the schedule
  int axes = 2;   ///< 3: in space; multisines and pulses alone
};

/// The schedule of a plan with a seed.
/// @fails  usage: as the perturbation; a limit is exceeded.
[[nodiscard]] Result<Schedule> make_schedule(const Plan& plan, std::uint64_t seed);

}  // namespace mbk::perturbation
