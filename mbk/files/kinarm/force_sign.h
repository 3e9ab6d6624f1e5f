#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::recording {

/// Evidence of one trial for the sign of the force sensor. All vectors have equal length.
struct ForceEvidence {
  Vector sensor_x, sensor_y;              ///< [N], as stored
  Vector commanded_x, commanded_y;        ///< [N], of the motors on the hand; empty: none known, taken as 0
  Vector velocity_x, velocity_y;          ///< [m/s] of the hand
  Vector acceleration_x, acceleration_y;  ///< [m/s²]; empty: not known
};

/// The sign of a force sensor from the equation of motion of the robot: whoever causes the motion, its mass m > 0 with
/// friction b ≥ 0 is accelerated by the commanded force F_c of its motors and the force F_h of the hand,
///
///     m a + b v = F_c + s·F_sensor,  s = ±1,
///
/// where F_h = s·F_sensor. For either sign m and b are fitted within plausible values (0 ≤ m ≤ 5 kg, 0 ≤ b ≤ 3 N·s/m),
/// after subtracting the means of the trial. The sign with the much smaller residual is selected. This is valid for
/// passive and voluntary motion, because no assumption is made about the limb.
struct ForceSign {
  enum class Verdict { as_stored, turned, undecided };
  Verdict verdict = Verdict::undecided;
  int trials = 0;                      ///< number of trials with evidence
  double unexplained[2] = {1.0, 1.0};  ///< share of the forces' energy with s = +1, s = −1
  double mass[2] = {0.0, 0.0};         ///< [kg] that goes with them
  double blocks_for = 0.0;             ///< share of blocks of samples in which the better sign is the better
  bool commanded = false;              ///< the motors received non-zero commands
};

/// Adds up the evidence of trials.
class ForceSignTest {
 public:
  void add(const ForceEvidence& evidence);
  [[nodiscard]] ForceSign result() const;

 private:
  /// Sums over the samples of a block, of both axes.
  struct Moments {
    double sensor_sensor = 0, sensor_commanded = 0, commanded_commanded = 0;
    double sensor_a = 0, commanded_a = 0, sensor_v = 0, commanded_v = 0;
    double aa = 0, av = 0, vv = 0;
    Moments& operator+=(const Moments& other);
  };
  struct Fit {
    double mass = 0, friction = 0;
  };
  static double residual(const Moments& sums, double sign, const Fit& fit);
  static Fit best(const Moments& sums, double sign);

  std::vector<Moments> blocks_;
  int trials_ = 0;
};

/// One sentence: the sign and the evidence.   @param sensor  "Right_FS_ForceX and Right_FS_ForceY"
[[nodiscard]] std::string force_sign_note(const ForceSign& sign, const std::string& sensor);

}  // namespace mbk::recording
