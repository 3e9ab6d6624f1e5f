#include "mbk/present/report/schedule_text.h"

#include <fmt/format.h>

#include <numbers>

namespace mbk::report {
namespace {

/// The unit in which people think of a value, and how many of it one SI unit is.
struct Shown {
  const char* unit;
  double factor;
};

Shown shown(const perturbation::Schedule& schedule) {
  const bool joint = schedule.space() == perturbation::Space::joint;
  if (schedule.quantity() == perturbation::Quantity::force) return {joint ? "N·m" : "N", 1.0};
  return joint ? Shown{"°", 180.0 / std::numbers::pi} : Shown{"mm", 1000.0};
}

/// "first axis 2, second 3" and so on, with so many digits.
std::string by_axis(const perturbation::AxesVector& values, int digits) {
  constexpr const char* kAxes[] = {"first axis", ", second", ", third"};
  std::string text;
  for (Eigen::Index i = 0; i < values.size(); ++i) text += fmt::format("{} {:.{}g}", kAxes[i], values[i], digits);
  return text;
}

}  // namespace

std::string schedule_text(const perturbation::Schedule& schedule) {
  const perturbation::Facts facts = schedule.facts();
  const auto [unit, factor] = shown(schedule);
  std::string text = fmt::format("  duration      {:.1f} s\n", schedule.duration());
  text += fmt::format("  peak          {:.4g} {} at {:.2f} s; {}\n", factor * facts.peak, unit, facts.peak_time,
                      by_axis(factor * facts.axis_peak, 4));
  text += fmt::format("  rms           {:.4g} {}; {}\n", factor * facts.rms, unit, by_axis(factor * facts.axis_rms, 4));
  const bool force = schedule.quantity() == perturbation::Quantity::force;
  text += fmt::format("  {:<12}  peak {:.4g} {}/s at {:.2f} s\n",
                      !force                                           ? "speed"
                      : schedule.space() == perturbation::Space::joint ? "torque rate"
                                                                       : "force rate",
                      factor * facts.peak_speed, unit, facts.peak_speed_time);
  if (!force) {
    text += fmt::format("  acceleration  peak {:.4g} {}/s² at {:.2f} s\n", factor * facts.peak_acceleration, unit,
                        facts.peak_acceleration_time);
  }
  text += fmt::format("  crest factor  {}, with pauses and fade-in\n", by_axis(facts.crest_factor, 3));
  text +=
      fmt::format("  band          {:.3g} to {:.3g} Hz\n", facts.lowest_frequency.value, facts.highest_frequency.value);
  return text;
}

}  // namespace mbk::report
