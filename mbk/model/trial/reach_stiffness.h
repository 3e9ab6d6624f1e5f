#pragma once

#include <string>

#include "mbk/model/trial/plateau_stiffness.h"

namespace mbk {

/// Prediction of the path of a displaced hand from undisturbed reaches, and its results.
struct ReachPredictor {
  int components = 0;  ///< number of past samples used for the prediction; 0: the mean of the undisturbed reaches
  double prediction_error =
      0;  ///< cross-validated prediction error of undisturbed reaches at the middle of the window, rms [m]
  double motion_share = 0;  ///< as in PlateauStiffness, of the motion relative to the prediction
  StiffnessRegression fit;
};

/// Stiffness of a hand that is displaced while it reaches (Burdet, Osu, Franklin, Yoshioka, Milner & Kawato 2000).
struct ReachStiffness {
  int axes = 2;
  std::string trigger;          ///< event at which a hand is, or would be, displaced
  double from_s = 0, to_s = 0;  ///< the window on the plateau, after the trigger [s]
  int undisturbed = 0;          ///< reaches used for the prediction
  int left_out = 0;             ///< excluded reaches without sufficient data before or after the trigger
  ReachPredictor own_past;      ///< the result
  ReachPredictor mean_reach;    ///< for comparison: the mean of the undisturbed reaches is subtracted
  bool usable = true;           ///< false: the numbers are shown, but do not describe the limb
};

}  // namespace mbk
