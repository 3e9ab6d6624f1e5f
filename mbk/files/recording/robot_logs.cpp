#include "mbk/files/recording/robot_logs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/trimmed.h"

namespace mbk::recording {
namespace {

/// "q[0]" of "state.q[0]" and of " q[0]".
std::string_view bare(std::string_view name) {
  name = trimmed(name);
  if (name.starts_with("state.")) name.remove_prefix(6);
  return name;
}

Array* column_called(Contents& contents, std::string_view name) {
  const auto found = std::ranges::find(contents.arrays, name, [](const Array& array) { return bare(array.name); });
  return found == contents.arrays.end() ? nullptr : &*found;
}

bool has(Contents& contents, std::string_view name) {
  return column_called(contents, name) != nullptr;
}

/// A column in whole milliseconds runs by steps of 1 and more.
bool counts_milliseconds(const Array& time) {
  const auto& values = time.values;
  return values.size() > 1 &&
         values(values.size() - 1, 0) - values(0, 0) >= 0.9 * static_cast<double>(values.size() - 1);
}

/// Whether the time was found to be in ms.
bool name_milliseconds(Contents& contents) {
  bool in_ms = false;
  for (Array& array : contents.arrays) {
    const std::string_view name = bare(array.name);
    if ((name != "time" && name != "duration") || !array.unit.empty() || !counts_milliseconds(array)) continue;
    array.means = "time";
    array.unit = "ms";
    in_ms = true;
  }
  return in_ms;
}

/// NAME[k] of each k as the columns of a matrix; nothing if one is missing or has no numbers.
std::optional<Matrix> log_columns(Contents& contents, std::string_view name, std::initializer_list<int> elements) {
  Matrix values;
  for (const int k : elements) {
    const Array* const array = column_called(contents, fmt::format("{}[{}]", name, k));
    if (array == nullptr || array->values.size() == 0) return std::nullopt;
    if (values.cols() == 0) values.resize(array->values.size(), 0);
    if (array->values.size() != values.rows()) return std::nullopt;
    values.conservativeResize(Eigen::NoChange, values.cols() + 1);
    values.rightCols(1) = array->values.reshaped();
  }
  return values;
}

/// The rotations of a pose, sample by sample: R(i, j) is element 4j + i of a 4×4 matrix in column-major order.
/// Nothing if one is missing or is no rotation.
std::optional<Matrix> recorded_rotations(Contents& contents, std::string_view pose) {
  constexpr double kRounded = 1e-3;
  auto values = log_columns(contents, pose, {0, 1, 2, 4, 5, 6, 8, 9, 10});
  for (Index k = 0; values && k < values->rows(); ++k) {
    const Eigen::Matrix3d R = values->row(k).reshaped(3, 3);
    if (!((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < kRounded)) return std::nullopt;
  }
  return values;
}

/// Adds the force of K_F_ext_hat_K in the base frame, F_O = R_OE R_EK F_K, where no such force was recorded.
void add_force_in_base(Contents& contents) {
  const auto force = log_columns(contents, "K_F_ext_hat_K", {0, 1, 2});
  if (!force) return;
  const auto hand = recorded_rotations(contents, "O_T_EE"), stiffness = recorded_rotations(contents, "EE_T_K");
  if (!hand || hand->rows() != force->rows() || (stiffness && stiffness->rows() != force->rows())) {
    contents.notes.emplace_back(
        "K_F_ext_hat_K was not used: it is in the stiffness frame K, whose orientation is not recorded in O_T_EE[0] to "
        "[10]; record O_F_ext_hat_K or, if K is parallel to the base, name it, as in --channels "
        "Fx=-K_F_ext_hat_K[0],Fy=-K_F_ext_hat_K[1],Fz=-K_F_ext_hat_K[2], with the other channels");
    return;
  }
  Matrix turned(force->rows(), 3);
  for (Index k = 0; k < force->rows(); ++k) {
    Eigen::Vector3d F = force->row(k).transpose();
    if (stiffness) F = Eigen::Matrix3d(stiffness->row(k).reshaped(3, 3)) * F;
    turned.row(k) = (Eigen::Matrix3d(hand->row(k).reshaped(3, 3)) * F).transpose();
  }
  for (Index axis = 0; axis < 3; ++axis) {
    Array array{.name = fmt::format("K_F_ext_hat_K[{}] in the base frame", axis),
                .values = SharedMatrix::of_column(Vector(turned.col(axis)))};
    array.means = fmt::format("-force_{}", "xyz"[axis]);
    contents.arrays.push_back(std::move(array));
  }
  contents.notes.push_back(
      fmt::format("force of the hand is -K_F_ext_hat_K, turned from the stiffness frame K to the base frame by O_T_EE "
                  "{}; libfranka defines it as the force that the robot exerts",
                  stiffness ? "and EE_T_K" : "(K is taken as the frame of the end effector, since EE_T_K is missing)"));
}

/// The hand in space: position and force along x, y and z of the base frame.
void name_libfranka_in_space(Contents& contents) {
  for (int axis = 0; axis < 3; ++axis) {
    if (Array* const hand = column_called(contents, fmt::format("O_T_EE[{}]", 12 + axis))) {
      hand->means = fmt::format("hand_{}", "xyz"[axis]);
    }
    if (Array* const force = column_called(contents, fmt::format("O_F_ext_hat_K[{}]", axis))) {
      force->means = fmt::format("-force_{}", "xyz"[axis]);
    }
  }
  const bool in_ms = name_milliseconds(contents);  // of a log without joints
  const bool force = has(contents, "O_F_ext_hat_K[2]");
  contents.notes.push_back(fmt::format(
      "x, y and z of the hand are O_T_EE[12] to [14] of libfranka, in the base frame{}{}",
      in_ms ? ", time is in ms" : "",
      force ? "; force of the hand is -O_F_ext_hat_K[0] to [2] in the same frame, which libfranka defines as the force "
              "that the robot exerts"
            : ""));
  if (!force) add_force_in_base(contents);
}

/// Columns as Universal Robots' RTDE clients write them.
void name_rtde(Contents& contents) {
  for (int axis = 0; axis < 3; ++axis) {
    column_called(contents, fmt::format("actual_TCP_pose_{}", axis))->means = fmt::format("hand_{}", "xyz"[axis]);
    column_called(contents, fmt::format("actual_TCP_force_{}", axis))->means = fmt::format("force_{}", "xyz"[axis]);
  }
  if (Array* const time = column_called(contents, "timestamp"); time != nullptr && time->unit.empty()) {
    time->means = "time";
    time->unit = "s";
  }
  contents.notes.emplace_back(
      "the columns are those of a Universal Robots log: x, y and z of the hand are actual_TCP_pose_0 to _2, its force "
      "is "
      "actual_TCP_force_0 to _2, both in the base frame, with unchanged sign; mbk needs the force of the hand on the "
      "robot: push the tool along +x, and if the force along x is then negative, reverse it with --channels "
      "Fx=-actual_TCP_force_0 and so on, and name the other channels there too");
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
  const bool in_ms = name_milliseconds(contents);
  bool force = false;
  for (Array& array : contents.arrays) {
    if (const std::string channel = means(bare(array.name)); !channel.empty()) {
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

void name_robot_log(Contents& contents, int axes) {
  if (!contents.table) return;
  const auto has_all = [&](const char* name) {
    return std::ranges::all_of(std::array{0, 1, 2},
                               [&](int axis) { return has(contents, fmt::format("{}_{}", name, axis)); });
  };
  if (axes == 3 && has_all("actual_TCP_pose") && has_all("actual_TCP_force")) return name_rtde(contents);
  const bool rate = has(contents, "success_rate") || has(contents, "success rate") || has(contents, "O_F_ext_hat_K[0]");
  if (rate && has(contents, "q[0]") && has(contents, "q[6]") && has(contents, "tau_J[0]")) name_libfranka(contents);
  const bool force = has(contents, "O_F_ext_hat_K[2]") || has(contents, "K_F_ext_hat_K[2]");
  if (axes == 3 && force && has(contents, "O_T_EE[14]")) name_libfranka_in_space(contents);
}

}  // namespace mbk::recording
