#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/words.h"
#include "mbk/base/numeric/random.h"
#include "mbk/experiment/protocol/experiment.h"
#include "mbk/experiment/safety/trip.h"
#include "mbk/validate/faulty_device.h"

namespace mbk::validation {

/// What the robot is told to do while a fault comes.
enum class TrialKind { position, force };

[[nodiscard]] constexpr auto word_table(TrialKind) {
  using enum TrialKind;
  return std::to_array<Word<TrialKind>>({{position, "position"}, {force, "force"}});
}

/// What goes wrong beside the robot.
enum class Outside {
  nothing,
  operator_stop,    ///< from another thread
  stalled_clock,    ///< the machine holds the loop up
  stalled_recorder  ///< the recorder's thread takes no more ticks
};

/// One trial with its fault.
struct FaultRun {
  TrialKind kind = TrialKind::position;
  protocol::Trial trial;
  DeviceFault fault;
  Outside outside = Outside::nothing;
  std::uint64_t stall = 0;  ///< ticks, of a stalled clock
  bool keeps_time = false;  ///< the robot moves on by itself, whatever comes
};

/// When the fault may begin.
enum class Onset {
  beginning,   ///< at the first tick
  anywhere,    ///< at any tick of the trial that leaves it time to be found
  perturbing,  ///< while the hand is perturbed
  moving,      ///< from the way to the test location to the end of the perturbation
  ending,      ///< in the last tenth of a second before the trial is over
};

[[nodiscard]] constexpr auto word_table(Onset) {
  using enum Onset;
  return std::to_array<Word<Onset>>({{beginning, "beginning"},
                                     {anywhere, "anywhere"},
                                     {perturbing, "perturbing"},
                                     {moving, "moving"},
                                     {ending, "ending"}});
}

/// A kind of fault: what it is, and what is documented of it; a row of tables/faults.toml.
struct FaultKind {
  std::string name;
  Onset onset = Onset::anywhere;
  std::array<int, 2> detection{};       ///< ticks to the trip at most, in a trial of positions and of forces
  std::vector<safety::Reason> reasons;  ///< every one that is right
  std::function<void(FaultRun&, numeric::Random&)> make;
};

/// All of them.
[[nodiscard]] const std::vector<FaultKind>& fault_kinds();

/// The experiment that the faults come into, of 11 s: soft start, move and rest of 1 s each, 6 s of perturbation, way
/// back and soft stop.
/// @param perturbed  so long instead [s]   @param moving_in, peak_force  at its beginning [s] and throughout [N], in a
/// trial of forces
[[nodiscard]] std::string fault_experiment(TrialKind kind, double perturbed = 6.0, double moving_in = 5.0,
                                           double peak_force = 6.0);
inline constexpr int kPerturbationBegins = 3000, kPerturbationEnds = 9000, kTrialEnds = 11000;  // ticks

}  // namespace mbk::validation
