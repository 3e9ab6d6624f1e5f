#include "mbk/files/recording/robot_logs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "mbk/base/core/trimmed.h"

namespace mbk::recording {
namespace {

/// "q[0]" of "state.q[0]" and of " q[0]".
std::string_view bare(std::string_view name) {
  name = trimmed(name);
  if (name.starts_with("state.")) name.remove_prefix(6);
  return name;
}

bool has(const Contents& contents, std::string_view name) {
  return std::ranges::any_of(contents.arrays, [&](const Array& array) { return bare(array.name) == name; });
}

/// A column in whole milliseconds runs by steps of 1 and more.
bool counts_milliseconds(const Array& time) {
  const auto& values = time.values;
  return values.size() > 1 &&
         values(values.size() - 1, 0) - values(0, 0) >= 0.9 * static_cast<double>(values.size() - 1);
}

void name_libfranka(Contents& contents) {
  constexpr int kJoints = 7;
  const auto means = [](std::string_view name) -> std::string {
    for (int joint = 0; joint < kJoints; ++joint) {
      if (name == fmt::format("q[{}]", joint)) return fmt::format("joint_{}", joint + 1);
      if (name == fmt::format("tau_J[{}]", joint)) return fmt::format("torque_{}", joint + 1);
    }
    if (name == "O_T_EE[12]") return "hand_x";
    if (name == "O_T_EE[13]") return "hand_y";
    if (name == "O_F_ext_hat_K[0]") return "-force_x";
    if (name == "O_F_ext_hat_K[1]") return "-force_y";
    return {};
  };
  bool in_ms = false, force = false;
  for (Array& array : contents.arrays) {
    const std::string_view name = bare(array.name);
    if (name == "time" || name == "duration") {
      if (!array.unit.empty() || !counts_milliseconds(array)) continue;
      array.means = "time";
      array.unit = "ms";
      in_ms = true;
    } else if (const std::string channel = means(name); !channel.empty()) {
      array.means = channel;
      force = force || channel.starts_with('-');
    }
  }
  contents.notes.push_back(fmt::format(
      "the columns are those of a libfranka log: q and tau_J were read as joints and torques{}{}",
      in_ms ? ", time is in ms" : "",
      force ? ", force of the hand is -O_F_ext_hat_K, which libfranka defines as the force that the robot exerts"
            : ""));
}

}  // namespace

void name_robot_log(Contents& contents) {
  if (!contents.table) return;
  const bool rate = has(contents, "success_rate") || has(contents, "success rate") || has(contents, "O_F_ext_hat_K[0]");
  if (rate && has(contents, "q[0]") && has(contents, "q[6]") && has(contents, "tau_J[0]")) name_libfranka(contents);
}

}  // namespace mbk::recording
