#pragma once

#include <string>

#include "mbk/model/trial/plateau_stiffness.h"

namespace mbk {

/// Undisturbed reaches as they predict where a displaced hand would have been, and what follows from it.
struct ReachPredictor {
  int components = 0;           ///< of a reach's own past that predict it; 0: the mean of the undisturbed reaches
  double prediction_error = 0;  ///< of left-out undisturbed reaches in the middle of the window, root mean square [m]
  double motion_share = 0;      ///< as in PlateauStiffness, of the motion relative to the prediction
  StiffnessRegression fit;
};

/// Stiffness of a hand that is displaced while it reaches (Burdet, Osu, Franklin, Yoshioka, Milner & Kawato 2000).
struct ReachStiffness {
  int axes = 2;
  std::string trigger;          ///< event at which a hand is displaced, or would be
  double from_s = 0, to_s = 0;  ///< the window on the plateau, after the trigger [s]
  int undisturbed = 0;          ///< reaches that were predicted from
  int left_out = 0;             ///< reaches that lack the past or the future of their trigger
  ReachPredictor own_past;      ///< what counts
  ReachPredictor mean_reach;    ///< the comparison: the mean of the undisturbed reaches is subtracted
  bool usable = true;           ///< false: the numbers are shown, but are not those of the limb
};

}  // namespace mbk
