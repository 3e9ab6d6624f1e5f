#include "mbk/files/recording/joint_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "mbk/base/core/ordinal.h"
#include "mbk/base/core/printable.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kMaxListed = 12;

std::string listed(std::span<const std::string> names) {
  const std::size_t count = std::min(names.size(), kMaxListed);
  return printable(fmt::format("{}{}", fmt::join(names.first(count), ", "),
                               names.size() > count ? fmt::format(" and {} more", names.size() - count) : ""));
}

/// Whether `name` occurs in `text` with no adjacent letter or digit.
bool stands_in(std::string_view name, std::string_view text) {
  const auto is_beside = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  for (auto at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    if ((at == 0 || !is_beside(text[at - 1])) && (end == text.size() || !is_beside(text[end]))) return true;
  }
  return false;
}

/// The only joint that a text names; nullptr where it names none or several. "left_elbow" is not the joint "elbow"
/// where there is a joint of that longer name.
const std::string* named_in(std::string_view text, std::span<const std::string> joints) {
  const std::string* found = nullptr;
  for (const std::string& joint : joints) {
    if (joint.empty() || !stands_in(joint, text)) continue;
    if (found == nullptr || stands_in(*found, joint)) {
      found = &joint;
    } else if (!stands_in(joint, *found)) {
      return nullptr;
    }
  }
  return found;
}

/// The arrays that are the channels of all joints of the file.
std::vector<Array*> named_arrays(Contents& contents, std::string_view prefix) {
  std::vector<Array*> arrays;
  for (Array& array : contents.arrays) {
    if (!array.joint.empty() && array.means.starts_with(prefix)) arrays.push_back(&array);
  }
  return arrays;
}

/// "q1=/joint_states.position.elbow,tau1=/joint_states.effort.elbow,…".
std::string example(Contents& contents) {
  std::string map;
  for (const auto& [prefix, alias] : {std::pair("joint_", "q1"), std::pair("torque_", "tau1")}) {
    const std::vector<Array*> arrays = named_arrays(contents, prefix);
    if (!arrays.empty()) map += fmt::format("{}={},", alias, arrays.front()->name);
  }
  return map + "…";
}

}  // namespace

bool is_of_joint(const ChannelKind& kind) {
  return kind.frame == "joint";
}

std::size_t joint_index(const ChannelKind& kind) {
  return static_cast<std::size_t>(kind.name.back() - '1');
}

Result<std::string> match_joints(Contents& contents, std::span<const std::string> joints, std::string_view clock) {
  if (joints.empty()) return "";
  std::vector<std::pair<Array*, std::string>> matched;
  for (const char* const prefix : {"joint_", "torque_"}) {
    const std::vector<Array*> named = named_arrays(contents, prefix);
    const auto is_meant = [&](const Array& array) {
      return array.clock >= 0 && contents.clocks[static_cast<std::size_t>(array.clock)].name == clock;
    };
    std::vector<std::string> missing;
    for (std::size_t k = 0; !named.empty() && k < joints.size(); ++k) {
      std::vector<Array*> same;
      std::ranges::copy_if(named, std::back_inserter(same), [&](Array* array) { return array->joint == joints[k]; });
      if (std::ranges::count_if(same, [&](Array* array) { return is_meant(*array); }) == 1) {
        std::erase_if(same, [&](Array* array) { return !is_meant(*array); });
      }
      if (same.size() > 1) {
        return bad_data(
            fmt::format("joint '{}' occurs in '{}' and in '{}'", printable(joints[k]), same[0]->name, same[1]->name),
            "select the topic with --clock, or name all channels with --channels");
      }
      if (same.empty()) {
        missing.push_back(joints[k]);
      } else {
        matched.emplace_back(same.front(), fmt::format("{}{}", prefix, k + 1));
      }
    }
    if (missing.empty()) continue;
    std::vector<std::string> there;
    for (const Array* array : named) {
      if (std::ranges::find(there, array->joint) == there.end()) there.push_back(array->joint);
    }
    return bad_data(fmt::format("the recording has no joint {}; its joints are {}, the joints of the robot are {}",
                                listed(missing), listed(there), listed(joints)),
                    fmt::format("correct the names in the robot description, or assign the joints, as in --channels {}",
                                example(contents)));
  }
  for (const char* const prefix : {"joint_", "torque_"}) {
    for (Array* const array : named_arrays(contents, prefix)) array->means = array->name;
  }
  std::vector<std::string> order;
  for (const auto& [array, channel] : matched) {
    array->means = channel;
    if (order.size() < joints.size()) order.push_back(fmt::format("{} {}", order.size() + 1, array->joint));
  }
  if (order.empty()) return "";
  return fmt::format("joints and torques were matched to the robot by name: {}", listed(order));
}

Result<void> check_joint(const ChannelKind& kind, std::span<const std::string> joints, std::string_view named,
                         const std::string& source) {
  const std::size_t k = joint_index(kind);
  if (k >= joints.size()) return {};
  const std::string* const other = named_in(named, joints);
  if (other == nullptr || *other == joints[k]) return {};
  return bad_data(
      fmt::format("{} was read from '{}', which belongs to '{}', the {} joint of the robot; its joints are {}",
                  kind.name, printable(source), printable(*other), ordinal(&*other - joints.data() + 1),
                  listed(joints)),
      fmt::format("assign a column to '{}' with --channels {}=NAME", printable(joints[k]), kind.alias));
}

}  // namespace mbk::recording
