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

/// A teleoperator in time: two robots of one axis, Z = m s + b each, integrated by Runge–Kutta, whose motors are
/// commanded once a tick and held,
///   u_m = C₆ f_h − C_m x_m + D₂{C₂ f_e − C₄ x_s},   u_s = C₅ f_e − C_s x_s + D₁{C₃ f_h + C₁ x_m}
/// in the words of teleop/architectures.h; C x stands for k x + d ẋ + m ẍ of what is read at the tick, f_h and f_e are
/// what hand and environment exert on their robots, D₁ and D₂ are lines of packets.
struct TeleoperationSetup {
  teleop::Teleoperator teleoperator;  ///< its delays are those of the lines
  double sample_time = 1e-3;          ///< of the controllers and packets [s] > 0
  double duration = 20.0;             ///< [s] > 0
  double kick = 0.5;                  ///< impulse on the master during the first tick [N·s]; all is at rest before
  PacketLineOptions line;             ///< of both directions, but for the delay
  std::uint64_t seed = 1;             ///< of what the lines lose
  /// Largest damping of a passivity controller in series between the master's motor and its robot [N·s/m]; absent: none
  std::optional<double> passivity_controller;
  int steps_per_tick = 4;  ///< of the integration
};

/// Forces, positions and what came of them. The columns have one entry for each tick.
struct TeleoperationMotion {
  std::vector<double> time, master_position, slave_position, master_velocity, slave_velocity;
  bool ran_away = false;  ///< a robot went further than kFurthest; the motion ends there
  long sent = 0, lost = 0;
  std::optional<double> lowest_energy;  ///< of the passivity controller [J]
};

inline constexpr double kFurthest = 10.0;  ///< [m]

/// @param hand, environment  at the master and at the slave, at rest at 0 [m, N]
/// @fails  usage: a robot has no mass; a number is out of its range; as PacketLine and the passivity controller.
[[nodiscard]] Result<TeleoperationMotion> simulate(const TeleoperationSetup& setup, participant::Load<1>& hand,
                                                   participant::Load<1>& environment);

/// Whether a motion dies out, by its own numbers: root mean square speed of both robots in the last quarter of the time
/// over that in the second. Below 1/2 it dies out, above 2, or where it ran away, it grows. A quarter of the time must
/// hold several turns of the slowest swing, or that is taken for growth.
struct MotionVerdict {
  MotionOutcome outcome = MotionOutcome::bounded;
  double ratio = 0.0;
  /// Of the faster robot in the last quarter, from the times at which its velocity changes sign; 0 with fewer than 3.
  RadPerSec frequency;
  double growth = 0.0;  ///< ln ratio over the time from the second to the last quarter [1/s]; 0 where it stands still
};
[[nodiscard]] MotionVerdict judge(const TeleoperationMotion& motion);

/// An eighth of the Nyquist frequency, above which a sampled controller is far from what it was designed as.
[[nodiscard]] RadPerSec highest_shown(double sample_time);

/// How long terminations need to show what they do [s]: sixteen times 1/σ, from 5 to 100 s.
[[nodiscard]] double duration_to_show(const WorstTerminations& worst);

/// The two arms, the worst passive pair, and the worst with the operator.
inline constexpr int kMaxRuns = 3;

/// The simulation that a design asks for: its arms, and, where a criterion says that the design is not stable, the
/// terminations that show it (teleop/worst_terminations.h).
/// @param a  of the operator, where one is given
/// @fails  usage: the design is a two-port and no architecture; as `simulate`.
[[nodiscard]] Result<TeleoperationSimulation> simulate(const teleop::Design& design, std::optional<double> a,
                                                       const std::function<void(double)>& progress = {});

}  // namespace mbk::laboratory
