#include "mbk/simulate/participant/departures.h"

#include <cmath>
#include <numbers>

#include "mbk/base/core/option_limits.h"

namespace mbk::participant {

using Eigen::Vector2d;

Result<Departures> Departures::create(const Options& options, const Vector2d& rest, double sample_time,
                                      std::uint64_t seed, std::uint32_t stream) {
  if (auto ok = above_zero({{"sample time", sample_time, "s"},
                            {"speed of dry friction", options.dry_friction_speed, "m/s"},
                            {"frequency of tremor", options.tremor_frequency.value, "Hz"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (auto ok = not_negative({{"dry friction", options.dry_friction, "N"},
                              {"delay of the reflex", options.reflex_delay, "s"},
                              {"force of tremor", options.tremor_force, "N"},
                              {"width of tremor", options.tremor_width.value, "Hz"},
                              {"share of the stiffness that relaxes", options.relaxing_share, ""},
                              {"stiffness on the softer side", 1.0 - std::abs(options.one_sided_share), ""}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (auto ok = finite({{"cubic stiffness", options.cubic_stiffness, "N/m³"},
                        {"gain of the reflex", options.reflex_gain, "N/m"},
                        {"drift of the equilibrium", options.equilibrium_drift.x(), "m/s"},
                        {"drift of the equilibrium", options.equilibrium_drift.y(), "m/s"},
                        {"equilibrium", rest.x(), "m"},
                        {"equilibrium", rest.y(), "m"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  return Departures(options, rest, sample_time, numeric::Random(seed, stream));
}

Departures::Departures(const Options& options, const Vector2d& rest, double sample_time, numeric::Random random)
    : options_(options),
      rest_(rest),
      sample_time_(sample_time),
      random_(random),
      delayed_(static_cast<std::size_t>(std::llround(options.reflex_delay / sample_time)) + 1, Vector2d(0.0, 0.0)) {
  for (double& phase : phase_) phase = random_.uniform(0.0, 2.0 * std::numbers::pi);
}

void Departures::step(double t, const Vector2d& position, const Eigen::Matrix2d& stiffness) {
  delayed_[next_] = position - rest_;
  next_ = (next_ + 1) % delayed_.size();  // the oldest, d ago
  held_ = options_.reflex_gain * delayed_[next_] - stiffness * options_.equilibrium_drift * t;
  const Vector2d away = position - rest_;
  held_ += options_.one_sided_share * stiffness * away.cwiseAbs();
  constexpr std::array kTimes = {0.1, 0.5, 1.5};
  for (std::size_t k = 0; k < kTimes.size(); ++k) {
    relaxed_[k] += (1.0 - std::exp(-sample_time_ / kTimes[k])) * (away - relaxed_[k]);
    held_ += options_.relaxing_share * stiffness * (away - relaxed_[k]);
  }
  if (options_.tremor_force == 0.0) return;
  const double turn = 2.0 * std::numbers::pi * sample_time_;
  for (int axis = 0; axis < 2; ++axis) {
    double& phase = phase_[static_cast<std::size_t>(axis)];
    phase += turn * options_.tremor_frequency.value + std::sqrt(turn * options_.tremor_width.value) * random_.normal();
    held_[axis] -= options_.tremor_force * std::cos(phase);
  }
}

Vector2d Departures::force(const HandState<2>& hand) const {
  const Vector2d away = hand.position - rest_;
  const double speed = std::hypot(hand.velocity.norm(), options_.dry_friction_speed);
  return options_.dry_friction / speed * hand.velocity + options_.cubic_stiffness * away.squaredNorm() * away + held_;
}

}  // namespace mbk::participant
