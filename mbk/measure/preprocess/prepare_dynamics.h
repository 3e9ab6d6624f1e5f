#pragma once

#include <optional>

#include "mbk/measure/preprocess/options.h"
#include "mbk/model/robot/dynamic_model.h"
#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/prepared_dynamics.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

struct DynamicsOptions {
  Options signals;           ///< smoothing, cutoff, padding, window and decimation
  bool instruments = false;  ///< make them too
  std::optional<Hertz>
      motion_cutoff;  ///< of the smoothed motion that serves as instrument; absent: the band of the torque
};

/// Torques and regressors of a robot that moves with nothing at its hand. Motion and torque are smoothed, the
/// regressors are made of the smoothed motion, and then every column, torques included, passes the same low-pass: what
/// friction makes of a reversal loses to the filter on both sides alike (Gautier 1997). So the smoothing before it is
/// short where there is dry friction: just long enough that the velocity has less noise than a twentieth of the
/// velocity over which friction changes its sign. A joint that stands still has neither velocity nor acceleration,
/// whatever its encoder flickers; where the model has dry friction, which holds it, its rows are zero, so that they
/// count for nothing.
/// @param model  its bodies, drives and delay; the parameters do not matter
/// @fails  as prepare; data: a joint beyond its limits, with the time; no torque.
[[nodiscard]] Result<PreparedDynamics> prepare_dynamics(const Recording& recording, const Inspection& inspection,
                                                        const robot::DynamicModel& model,
                                                        const DynamicsOptions& options);

}  // namespace mbk::preprocess
