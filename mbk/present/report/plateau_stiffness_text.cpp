#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/model/trial/identification.h"
#include "mbk/present/report/exploration_parts_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace plateau_stiffness {

std::string bracketed(const Interval& interval, int decimals, double scale = 1.0) {
  if (!std::isfinite(interval.first) || !std::isfinite(interval.second)) return "";
  return fmt::format(" [{:.{}f}, {:.{}f}]", scale * interval.first, decimals, scale * interval.second, decimals);
}

}  // namespace plateau_stiffness

std::string stiffness_regression_text(const StiffnessRegression& fit, Motion motion) {
  using namespace plateau_stiffness;
  const Units units = units_of(motion);
  std::vector<std::vector<std::string>> rows;
  std::string entries;
  for (Index r = 0; r < fit.K.rows(); ++r) {
    for (Index k = 0; k < fit.K.cols(); ++k) {
      entries += (entries.empty() ? "" : ", ") + with_interval(fit.K(r, k), fit.half_width95(r, k));
    }
  }
  rows.push_back({"stiffness K", entries + " " + units.stiffness + (fit.K.rows() > 1 ? " (xx, xy, yx, yy)" : "")});
  if (fit.ellipse) {
    const impedance::Ellipse& e = fit.ellipse->ellipse;
    if (e.lambda_min > 0.0) {
      rows.push_back(
          {"ellipse",
           fmt::format("area {:.0f}{}, shape {:.2f}{}, orientation {}", e.area, bracketed(fit.ellipse->area95, 0),
                       e.shape, bracketed(fit.ellipse->shape95, 2),
                       fit.ellipse->round
                           ? "any: may be a circle"
                           : fmt::format("{:.1f}°{}", 180.0 / std::numbers::pi * e.orientation,
                                         bracketed(fit.ellipse->orientation95, 1, 180.0 / std::numbers::pi)))});
    } else {
      rows.push_back({"ellipse", fmt::format("none: eigenvalues {:.3g} and {:.3g}", e.lambda_min, e.lambda_max)});
    }
  }
  if (fit.antisymmetry) {
    rows.push_back({"antisymmetry", fmt::format("{:.2f}{} {}", fit.antisymmetry->value,
                                                bracketed(fit.antisymmetry->value95, 2), units.stiffness)});
  }
  rows.push_back({"residual", [&] {
                    std::string text;
                    for (const double one : fit.residual_rms)
                      text += fmt::format("{}{:.2g}", text.empty() ? "" : ", ", one);
                    return text + " " + units.force + " between displacements";
                  }()});
  if (fit.linear_p) {
    rows.push_back(
        {"linearity", fmt::format("test of one K for all {} directions: p = {:.2g}", fit.directions, *fit.linear_p)});
  }
  return table(rows);
}

std::string plateau_stiffness_text(const PlateauStiffness& found, Motion motion) {
  using namespace plateau_stiffness;
  const StiffnessRegression& fit = found.fit;
  std::string text = "ramps and holds\n";
  const std::string size = motion == Motion::rotation ? fmt::format("{:.3g}°", 180.0 / std::numbers::pi * fit.amplitude)
                                                      : fmt::format("{:.3g} mm", kMillimetres * fit.amplitude);
  text += table(
      {{"plateaus", fmt::format("{} in {} directions, of {}{}", fit.displacements, fit.directions, size,
                                found.left_out > 0 ? fmt::format("; {} omitted: too short", found.left_out) : "")},
       {"window", fmt::format("{:.0f} ms to {:.0f} ms after the onset, {}; minus the mean of the {:.0f} ms before it",
                              kMilliseconds * found.from_s, kMilliseconds * found.to_s, found.window_rule,
                              kMilliseconds * found.baseline_s)},
       {"displacement",
        fmt::format("{:.1f} % of the commanded displacement; motion within the window adds {:.2g} % to K",
                    100.0 * fit.reached, 100.0 * found.motion_share)}});
  if (!found.usable) text += "  not usable: see the warnings\n";
  return text + stiffness_regression_text(fit, motion);
}

}  // namespace mbk::report
