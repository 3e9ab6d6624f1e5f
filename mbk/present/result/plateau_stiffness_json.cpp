#include "mbk/present/result/exploration_parts_json.h"

namespace mbk {

using document::Fields;
using document::kDigits;
using document::kTimeDigits;

void describe(Fields<StiffnessRegression>& fields) {
  using Regression = StiffnessRegression;
  fields.type("StiffnessRegression",
              "Stiffness K by regression of restoring forces on displacements, f = K d, with the commanded "
              "displacements as instruments. Not symmetrised.");
  fields.add("K", &Regression::K, "[N/m or N·m/rad]");
  fields.add("standard_error", &Regression::standard_error);
  fields.add(
      "interval95",
      [](const Regression& fit) {
        std::vector<std::vector<Interval>> rows;
        for (Index r = 0; r < fit.K.rows(); ++r) {
          auto& row = rows.emplace_back();
          for (Index k = 0; k < fit.K.cols(); ++k) {
            row.emplace_back(fit.K(r, k) - fit.half_width95(r, k), fit.K(r, k) + fit.half_width95(r, k));
          }
        }
        return rows;
      },
      "of each entry of K, by Student's t");
  fields.add("degrees_of_freedom", &Regression::degrees_of_freedom, "minimum over the entries");
  fields.add("relative_error", &Regression::relative_error,
             "root of the sum of squared standard errors over that of squared entries");
  fields.add("residual_rms", &Regression::residual_rms, "[N or N·m]");
  fields.add("displacements", &Regression::displacements, "number used");
  fields.add("directions", &Regression::directions, "number of different directions");
  fields.add("amplitude", &Regression::amplitude, "mean commanded displacement [m or rad]");
  fields.add("reached", &Regression::reached,
             "displacement relative to the commanded one, minimum over the directions");
  fields.add("linear_p", &Regression::linear_p, "p-value of the misfit over the directions if one K holds for all");
  fields.add("ellipse", &Regression::ellipse);
  fields.add("antisymmetry", &Regression::antisymmetry);
}

void describe(Fields<DisplacedHand>& fields) {
  fields.type("DisplacedHand",
              "A displacement of the hand and the force in response, both minus their means before the onset.");
  fields.add("input", &DisplacedHand::recording, "0 for the first of `inputs`");
  fields.add_rounded("onset_s", &DisplacedHand::onset_s, kTimeDigits, "[s] from the recording's first sample");
  fields.add_rounded("commanded", &DisplacedHand::commanded, kDigits, "[m or rad]");
  fields.add_rounded("displacement", &DisplacedHand::displacement, kDigits, "[m or rad]");
  fields.add_rounded("force", &DisplacedHand::force, kDigits, "of the robot on the hand [N or N·m]");
}

void describe(Fields<PlateauStiffness>& fields) {
  fields.type("PlateauStiffnessEstimate",
              "Stiffness from the mean restoring force while the hand is held at the end of a ramp.");
  fields.add("stiffness", &PlateauStiffness::fit);
  fields.add(
      "plateau_s", [](const PlateauStiffness& found) { return Interval(found.from_s, found.to_s); },
      "the window, after the onset of the ramp [s]");
  fields.add("window_rule", &PlateauStiffness::window_rule, "how the window was chosen");
  fields.add("baseline_s", &PlateauStiffness::baseline_s, "before the onset, subtracted [s]");
  fields.add("motion_share", &PlateauStiffness::motion_share,
             "contribution of inertia and damping to K because the hand still moves, as a share of K");
  fields.add("left_out", &PlateauStiffness::left_out,
             "ramps omitted because their hold or the rest before them is too short");
  fields.add("plateaus", &PlateauStiffness::plateaus);
  fields.add("usable", &PlateauStiffness::usable);
}

void describe(Fields<ReachPredictor>& fields) {
  fields.type("ReachPredictor",
              "Prediction of the undisturbed hand position from undisturbed reaches, and the stiffness relative "
              "to that.");
  fields.add("components", &ReachPredictor::components,
             "number of components of a reach's own past used for prediction; 0: the mean of the undisturbed reaches");
  fields.add("prediction_error", &ReachPredictor::prediction_error,
             "cross-validated error of undisturbed reaches in the middle of the window, root mean square [m]");
  fields.add(
      "motion_share", &ReachPredictor::motion_share,
      "contribution of inertia and damping to K because the hand moves relative to the prediction, as a share of K");
  fields.add("stiffness", &ReachPredictor::fit);
}

void describe(Fields<ReachStiffness>& fields) {
  fields.type("ReachStiffnessEstimate",
              "Stiffness of a hand displaced during a reach, relative to the predicted path.");
  fields.add("trigger", &ReachStiffness::trigger, "event at which the hand is displaced, or would be");
  fields.add(
      "window_s", [](const ReachStiffness& found) { return Interval(found.from_s, found.to_s); },
      "on the plateau, after the trigger [s]");
  fields.add("undisturbed", &ReachStiffness::undisturbed, "undisturbed reaches used for the prediction");
  fields.add("left_out", &ReachStiffness::left_out,
             "reaches omitted because too little was recorded before or after their trigger");
  fields.add("own_past", &ReachStiffness::own_past, "the result");
  fields.add("mean_reach", &ReachStiffness::mean_reach,
             "for comparison: the mean of the undisturbed reaches is subtracted");
  fields.add("usable", &ReachStiffness::usable);
}

}  // namespace mbk
