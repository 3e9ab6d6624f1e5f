#include "mbk/experiment/safety/limits.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "mbk/base/core/units.h"

namespace mbk::safety {
namespace {

constexpr double kMilli = 1e3, kPerDegree = 1.0 / kDegree;  // from SI to the unit of a key

constexpr bool kMayBeOff = true;

constexpr auto kKeys = std::to_array<LimitKey>({
    {"handle_force_N", &Limits::handle_force, 1.0, 500.0, "the motors may push the hand with this force"},
    {"joint_torque_Nm", &Limits::joint_torque, 1.0, 500.0, "the motors may turn the joints with this torque"},
    {"torque_rate_Nm_per_s", &Limits::torque_rate, 1.0, 1e5, "the torque may jump this fast"},
    {"max_saturation_time_ms", &Limits::max_saturation_time, kMilli, 60'000.0, "a controller may run away"},
    {"measured_force_N", &Limits::measured_force, 1.0, 1000.0, "the hand may be held or squeezed with this force"},
    {"force_jump_N", &Limits::force_jump, 1.0, 1000.0, "a knock or a broken wire goes unnoticed"},
    {"speed_mm_per_s", &Limits::speed, kMilli, 10'000.0, "the hand may move this fast"},
    {"acceleration_m_per_s2", &Limits::acceleration, 1.0, 1000.0, "the hand may be jerked"},
    {"joint_margin_deg", &Limits::joint_margin, kPerDegree, 90.0, "a joint may come this close to its stop", kMayBeOff,
     true},
    {"excursion_mm", &Limits::excursion, kMilli, 2000.0, "the hand may be taken this far from home", kMayBeOff},
    {"tracking_deg", &Limits::tracking, kPerDegree, 180.0, "a joint may be this far from its reference"},
    {"encoder_jump_deg", &Limits::encoder_jump, kPerDegree, 90.0, "a wrong angle goes unnoticed"},
    {"frozen_sensor_ms", &Limits::frozen_sensor, kMilli, 10'000.0, "a dead sensor is believed", kMayBeOff},
    {"frozen_sensor_torque_Nm", &Limits::frozen_sensor_torque, 1.0, 50.0, "a dead encoder is believed"},
    {"accelerometer_m_per_s2", &Limits::accelerometer, 1.0, 100.0, "wrong encoders are believed", kMayBeOff},
    {"link_silence_ms", &Limits::link_silence, kMilli, 5000.0, "the robot is driven without feedback"},
    {"lateness_ms", &Limits::lateness, kMilli, 1000.0, "the robot may hold an old command", kMayBeOff},
    {"answer_lag_ms", &Limits::answer_lag, kMilli, 1000.0, "the robot may obey an old command", kMayBeOff},
    {"state_age_ms", &Limits::state_age, kMilli, 1000.0, "the gate may check an old state", kMayBeOff},
    {"motors_reply_ms", &Limits::motors_reply, kMilli, 5000.0, "motors that are off go unnoticed"},
    {"motors_off_ms", &Limits::motors_off, kMilli, 5000.0, "the alarm that the motors are not off is delayed"},
    {"torque_error_Nm", &Limits::torque_error, 1.0, 100.0, "drives that do not obey go unnoticed", kMayBeOff},
    {"off_torque_Nm", &Limits::off_torque, 1.0, 10.0, "motors that still drive count as off"},
});

}  // namespace

double LimitKey::of(const Limits& limits) const {
  if (const auto* one = std::get_if<double Limits::*>(&member)) return scale * (limits.*(*one));
  return scale * (limits.*std::get<Vector2d Limits::*>(member)).maxCoeff();
}

std::span<const LimitKey> limit_keys() {
  return kKeys;
}

std::vector<std::string> weakened(const Limits& limits) {
  std::vector<std::string> remarks;
  for (const LimitKey& one : kKeys) {
    const double value = one.of(limits), usual = one.of(Limits());
    constexpr double kRounding = 1e-9;
    const bool off = one.may_be_off && value == 0.0;
    const bool weaker = one.less_is_weaker ? value < usual * (1.0 - kRounding) : value > usual * (1.0 + kRounding);
    if (!off && !weaker) continue;
    remarks.push_back(fmt::format("{} {} (default {:.4g}): {}", one.key,
                                  off ? "is off" : fmt::format("= {:.6g}", value), usual, one.why));
  }
  const Limits usual;
  if ((limits.workspace_low.array() < usual.workspace_low.array()).any() ||
      (limits.workspace_high.array() > usual.workspace_high.array()).any()) {
    remarks.emplace_back("the workspace is larger than the default of ±1000 mm: the hand may go there");
  }
  return remarks;
}

std::string text_of(const Limits& limits) {
  std::string text;
  for (const LimitKey& one : kKeys) {
    text += fmt::format("{}{}=", text.empty() ? "" : " ", one.key);
    if (const auto* two = std::get_if<Vector2d Limits::*>(&one.member)) {
      const Vector2d& both = limits.*(*two);
      text += fmt::format("{:.6g},{:.6g}", one.scale * both[0], one.scale * both[1]);
    } else {
      text += fmt::format("{:.6g}", one.of(limits));
    }
  }
  return text + fmt::format(" workspace_low_mm={:.6g},{:.6g} workspace_high_mm={:.6g},{:.6g}",
                            kMilli * limits.workspace_low[0], kMilli * limits.workspace_low[1],
                            kMilli * limits.workspace_high[0], kMilli * limits.workspace_high[1]);
}

Result<void> check(const Limits& limits) {
  for (const LimitKey& one : kKeys) {
    const double value = one.of(limits);
    const auto* two = std::get_if<Vector2d Limits::*>(&one.member);
    const double least = two != nullptr ? one.scale * (limits.*(*two)).minCoeff() : value;
    if (!(one.may_be_off ? least >= 0.0 : least > 0.0)) {
      return bad_usage(fmt::format("safety.{} = {:g} is {}", one.key, least,
                                   one.may_be_off ? "below zero or not finite" : "not above zero"));
    }
    if (value <= one.most) continue;
    return bad_usage(fmt::format("safety.{} = {:g} is above {:g}", one.key, value, one.most),
                     fmt::format("lower it: with this limit {}", one.why));
  }
  if (!(limits.workspace_low.cwiseAbs().maxCoeff() <= kLargestWorkspace &&
        limits.workspace_high.cwiseAbs().maxCoeff() <= kLargestWorkspace)) {
    return bad_usage(
        fmt::format("safety: a corner of the workspace is more than {:g} mm from the base", kMilli * kLargestWorkspace),
        "give workspace_low_mm and workspace_high_mm in millimetres");
  }
  if (!(limits.workspace_low.array() < limits.workspace_high.array()).all()) {
    return bad_usage("safety: the workspace's low corner is not below its high corner");
  }
  return {};
}

}  // namespace mbk::safety
