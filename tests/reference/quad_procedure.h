#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mbk/base/core/result.h"

/// The published identification procedure (Dyck 2013, appendix C) in 113-bit arithmetic: the slow twin that `mbk`'s
/// reference mode is held against.
namespace mbk::reference {

enum class Procedure {
  chapter3,  ///< Savitzky–Golay N = 6, W = 101; Butterworth 5 Hz; ẍ is the second derivative of x
  chapter5,  ///< W = 151; 4.5 Hz; ẍ from the accelerometer, smoothed like the force
};

enum class Protocol {
  sinusoidal,   ///< samples 11999 … 61999; the first 40 s identify, the rest validate
  underdamped,  ///< samples from 15999 where the reference is displaced; 8 pulses identify, the rest validate
};

/// What was measured, sample for sample at 1 kHz, base frame.
struct Log {
  std::vector<double> x, y;    ///< hand position [m]
  std::vector<double> Fx, Fy;  ///< force of the hand on the robot [N]
  std::vector<double> xr, yr;  ///< reference [m]
  std::vector<double> ax, ay;  ///< acceleration of the hand [m/s²]; may be empty in chapter 3
};

struct Settings {
  Procedure procedure = Procedure::chapter3;
  Protocol protocol = Protocol::sinusoidal;
  std::optional<double> handle_mass = {};  ///< Λ, removed from the diagonal of M [kg]; chapter 5 asks for one
};

/// M ẍ + B ẋ + K (x − x₀) = −F_h. Matrices row by row: xx, xy, yx, yy.
struct Answer {
  std::array<double, 4> M;    ///< [kg]
  std::array<double, 4> B;    ///< [N·s/m]
  std::array<double, 4> K;    ///< [N/m]
  std::array<double, 2> x0;   ///< [m]
  std::array<double, 2> VAF;  ///< of F_x and F_y on the validation samples [%]
};

/// Both with the VAF of the split: that of parameters which never saw the validation samples.
struct Answers {
  Answer split;  ///< parameters from the identification samples
  Answer all;    ///< from identification and validation samples together (§3.6.2)
};

/// @fails  rows differ in length; a value is not finite; the log is too short; fewer than 9 pulses; chapter 5 without
///         accelerometer rows or handle mass; too few samples to identify or validate.
[[nodiscard]] Result<Answers> identify(const Log& log, const Settings& settings);

}  // namespace mbk::reference
