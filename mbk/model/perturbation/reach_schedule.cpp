#include "mbk/model/perturbation/reach_schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mbk/base/core/option_limits.h"
#include "mbk/base/numeric/random.h"
#include "mbk/model/perturbation/directions.h"

namespace mbk::perturbation {
namespace {

Result<void> check_counts(const ReachSchedule::Options& o) {
  if (o.directions < 1) return bad_usage(fmt::format("{} directions are too few: at least 1 is needed", o.directions));
  if (o.repetitions < 1)
    return bad_usage(fmt::format("{} repetitions are too few: at least 1 is needed", o.repetitions));
  if (o.undisturbed_first < ReachSchedule::kMinUndisturbedFirst) {
    return bad_usage(fmt::format("{} undisturbed reaches at the beginning are fewer than {}", o.undisturbed_first,
                                 ReachSchedule::kMinUndisturbedFirst),
                     "add more: they are used to predict the perturbed reaches");
  }
  if (o.undisturbed_between < 0) return bad_usage(fmt::format("{} undisturbed reaches", o.undisturbed_between));
  const int most = ReachSchedule::kMaxReaches;
  if (o.undisturbed_first > most || o.undisturbed_between > most || o.repetitions > most / o.directions ||
      o.directions * o.repetitions + o.undisturbed_first + o.undisturbed_between > most) {
    return bad_usage(fmt::format("there are more than {} reaches", most), "split them into several trials");
  }
  return {};
}

Result<void> check(const ReachSchedule::Options& o) {
  if (auto ok = above_zero({{"amplitude of the displacement", o.amplitude, "m"},
                            {"duration of the outward ramp", o.out, "s"},
                            {"duration of the hold", o.hold, "s"},
                            {"duration of the return", o.back, "s"},
                            {"distance to the trigger", o.trigger, "m"},
                            {"duration of a reach", o.reach_time, "s"}});
      !ok) {
    return ok;
  }
  MBK_TRY(not_negative({{"quiet time", o.quiet, "s"}}));
  MBK_TRY(check_counts(o));
  if (!o.reach.allFinite() || !(o.trigger < o.reach.norm())) {
    return bad_usage(
        fmt::format("the trigger at {:g} m is not before the target at {:g} m", o.trigger, o.reach.norm()));
  }
  if (!(o.interval >= 2.0 * o.reach_time && std::isfinite(o.interval))) {
    return bad_usage(
        fmt::format("an interval of {:g} s is shorter than two reaches of {:g} s", o.interval, o.reach_time),
        "choose a longer interval: the hand must also return");
  }
  return {};
}

/// The displaced ones among the undisturbed, all directions alike.
std::vector<ReachSchedule::Reach> ordered(const ReachSchedule::Options& o) {
  numeric::Random random(o.seed);
  const std::vector<int> directions = shuffled_directions(o.directions, o.repetitions, random);
  std::vector<ReachSchedule::Reach> reaches(static_cast<std::size_t>(o.undisturbed_first));
  std::size_t next = 0;
  for (int undisturbed = o.undisturbed_between; undisturbed > 0 || next < directions.size();) {
    const std::size_t left = directions.size() - next + static_cast<std::size_t>(undisturbed);
    ReachSchedule::Reach reach;
    if (random.below(left) < static_cast<std::uint64_t>(undisturbed)) {
      --undisturbed;
    } else {
      const int direction = directions[next++];
      reach = {true, 2.0 * std::numbers::pi * direction / o.directions, direction_on_circle(direction, o.directions)};
    }
    reaches.push_back(reach);
  }
  return reaches;
}

}  // namespace

ReachSchedule::ReachSchedule(const Options& options, std::vector<Reach> reaches)
    : options_(options),
      reaches_(std::move(reaches)),
      out_({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, options.out),
      back_({1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, options.back),
      there_({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, options.reach_time) {
  double low = 0.0, high = options.reach_time;  // the share of the way rises with time
  constexpr int kHalvings = 50;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (there_.at(middle).value * options.reach.norm() < options.trigger ? low : high) = middle;
  }
  to_trigger_ = high;
}

Result<ReachSchedule> ReachSchedule::create(const Options& options) {
  MBK_TRY(check(options));
  ReachSchedule schedule(options, ordered(options));
  if (schedule.to_trigger_ + schedule.displaced_for() > options.interval) {
    return bad_usage(fmt::format("a displacement of {:g} s is longer than the interval of {:g} s",
                                 schedule.displaced_for(), options.interval));
  }
  return schedule;
}

double ReachSchedule::begin(std::size_t k) const {
  return options_.quiet + static_cast<double>(k) * options_.interval;
}

std::size_t ReachSchedule::number_at(double t) const {
  if (!(t >= options_.quiet)) return reaches_.size();
  const double number = std::floor((t - options_.quiet) / options_.interval);
  return number < static_cast<double>(reaches_.size()) ? static_cast<std::size_t>(number) : reaches_.size();
}

Jet<double> ReachSchedule::shape(double t) const {
  return t < options_.out + options_.hold ? out_.at(t) : back_.at(t - options_.out - options_.hold);
}

Jet<Eigen::Vector2d> ReachSchedule::at(double t) const {
  const std::size_t number = number_at(t);
  const Eigen::Vector2d zero = Eigen::Vector2d::Zero();
  if (number == reaches_.size() || !reaches_[number].displaced) return {zero, zero, zero};
  const Jet<double> share = shape(t - trigger_time(number));
  const Eigen::Vector2d size = options_.amplitude * reaches_[number].direction_B;
  return {share.value * size, share.first * size, share.second * size};
}

Eigen::Vector2d ReachSchedule::way(double t) const {
  const std::size_t number = number_at(t);
  if (number == reaches_.size()) return Eigen::Vector2d::Zero();
  const double since = t - begin(number), half = 0.5 * options_.interval;
  const double share = since < half ? there_.at(since).value : 1.0 - there_.at(since - half).value;
  return share * options_.reach;
}

Hertz ReachSchedule::bandwidth() const {
  constexpr double kHalfPower = 0.6874;  // times 1/D, RampAndHold::bandwidth
  return Hertz(kHalfPower / std::min(options_.out, options_.back));
}

}  // namespace mbk::perturbation
