#include <fmt/format.h>

#include <string>

#include "mbk/base/core/units.h"
#include "mbk/present/report/exploration_parts_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace reach_stiffness_detail {

std::string predicted_text(const ReachPredictor& by) {
  return fmt::format("cross-validated error {:.2g} mm; motion within the window adds {:.2g} % to K",
                     kMillimetres * by.prediction_error, 100.0 * by.motion_share);
}

}  // namespace reach_stiffness_detail

std::string reach_stiffness_text(const ReachStiffness& found, Motion motion) {
  using namespace reach_stiffness_detail;
  const StiffnessRegression& fit = found.own_past.fit;
  std::string text = "reaches\n";
  text +=
      table({{"reaches", fmt::format("{} undisturbed and {} displaced in {} directions, by {:.3g} mm{}",
                                     found.undisturbed, fit.displacements, fit.directions, kMillimetres * fit.amplitude,
                                     found.left_out > 0 ? fmt::format("; {} omitted: too short", found.left_out) : "")},
             {"window", fmt::format("{:.0f} ms to {:.0f} ms after the event '{}'", kMilliseconds * found.from_s,
                                    kMilliseconds * found.to_s, found.trigger)},
             {"prediction", fmt::format("from each reach's own past, {} components: {}", found.own_past.components,
                                        predicted_text(found.own_past))},
             {"displacement", fmt::format("{:.1f} % of the commanded displacement", 100.0 * fit.reached)}});
  if (!found.usable) text += "  not usable: see the warnings\n";
  text += stiffness_regression_text(fit, motion);
  return text + "\nfor comparison, minus the mean undisturbed reach\n" +
         table({{"prediction", predicted_text(found.mean_reach)}}) +
         stiffness_regression_text(found.mean_reach.fit, motion);
}

}  // namespace mbk::report
