#include "mbk/simulate/participant/cocontraction.h"

#include <algorithm>
#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::participant {

Result<Cocontraction> Cocontraction::create(const Options& options, double sample_time) {
  if (auto ok = above_zero({{"sample time", sample_time, "s"},
                            {"speed scale of co-contraction", options.speed, "m/s"},
                            {"time constant of co-contraction", options.time_constant, "s"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (auto ok = not_negative({{"resting co-contraction", options.rest, ""},
                              {"slope of co-contraction", options.slope, ""},
                              {"stiffness gain of co-contraction", options.stiffness_gain, ""},
                              {"damping gain of co-contraction", options.damping_gain, ""},
                              {"weakening of voluntary control by co-contraction", options.voluntary_damping, ""}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (options.rest > 1.0) return bad_usage(fmt::format("resting co-contraction {:g} is above 1", options.rest));
  if (options.voluntary_damping > 1.0) {
    return bad_usage(
        fmt::format("weakening of voluntary control by co-contraction {:g} is above 1", options.voluntary_damping));
  }
  return Cocontraction(options, std::exp(-sample_time / options.time_constant));
}

void Cocontraction::step(double hand_speed) {
  speed_ = keep_ * speed_ + (1.0 - keep_) * hand_speed;
  const double ratio = speed_ / options_.speed;
  level_ = std::min(1.0, options_.rest + options_.slope * ratio * ratio);
}

}  // namespace mbk::participant
