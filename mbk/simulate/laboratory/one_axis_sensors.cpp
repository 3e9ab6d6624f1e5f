#include "mbk/simulate/laboratory/one_axis_sensors.h"

#include "mbk/base/core/option_limits.h"

namespace mbk::laboratory {

Result<OneAxisSensors> OneAxisSensors::create(const OneAxisSensorOptions& o, double sample_time, std::uint64_t seed) {
  for (const Result<void>& ok : {above_zero({{"sample time", sample_time, "s"},
                                             {"bandwidth of the coloured noise", o.coloured_bandwidth.value, "Hz"}}),
                                 not_negative({{"position resolution", o.position_resolution, "rad or m"},
                                               {"reaction noise", o.reaction_noise, "N·m or N"},
                                               {"coloured noise", o.coloured_noise, "N·m or N"},
                                               {"random walk of the reaction", o.drift_walk, "N·m/√s or N/√s"},
                                               {"acceleration noise", o.acceleration_noise, "rad/s² or m/s²"}}),
                                 finite({{"drift of the reaction", o.drift_rate, "N·m/s or N/s"}})}) {
    if (!ok) return tl::unexpected(ok.error());
  }
  return OneAxisSensors(o, sample_time, seed);
}

OneAxisSensors::OneAxisSensors(const OneAxisSensorOptions& o, double sample_time, std::uint64_t seed)
    : position_resolution_(o.position_resolution),
      white_(o.reaction_noise, noise_stream(seed, NoiseSource::white_force)),
      acceleration_(o.acceleration_noise, noise_stream(seed, NoiseSource::acceleration)),
      coloured_(o.coloured_noise, o.coloured_bandwidth, sample_time, noise_stream(seed, NoiseSource::coloured_force)),
      drift_(o.drift_walk, o.drift_rate, sample_time, noise_stream(seed, NoiseSource::force_drift)) {}

OneAxisSensors::Reading OneAxisSensors::read(const OneAxisTrueState& state) noexcept {
  return {.time = state.time,
          .position = position(state.position),
          .reaction = state.reaction + drift_.next() + white_.next() + coloured_.next(),
          .acceleration = state.acceleration + acceleration_.next()};
}

}  // namespace mbk::laboratory
