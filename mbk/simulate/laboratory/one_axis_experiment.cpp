#include "mbk/simulate/laboratory/one_axis_experiment.h"

#include <fmt/format.h>

#include <cmath>

#include "mbk/simulate/laboratory/truth_text.h"

namespace mbk::laboratory {

Result<Performance> perform(const OneAxisExperiment& experiment, participant::OneAxisLoad& load) {
  const double rate = experiment.rate.value;
  if (!(rate > 0.0 && std::isfinite(rate))) return bad_usage(fmt::format("sample rate {:g} Hz is not above 0", rate));
  const OneAxisLoop::Servo& servo = experiment.servo;
  if (!(servo.proportional >= 0.0 && servo.derivative >= 0.0 && servo.velocity_cutoff.value > 0.0)) {
    return bad_usage("the servo's gains must not be negative, its velocity cutoff must be above zero");
  }
  const double sample_time = 1.0 / rate;
  auto loop = OneAxisLoop::create(experiment.machine, 0.0, load, sample_time);
  if (!loop) return tl::unexpected(loop.error());
  auto sensors = OneAxisSensors::create(experiment.sensors, sample_time, experiment.seed);
  if (!sensors) return tl::unexpected(sensors.error());
  const auto samples = static_cast<Index>(std::llround(experiment.schedule.duration() * rate));
  if (samples < 1) return bad_usage("the trial has no samples", "give it a duration");

  const bool position = experiment.schedule.quantity() == perturbation::Quantity::position;
  Performance result;
  Recording& recording = result.recording;
  recording.time.resize(samples);
  recording.channels = {{"position", "rad", "joint", Vector(samples)},
                        {"reaction", "N.m", "joint", Vector(samples)},
                        {"reference", position ? "rad" : "N.m", "joint", Vector(samples)},
                        {"acceleration", "rad/s2", "joint", Vector(samples)}};
  const double memory = std::exp(-RadPerSec(servo.velocity_cutoff).value * sample_time);
  double last_position = 0.0, velocity = 0.0;
  for (Index i = 0; i < samples; ++i) {
    const double t = loop->time();
    const double measured = sensors->position(loop->position());
    if (i > 0) velocity = memory * velocity + (1.0 - memory) * (measured - last_position) / sample_time;
    last_position = measured;
    const auto wanted = experiment.schedule.at(t);
    const double motor =
        position ? servo.proportional * (wanted.value[0] - measured) + servo.derivative * (wanted.first[0] - velocity)
                 : wanted.value[0];
    const OneAxisTrueState& state = loop->hold(motor, sample_time);
    if (!(std::isfinite(state.position) && std::isfinite(state.reaction))) {
      return bad_data(fmt::format("the motion is not finite any more at {:.3f} s", t),
                      "lower the gains, or raise robot.steps_per_tick", "simulation");
    }
    const OneAxisSensors::Reading reading = sensors->read(state);
    recording.time[i] = t;
    recording.channels[0].values[i] = measured;
    recording.channels[1].values[i] = reading.reaction;
    recording.channels[2].values[i] = experiment.schedule.reference(t)[0];
    recording.channels[3].values[i] = reading.acceleration;
    result.energy_absorbed = state.absorbed;
    result.energy_exchanged += std::abs(state.reaction * state.velocity) * sample_time;
    loop->advance();
    if (experiment.progress && i % 1000 == 0) {
      experiment.progress(static_cast<double>(i) / static_cast<double>(samples));
    }
  }
  for (const auto& event : experiment.schedule.events())
    recording.events.push_back({event.time, event.name, event.value});
  result.truth = load.impedance(0.0);
  recording.metadata = truth_metadata(result.truth, experiment.rate, result.energy_absorbed);
  return result;
}

}  // namespace mbk::laboratory
