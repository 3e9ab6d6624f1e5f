#pragma once

#include <cstdint>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/perturbation/schedule.h"
#include "mbk/simulate/laboratory/performance.h"
#include "mbk/simulate/laboratory/prescribed_motion.h"
#include "mbk/simulate/laboratory/surface_emg.h"
#include "mbk/simulate/participant/elbow_joint.h"

namespace mbk::laboratory {

/// An elbow that a machine moves along the schedule exactly: no servo, and nothing that the limb does moves it.
struct ElbowTrial {
  double home = 1.5707963267948966;  ///< angle about which the schedule moves [rad]
  participant::ElbowJoint::Options elbow;
  PrescribedMotionSensors sensors;  ///< [rad, N·m]; the acceleration is not used
  SurfaceEmgOptions emg;
};

/// Channels position [rad], reaction [N·m], reference [rad], emg_biceps and emg_triceps [V]. Metadata hold the truth:
/// truth_M, truth_B, truth_K, truth_x0, truth_energy_absorbed_J, truth_weight_Nm, truth_horizontal_rad,
/// truth_electromechanical_delay_s, truth_activation_time_s, truth_emg_largest_V, truth_emg_noise_V; of each muscle
/// truth_MUSCLE_torque_Nm, truth_MUSCLE_background; if it has a reflex threshold truth_MUSCLE_threshold_rad,
/// …_spread_rad, …_velocity_gain_s, …_reflex_gain_Nm_per_rad, …_latency_s; if it has responses arrays
/// truth_MUSCLE_response_latency_s, …_duration_s, …_activation. For stretches of a muscle with a threshold, arrays by
/// speed, ascending:
///   truth_stretch_speed_rad_per_s    v
///   truth_stretch_threshold_rad      angle at which the dynamic threshold λ − μ θ̇ is crossed (plateau: λ − μ v)
///   truth_stretch_emg_rad            angle at the onset of the EMG, a latency later
///   truth_stretch_catch_rad          angle at the onset of the reflex torque, the electromechanical delay later
/// with λ without its spread; null where the threshold is not crossed during the motion.
/// @fails  as participant::ElbowJoint::create, SurfaceEmg::create and record.
[[nodiscard]] Result<Performance> record_elbow(const ElbowTrial& trial, const perturbation::Schedule& schedule,
                                               std::uint64_t seed, Hertz rate);

}  // namespace mbk::laboratory
