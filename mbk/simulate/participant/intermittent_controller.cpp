#include "mbk/simulate/participant/intermittent_controller.h"

#include <algorithm>
#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::participant {
namespace {

double minimum_jerk(double s) {
  return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
}

int ticks(double duration, double sample_time) {
  return static_cast<int>(std::lround(duration / sample_time));
}

}  // namespace

Result<IntermittentController> IntermittentController::create(const Options& options, double sample_time,
                                                              std::uint64_t seed, std::uint32_t stream) {
  if (auto ok = above_zero({{"sample time", sample_time, "s"},
                            {"interval between decisions", options.interval, "s"},
                            {"duration of a correction", options.ramp, "s"},
                            {"leak time", options.leak, "s"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (auto ok = not_negative({{"delay", options.delay, "s"},
                              {"position gain", options.position_gain, ""},
                              {"position threshold", options.position_threshold, "m"},
                              {"force gain", options.force_gain, "N/N"},
                              {"force threshold", options.force_threshold, "N"},
                              {"random error", options.random_error, ""},
                              {"largest increment", options.largest_increment, "N"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (!options.position.allFinite() || !options.force.allFinite()) {
    return bad_usage("the held position or force of the controller is not finite");
  }
  if (options.ramp > options.interval) {
    return bad_usage(fmt::format("a correction takes {:g} s, longer than the {:g} s between decisions", options.ramp,
                                 options.interval));
  }
  if (ticks(options.ramp, sample_time) < 1) {
    return bad_usage(fmt::format("a correction of {:g} s is shorter than a tick of {:g} s", options.ramp, sample_time));
  }
  if (options.delay > 10.0 || options.interval > 1e5) {
    return bad_usage(
        fmt::format("delay {:g} s or interval {:g} s is beyond 10 s or 1e5 s", options.delay, options.interval));
  }
  return IntermittentController(options, sample_time, numeric::Random(seed, stream));
}

IntermittentController::IntermittentController(const Options& options, double sample_time, numeric::Random random)
    : options_(options),
      random_(random),
      delayed_(static_cast<std::size_t>(ticks(options.delay, sample_time)) + 1),
      interval_ticks_(ticks(options.interval, sample_time)),
      ramp_ticks_(ticks(options.ramp, sample_time)),
      to_decision_(static_cast<int>(random_.below(static_cast<std::uint64_t>(interval_ticks_)))),
      ramp_tick_(ramp_ticks_),
      keep_(std::exp(-sample_time / options.leak)) {}

Eigen::Vector2d IntermittentController::increment(const Errors& felt, const Eigen::Matrix2d& stiffness, double weight) {
  Eigen::Vector2d sum = {0.0, 0.0};
  if (felt.position.norm() > options_.position_threshold) sum += options_.position_gain * stiffness * felt.position;
  if (felt.force.norm() > options_.force_threshold) sum += options_.force_gain * felt.force;
  sum *= -weight;
  if (const double size = sum.norm(); size > options_.largest_increment) sum *= options_.largest_increment / size;
  const Eigen::Vector2d noise(random_.normal(), random_.normal());
  return sum + options_.random_error * sum.norm() * noise;
}

const Eigen::Vector2d& IntermittentController::step(const Eigen::Vector2d& hand,
                                                    const Eigen::Vector2d& force_hand_on_robot,
                                                    const Eigen::Matrix2d& stiffness, double weight) {
  delayed_[next_] = {hand - options_.position, force_hand_on_robot - options_.force};
  next_ = (next_ + 1) % delayed_.size();  // now the oldest: the delay ago
  if (is_to_decide()) {
    increment_ = increment(delayed_[next_], stiffness, weight);
    ramp_tick_ = 0;
    to_decision_ = interval_ticks_;
  }
  --to_decision_;
  force_ *= keep_;
  if (ramp_tick_ < ramp_ticks_) {
    const double before = minimum_jerk(static_cast<double>(ramp_tick_) / ramp_ticks_);
    ++ramp_tick_;
    force_ += (minimum_jerk(static_cast<double>(ramp_tick_) / ramp_ticks_) - before) * increment_;
  }
  return force_;
}

}  // namespace mbk::participant
