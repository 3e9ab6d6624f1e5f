#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

namespace mbk::journal {

/// All data of one tick of a session. Base frame, SI units.
struct Tick {
  std::uint64_t number = 0;              ///< from 0, in the trial; a gap: ticks that were dropped
  double time = 0.0;                     ///< since the trial's first tick, by the loop's clock [s]
  double late = 0.0;                     ///< from the command before to this one, beyond a tick [s]
  double perturbation_time = -1.0;       ///< of the schedule [s]; negative outside the perturbation
  std::array<double, 2> joint{};         ///< as measured [rad]
  std::array<double, 2> force{};         ///< of the hand on the robot, as measured [N]
  std::array<double, 2> acceleration{};  ///< as measured [m/s²]
  std::array<double, 2> reference{};     ///< hand position [m], or force [N]
  std::array<double, 2> asked{};         ///< torque requested by the controller [N·m]
  std::array<double, 2> torque{};        ///< torque after the safety gate [N·m]
  std::uint64_t sequence = 0;            ///< of the robot's sample
  float compute = 0.0F;                  ///< duration of the previous tick [s]
  std::uint8_t phase = 0;                ///< control::Phase
  std::uint8_t reason = 0;               ///< safety::Reason
  std::uint8_t enabled : 1 = 0;          ///< drives on
  std::uint8_t triggered : 1 = 0;        ///< a reaching hand passed the trigger
  std::uint8_t cut = 0;                  ///< the controller requested more than its limits

  [[nodiscard]] bool perturbing() const { return perturbation_time >= 0.0; }
};

static_assert(std::is_trivially_copyable_v<Tick> && sizeof(Tick) == 144 && alignof(Tick) == 8);

}  // namespace mbk::journal
