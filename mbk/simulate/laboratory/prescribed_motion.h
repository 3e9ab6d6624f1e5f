#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/perturbation/schedule.h"
#include "mbk/model/trial/protocol.h"
#include "mbk/model/trial/recording.h"

namespace mbk::laboratory {

/// Relaxed arm of participant 1 (rebuilt from Dyck 2013, tables 3.3 and 3.5, with k_a = 7.7 N/m), 2 axes.
[[nodiscard]] impedance::Model relaxed_arm();

/// The y axis of `relaxed_arm` alone.
[[nodiscard]] impedance::Model relaxed_arm_one_axis();

/// Sensor errors. Zero disables a part.
struct PrescribedMotionSensors {
  double position_quantum = 2e-6;       ///< positions are rounded to multiples of it [m]
  double force_noise = 0.02;            ///< white, standard deviation [N]
  double coloured_force_noise = 0.0;    ///< low-passed to first order, standard deviation [N]
  Hertz coloured_force_bandwidth{1.5};  ///< its −3 dB frequency
  double acceleration_noise = 0.02;     ///< white, standard deviation [m/s²]
};

struct PrescribedMotionOptions {
  /// Sinusoidal: ten sines up to 3 Hz within a circle (in space a sphere) of 2 cm, moving in over the first seconds.
  /// Underdamped: 16 steps of 5 mm in random directions (in space 52), at rest in between (Dyck 2013, §3.4).
  Protocol protocol = Protocol::sinusoidal;
  impedance::Model limb = relaxed_arm();      ///< the true model; one to three axes, as recorded
  Vector home = Eigen::Vector2d(0.28, 0.02);  ///< initial hand position, base frame [m]; one entry per axis
  PrescribedMotionSensors sensors;
  std::uint64_t seed = 1;  ///< of phases, pulses and noise

  double period = 10.0;                                                ///< of the sinusoidal protocol's sines [s]
  std::vector<int> harmonics = {1, 4, 7, 10, 13, 16, 20, 23, 26, 29};  ///< of 1/period: 0.1 … 2.9 Hz
  double radius = 0.01;                                                ///< radius of the circle filled by the sines [m]
  double moving_in = 5.0;             ///< the sines grow from rest over this time [s]; the published window
                                      ///< begins at 12 s
  double sinusoidal_duration = 62.1;  ///< [s]; the published procedure needs 62 s

  perturbation::PulseSchedule::Options pulses = {};  ///< of the underdamped protocol; `seed` above is used
  double tail = 3.0;                                 ///< recorded after the last pulse [s]
};

/// The motion of the hand in closed form: it follows a schedule of displacements from home exactly.
class PrescribedMotion {
 public:
  /// @param home  one to three entries, not more than the schedule has [m]
  /// @param schedule  of positions of the hand
  PrescribedMotion(Vector home, perturbation::Schedule schedule)
      : home_(std::move(home)), schedule_(std::move(schedule)) {}

  /// With one axis, pulses go along ±x, as many as there would be in all directions.
  /// @fails  protocol is free (nothing moves the hand); the limb has not one to three axes, is not square or not
  /// finite;
  ///         home has another size; a length or time is not above zero; as perturbation::Schedule.
  [[nodiscard]] static Result<PrescribedMotion> create(const PrescribedMotionOptions& options);

  /// x, ẋ, ẍ of the hand [m, m/s, m/s²], one entry per axis.
  [[nodiscard]] perturbation::Jet<perturbation::AxesVector> at(double t) const;

  /// The reference of the robot at t [m]: for sines the hand position; for pulses home, displaced during a pulse.
  [[nodiscard]] perturbation::AxesVector reference(double t) const;

  [[nodiscard]] Index axes() const { return home_.size(); }
  /// Whether the positions are angles of a joint.
  [[nodiscard]] bool turns() const { return schedule_.space() == perturbation::Space::joint; }
  [[nodiscard]] double duration() const { return schedule_.duration(); }  ///< [s]

  /// For every pulse an "onset" and an "offset" whose value is the direction's angle from +x [rad].
  [[nodiscard]] std::vector<Event> events() const;

 private:
  Vector home_;
  perturbation::Schedule schedule_;
};

/// The force that a limb exerts on the robot [N] while the hand moves like this [m, m/s, m/s²].
using HandForce = std::function<perturbation::AxesVector(const perturbation::Jet<perturbation::AxesVector>& hand)>;

/// A recording of a prescribed motion and the limb's force, with the sensors' rounding and noise. There is no loop:
/// nothing that the limb does moves the robot, and neither bias from feedback nor loss of the motion can occur.
/// Sample i is at (i + 1)/rate. Two axes: hand_x, hand_y, force_x, force_y, reference_x, reference_y, acceleration_x,
/// acceleration_y; three likewise; one axis: position, reaction, reference, acceleration. A joint that turns, in rad
/// and N·m, has no accelerometer. Metadata hold the sensors' options with 17 digits.
/// @param force  called once for each sample, in order
/// @param seed  of the noise
/// @fails  usage: rate ≤ 0; a sensor option is negative or not finite. data: a force is not finite, with the time.
[[nodiscard]] Result<Recording> record(const PrescribedMotion& motion, const HandForce& force,
                                       const PrescribedMotionSensors& sensors, std::uint64_t seed, Hertz rate);

/// The recording of a limb that responds to a prescribed motion with
///   F_h = −(M ẍ + B ẋ + K (x − x₀))                                       (Dyck 2013, eq. 3.2)
/// so that the truth behind it is exact. Metadata also hold protocol, seed and truth_M, truth_B, truth_K, truth_x0 as
/// JSON arrays with 17 digits.
/// @param rate  sample rate > 0
/// @fails  as PrescribedMotion::create and record.
[[nodiscard]] Result<Recording> record_prescribed_motion(const PrescribedMotionOptions& options, Hertz rate);

}  // namespace mbk::laboratory
