#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "mbk/model/trial/teleoperation.h"
#include "mbk/simulate/laboratory/packet_line.h"
#include "mbk/simulate/participant/load.h"
#include "mbk/teleop/design.h"

namespace mbk::laboratory {

/// Time-domain teleoperator: two robots of one axis, Z = m s + b each, integrated by Runge–Kutta, with motor commands
/// held over each tick,
///   u_m = C₆ f_h − C_m x_m + D₂{C₂ f_e − C₄ x_s},   u_s = C₅ f_e − C_s x_s + D₁{C₃ f_h + C₁ x_m}
/// with the symbols of teleop/architectures.h; C x is k x + d ẋ + m ẍ of the values read at the tick, f_h and f_e are
/// the forces of hand and environment on their robots, D₁ and D₂ are packet lines.
struct TeleoperationSetup {
  teleop::Teleoperator teleoperator;  ///< its delays are those of the lines
  double sample_time = 1e-3;          ///< of the controllers and packets [s] > 0
  double duration = 20.0;             ///< [s] > 0
  double kick = 0.5;                  ///< impulse on the master during the first tick [N·s]; all is at rest before
  PacketLineOptions line;             ///< of both directions, except the delay
  std::uint64_t seed = 1;             ///< random seed of losses
  /// Largest damping of a passivity controller in series between the master's motor and its robot [N·s/m]; absent: none
  std::optional<double> passivity_controller;
  int steps_per_tick = 4;  ///< of the integration
};

/// Forces, positions and what came of them. The columns have one entry for each tick.
struct TeleoperationMotion {
  std::vector<double> time, master_position, slave_position, master_velocity, slave_velocity;
  bool ran_away = false;  ///< a robot moved beyond kFurthest; the motion ends there
  long sent = 0, lost = 0;
  std::optional<double> lowest_energy;  ///< of the passivity controller [J]
};

inline constexpr double kFurthest = 10.0;  ///< [m]

/// @param hand, environment  at the master and at the slave, at rest at 0 [m, N]
/// @fails  usage: a robot has no mass; a number is out of its range; as PacketLine and the passivity controller.
[[nodiscard]] Result<TeleoperationMotion> simulate(const TeleoperationSetup& setup, participant::Load<1>& hand,
                                                   participant::Load<1>& environment);

/// Whether a motion decays: rms speed of both robots in the last quarter of the time divided by that in the second.
/// Below 1/2 it decays; above 2, or beyond the limit, it grows. A quarter of the time must contain several periods of
/// the slowest oscillation, otherwise that is read as growth.
struct MotionVerdict {
  MotionOutcome outcome = MotionOutcome::bounded;
  double ratio = 0.0;
  /// Of the faster robot in the last quarter, from the times at which its velocity changes sign; 0 with fewer than 3.
  RadPerSec frequency;
  double growth = 0.0;  ///< ln ratio over the time from the second to the last quarter [1/s]; 0 at rest
};
[[nodiscard]] MotionVerdict judge(const TeleoperationMotion& motion);

/// An eighth of the Nyquist frequency, above which a sampled controller deviates strongly from its design.
[[nodiscard]] RadPerSec highest_shown(double sample_time);

/// Duration required to show growth with the terminations [s]: sixteen times 1/σ, from 5 to 100 s.
[[nodiscard]] double duration_to_show(const WorstTerminations& worst);

/// The two arms, the worst passive pair, and the worst with the operator.
inline constexpr int kMaxRuns = 3;

/// The simulation of a design: its arms and, if a criterion finds it not stable, the terminations that show this
/// (teleop/worst_terminations.h).
/// @param a  of the operator, if given
/// @fails  usage: the design is a two-port, not an architecture; as `simulate`.
[[nodiscard]] Result<TeleoperationSimulation> simulate(const teleop::Design& design, std::optional<double> a,
                                                       const std::function<void(double)>& progress = {});

}  // namespace mbk::laboratory
