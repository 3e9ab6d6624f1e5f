#include "mbk/measure/explore/judge_stiffness.h"

#include <fmt/format.h>

namespace mbk::explore {
namespace {

constexpr double kWarnOfMotion = 0.02, kTooMuchMotion = 0.1;
constexpr double kWarnOfReach = 0.9, kTooLittleReach = 0.5, kTooFar = 1.1;
constexpr double kWarnOfError = 0.2, kTooMuchError = 0.5;
constexpr double kNotLinear = 0.01;

}  // namespace

StiffnessVerdict judge_stiffness(const StiffnessRegression& fit, double motion_share) {
  StiffnessVerdict verdict;
  if (motion_share > kWarnOfMotion) {
    verdict.warnings.push_back({WarningCode::missing_dynamics,
                                fmt::format("the hand still moves within the window: inertia and damping of a limb "
                                            "with M/K = {:g} s² and B/K = {:g} s would add {:.2g} % to the stiffness",
                                            PlateauStiffness::kInertiaOverStiffness,
                                            PlateauStiffness::kDampingOverStiffness, 100.0 * motion_share),
                                "choose a later window, a stiffer position control or smoother displacements"});
    if (motion_share > kTooMuchMotion) verdict.usable = false;
  }
  if (fit.reached < kWarnOfReach || fit.reached > kTooFar) {
    verdict.warnings.push_back(
        {WarningCode::closed_loop_bias,
         fmt::format("in the worst direction the hand reached only {:.0f} % of the commanded displacement",
                     100.0 * fit.reached),
         "use a stiffer position control, and check the units of position and reference"});
    if (fit.reached < kTooLittleReach || fit.reached > 1.0 / kTooLittleReach) verdict.usable = false;
  }
  if (!(fit.relative_error <= kWarnOfError)) {
    verdict.warnings.push_back(
        {WarningCode::motion_too_small,
         fmt::format("the standard error is {:.0f} % of the stiffness", 100.0 * fit.relative_error),
         "record more repetitions, larger displacements or a calmer limb"});
    if (!(fit.relative_error <= kTooMuchError)) verdict.usable = false;
  }
  if (fit.linear_p && *fit.linear_p < kNotLinear) {
    verdict.warnings.push_back(
        {WarningCode::nonlinear_stiffness,
         fmt::format("the restoring forces of the {} directions do not follow one stiffness (p = {:.1g})",
                     fit.directions, *fit.linear_p),
         "use smaller displacements; the stiffness shown is the best linear fit to all directions"});
  }
  return verdict;
}

}  // namespace mbk::explore
