#include "mbk/simulate/participant/reaching.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "mbk/base/core/option_limits.h"

namespace mbk::participant {
namespace {

/// Durations and lengths are limited to it: an extreme draw is not a reach.
constexpr double kMin = 0.7, kMax = 1.3;

Result<void> check(const Reaching::Options& o) {
  if (auto ok = above_zero({{"interval of the reaches", o.interval, "s"},
                            {"duration of a reach", o.duration, "s"},
                            {"duration of the return", o.way_back, "s"},
                            {"length of a reach", o.reach.norm(), "m"}});
      !ok) {
    return ok;
  }
  if (auto ok = not_negative({{"time of the first reach", o.first, "s"},
                              {"latest start of a reach", o.latest, "s"},
                              {"spread of the duration", o.duration_spread, ""},
                              {"spread of the length", o.length_spread, ""},
                              {"bend", o.bend, "m"},
                              {"spread of the end point", o.end_spread, "m"},
                              {"dwell at the target", o.stay, "s"},
                              {"carried mass", o.carried_mass, "kg"}});
      !ok) {
    return ok;
  }
  if (!o.start.allFinite()) return bad_usage("the start of a reach is not finite");
  if (o.reaches < 0) return bad_usage(fmt::format("{} reaches", o.reaches));
  const double longest = o.latest + kMax * o.duration + o.stay + o.way_back;
  if (longest > o.interval) {
    return bad_usage(
        fmt::format("a reach of {:g} s including its return may last {:g} s, longer than the interval of {:g} s",
                    o.duration, longest, o.interval),
        "lengthen the interval, or shorten the dwell and the return");
  }
  return {};
}

}  // namespace

Reaching::Reaching(const Options& options)
    : options_(options), back_({1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, options.way_back) {}

Result<Reaching> Reaching::create(const Options& options, std::uint64_t seed, std::uint32_t stream) {
  MBK_TRY(check(options));
  Reaching made(options);
  numeric::Random random(seed, stream);
  const auto about_one = [&](double spread) { return std::clamp(1.0 + spread * random.normal(), kMin, kMax); };
  const Eigen::Vector2d along = options.reach.normalized(), across(-along.y(), along.x());
  for (int i = 0; i < options.reaches; ++i) {
    const double begin = options.first + i * options.interval + options.latest * random.uniform();
    const double duration = options.duration * about_one(options.duration_spread);
    const double length = about_one(options.length_spread);
    const double bend = options.bend * random.normal(), end = options.end_spread * random.normal();
    made.all_.push_back({begin,
                         {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, duration},
                         length * options.reach + end * across,
                         bend * across,
                         duration});
  }
  return made;
}

perturbation::Jet<Eigen::Vector2d> Reaching::at(double t) const {
  const auto next = std::ranges::upper_bound(all_, t, {}, &One::begin);
  const Eigen::Vector2d zero = Eigen::Vector2d::Zero();
  if (next == all_.begin()) return {options_.start, zero, zero};
  const One& one = *std::prev(next);
  const double since = t - one.begin, turn = one.duration + options_.stay;
  if (since >= turn) {
    const perturbation::Jet<double> s = back_.at(since - turn);
    return {options_.start + s.value * one.way, s.first * one.way, s.second * one.way};
  }
  const perturbation::Jet<double> s = one.out.at(since);
  const Eigen::Vector2d bent = 4.0 * (1.0 - 2.0 * s.value) * one.across, slope = one.way + bent;
  return {options_.start + s.value * one.way + 4.0 * s.value * (1.0 - s.value) * one.across, s.first * slope,
          s.second * slope - 8.0 * s.first * s.first * one.across};
}

}  // namespace mbk::participant
