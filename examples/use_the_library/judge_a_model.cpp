// Is a limb model passive, above which frequency, and with what margin?
//   usage: judge_a_model
#include <cstdio>

#include "mbk/base/lti/positive_real.h"
#include "mbk/base/lti/rational_passivity_index.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/passivity_index.h"

namespace {

int report(const mbk::Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  return 1;
}

mbk::Matrix matrix(double xx, double xy, double yx, double yy) {
  mbk::Matrix Z(2, 2);
  Z << xx, xy, yx, yy;
  return Z;
}

}  // namespace

int main() {
  // Participant 1 of Dyck (2013), relaxed: symmetric parts of tables 3.3 and 3.5, and a stiffness with an antisymmetric
  // part.
  mbk::impedance::Model limb;
  limb.M = matrix(1.326, -0.935, -0.935, 1.883);  // [kg]
  limb.B = matrix(5.76, -2.14, -2.14, 10.56);     // [N·s/m]
  limb.K = matrix(42.4, -20.9, -36.3, 125.3);     // [N/m]
  limb.x0 = mbk::Vector::Zero(2);                 // [m]

  const mbk::impedance::Ellipse stiffness = mbk::impedance::ellipse(limb.K);
  std::printf("stiffness from %.1f to %.1f N/m, antisymmetry %.1f %%\n", stiffness.lambda_min, stiffness.lambda_max,
              mbk::impedance::antisymmetry_percent(limb.K));

  // In a band: the smallest damping in any direction and phase, in closed form.
  for (const double hz : {0.1, 0.2, 1.0}) {
    const double omega = mbk::RadPerSec(mbk::Hertz(hz)).value;
    std::printf("passivity index at %.1f Hz  %6.2f N.s/m\n", hz, mbk::impedance::passivity_index(limb, omega).value);
  }
  const auto below = mbk::impedance::nonpassive_below(limb);
  if (below) std::printf("active below %.2f Hz\n", *below);

  // Over all frequencies: decided in exact fractions, without a grid or rounding.
  for (const bool symmetric : {false, true}) {
    const mbk::Matrix K = symmetric ? mbk::impedance::symmetric_part(limb.K) : limb.K;
    const auto Z = mbk::lti::RationalMatrix::impedance(limb.M, limb.B, K);
    if (!Z) return report(Z.error());
    const auto decided = mbk::lti::positive_real(*Z);
    if (!decided) return report(decided.error());
    std::printf("%s: %s\n", symmetric ? "the symmetric part" : "the model",
                decided->holds() ? "passive" : "not passive");
    for (const mbk::lti::ConditionOutcome& condition : decided->conditions) {
      if (!condition.holds()) std::printf("  %s\n", condition.line().c_str());
    }
    if (!decided->holds()) continue;
    const auto excess = mbk::lti::input_passivity_index(*Z);
    if (!excess) return report(excess.error());
    std::printf("  excess of passivity %.3f N.s/m\n", excess->value);
  }
  return 0;
}
