#pragma once

#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/recording.h"

namespace mbk::laboratory {

/// Result of a simulated trial.
struct Performance {
  Recording recording;
  impedance::Model truth;         ///< intrinsic impedance of the load about home, mean over the trial
  double energy_absorbed = 0.0;   ///< E = −∫ F_h·v dt by the limb, without the handle [J]
  double energy_exchanged = 0.0;  ///< ∫ |F_h·v| dt at the sensor [J], a scale for errors of E
};

}  // namespace mbk::laboratory
