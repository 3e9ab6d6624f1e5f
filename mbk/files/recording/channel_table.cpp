#include "mbk/files/recording/channel_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <string>

#include "mbk/base/core/edit_distance.h"
#include "mbk/base/core/trimmed.h"

namespace mbk::recording {
namespace {

using enum Dimension;
constexpr std::array kTime{time};
constexpr std::array kLength{length};
constexpr std::array kForce{force};
constexpr std::array kAcceleration{acceleration};
constexpr std::array kVoltage{voltage};
constexpr std::array kAngleOrLength{angle, length};
constexpr std::array kTorqueOrForce{torque, force};
constexpr std::array kLengthOrForce{length, force};
constexpr std::array kAnyPosition{length, angle};
constexpr std::array kAnyForce{force, torque};
constexpr std::array kAnyReference{length, angle, force, torque};
constexpr std::array kAnyAcceleration{acceleration, angular_acceleration};
constexpr std::span<const Dimension> kAnything;

constexpr std::string_view kEmg = "emg";  ///< and any muscle or number: emg_biceps

constexpr auto kKinds = std::to_array<ChannelKind>({
    {"time", "t", kTime, "", 0, 1},
    {"hand_x", "x", kLength, "base", 2, 2},
    {"hand_y", "y", kLength, "base", 2, 3},
    {"hand_z", "z", kLength, "base", 3, 0},
    {"joint_1", "q1", kAngleOrLength, "joint", 2, 6, true},
    {"joint_2", "q2", kAngleOrLength, "joint", 2, 7, true},
    {"joint_3", "q3", kAngleOrLength, "joint", 2, 0, true},
    {"joint_4", "q4", kAngleOrLength, "joint", 2, 0, true},
    {"joint_5", "q5", kAngleOrLength, "joint", 2, 0, true},
    {"joint_6", "q6", kAngleOrLength, "joint", 2, 0, true},
    {"joint_7", "q7", kAngleOrLength, "joint", 2, 0, true},
    {"joint_8", "q8", kAngleOrLength, "joint", 2, 0, true},
    {"force_x", "Fx", kForce, "base", 2, 10},
    {"force_y", "Fy", kForce, "base", 2, 11},
    {"force_z", "Fz", kForce, "base", 3, 0},
    {"reference_x", "xr", kLengthOrForce, "base", 2, 12},
    {"reference_y", "yr", kLengthOrForce, "base", 2, 13},
    {"reference_z", "zr", kLengthOrForce, "base", 3, 0},
    {"reference_joint_1", "qr1", kAngleOrLength, "joint", 2, 0, true},
    {"reference_joint_2", "qr2", kAngleOrLength, "joint", 2, 0, true},
    {"reference_joint_3", "qr3", kAngleOrLength, "joint", 2, 0, true},
    {"reference_joint_4", "qr4", kAngleOrLength, "joint", 2, 0, true},
    {"reference_joint_5", "qr5", kAngleOrLength, "joint", 2, 0, true},
    {"reference_joint_6", "qr6", kAngleOrLength, "joint", 2, 0, true},
    {"reference_joint_7", "qr7", kAngleOrLength, "joint", 2, 0, true},
    {"reference_joint_8", "qr8", kAngleOrLength, "joint", 2, 0, true},
    {"torque_1", "tau1", kTorqueOrForce, "joint", 2, 14, true},
    {"torque_2", "tau2", kTorqueOrForce, "joint", 2, 15, true},
    {"torque_3", "tau3", kTorqueOrForce, "joint", 2, 0, true},
    {"torque_4", "tau4", kTorqueOrForce, "joint", 2, 0, true},
    {"torque_5", "tau5", kTorqueOrForce, "joint", 2, 0, true},
    {"torque_6", "tau6", kTorqueOrForce, "joint", 2, 0, true},
    {"torque_7", "tau7", kTorqueOrForce, "joint", 2, 0, true},
    {"torque_8", "tau8", kTorqueOrForce, "joint", 2, 0, true},
    {"acceleration_x", "ax", kAcceleration, "base", 2, 18},
    {"acceleration_y", "ay", kAcceleration, "base", 2, 19},
    {"acceleration_z", "az", kAcceleration, "base", 3, 0},
    {"sensor_qx", "sensor_qx", kAnything, "", 0, 0},
    {"sensor_qy", "sensor_qy", kAnything, "", 0, 0},
    {"sensor_qz", "sensor_qz", kAnything, "", 0, 0},
    {"sensor_qw", "sensor_qw", kAnything, "", 0, 0},
    {"voltage_x", "Vx", kVoltage, "", 2, 0},
    {"voltage_y", "Vy", kVoltage, "", 2, 0},
    {kEmg, kEmg, kVoltage, "", 0, 0, false, true},
    {"position", "x", kAnyPosition, "", 1, 0},
    {"reaction", "F", kAnyForce, "", 1, 0},
    {"reference", "xr", kAnyReference, "", 1, 0},
    {"acceleration", "a", kAnyAcceleration, "", 1, 0},
    {"input", "input", kAnything, "", 0, 0, false, true},
    {"output", "output", kAnything, "", 0, 0, false, true},
    {"drive", "drive", kAnything, "", 0, 0, false, true},
    {"schedule", "schedule", kAnything, "", 0, 0, false, true},
});
static_assert(std::ranges::count(kKinds, std::string_view("joint"), &ChannelKind::frame) == 3 * kMaxJoints);

char lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

bool same_name(std::string_view name, std::string_view known) {
  if (known.size() == 1 || known.starts_with('V')) return name == known;
  return std::ranges::equal(name, known, {}, lower, lower);
}

std::string in_lower_case(std::string_view name) {
  std::string text(name);
  std::ranges::transform(text, text.begin(), lower);
  return text;
}

}  // namespace

bool ChannelKind::accepts(const Unit& unit) const {
  return measures.empty() || std::ranges::find(measures, unit.dimension) != measures.end();
}

std::span<const ChannelKind> channel_kinds() {
  return kKinds;
}

std::vector<const Channel*> in_order(const std::vector<Channel>& channels) {
  const auto place = [](const Channel* channel) {
    const auto kind = std::ranges::find(kKinds, channel->name, &ChannelKind::name);
    return std::pair(kind - kKinds.begin(), std::string_view(channel->name));
  };
  std::vector<const Channel*> ordered;
  for (const Channel& channel : channels) ordered.push_back(&channel);
  std::ranges::stable_sort(ordered, {}, place);
  return ordered;
}

std::vector<const ChannelKind*> kinds_called(std::string_view name) {
  std::vector<const ChannelKind*> kinds;
  for (const ChannelKind& kind : kKinds) {
    if (same_name(name, kind.name) || same_name(name, kind.alias)) kinds.push_back(&kind);
  }
  if (kinds.empty() && in_lower_case(name.substr(0, kEmg.size())) == kEmg && !emg_channel(name).empty()) {
    kinds.push_back(&*std::ranges::find(kKinds, kEmg, &ChannelKind::name));
  }
  return kinds;
}

std::string emg_channel(std::string_view name) {
  std::vector<std::string> words;  // of letters or of digits
  const auto kind_of = [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0   ? 1
           : std::isalpha(static_cast<unsigned char>(c)) != 0 ? 2
                                                              : 0;
  };
  int last = 0;
  for (const char c : name) {
    const int kind = kind_of(c);
    if (kind != 0 && kind != last) words.emplace_back();
    if (kind != 0) words.back() += c;
    last = kind;
  }
  const Unit* const unit = words.size() > 1 ? find_unit(words.back()) : nullptr;
  if (unit != nullptr && unit->dimension == voltage) words.pop_back();
  for (std::string& word : words) word = in_lower_case(word);
  if (std::erase_if(words, [](const std::string& word) { return word == kEmg || word == "semg"; }) == 0) return {};
  std::string channel(kEmg);
  for (const std::string& word : words) channel += "_" + word;
  return channel;
}

std::string_view nearest_channel_name(std::string_view name) {
  std::string_view nearest;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  const std::string given = in_lower_case(name);
  for (const ChannelKind& kind : kKinds) {
    for (const std::string_view known : {kind.name, kind.alias}) {
      if (known == "t") continue;  // the help lists only "time"
      const std::size_t d = edit_distance(given, in_lower_case(known));
      if (d < least) {
        least = d;
        nearest = known;
      }
    }
  }
  return nearest;
}

int axes_of(std::span<const std::vector<const ChannelKind*>> meanings) {
  bool one = false;
  for (const auto& kinds : meanings) {
    if (kinds.size() != 1) continue;
    if (kinds.front()->axes == 2) return 2;
    one = one || kinds.front()->axes == 1;
  }
  return one ? 1 : 2;
}

const ChannelKind* kind_for_axes(std::span<const ChannelKind* const> kinds, int axes) {
  for (const ChannelKind* kind : kinds) {
    if (kind->axes == 0 || std::min(kind->axes, 2) == std::min(axes, 2)) return kind;
  }
  return nullptr;
}

bool names_a_current(std::string_view name) {
  const std::string small = in_lower_case(name);
  const auto has = [&small](std::string_view word) { return small.find(word) != small.npos; };
  std::vector<std::string_view> words;  // of the name as it is spelled
  for (std::size_t begin = 0; begin < name.size();) {
    const std::size_t end = std::min(name.find_first_of(" _-./,:[](){}", begin), name.size());
    if (end > begin) words.push_back(name.substr(begin, end - begin));
    begin = end + 1;
  }
  if (words.empty()) return false;
  const std::string_view last = words.back();
  const bool brackets = name.ends_with(']') || name.ends_with(')');
  if (last == "mA" || last == "uA" || last == "µA" || last == "Arms" || (last == "A" && brackets)) return true;
  if (has("torque") || has("force") || has("tau") || has("moment")) return false;  // "current_torque" is that of now
  return has("current") || std::ranges::any_of(words, [](std::string_view word) {
           constexpr std::array kWords = {"curr", "amp", "amps", "ampere", "amperes", "i", "iq", "im", "imot"};
           while (!word.empty() && word.back() >= '0' && word.back() <= '9') word.remove_suffix(1);
           return std::ranges::find(kWords, in_lower_case(word)) != kWords.end();
         });
}

ColumnName parse_column_name(std::string_view name) {
  name = trimmed(name);
  ColumnName column{kinds_called(name), nullptr};
  const bool emg = !column.kinds.empty() && column.kinds.front()->name == kEmg;  // and its unit: emg_biceps_mV
  if ((!column.kinds.empty() && !emg) || name.empty()) return column;

  std::string_view base;
  const char last = name.back();
  if (const auto open = name.rfind(last == ']' ? '[' : '('); (last == ']' || last == ')') && open != name.npos) {
    column.unit = find_unit(trimmed(name.substr(open + 1, name.size() - open - 2)));
    base = trimmed(name.substr(0, open));
  } else if (const auto underscore = name.rfind('_'); underscore != name.npos) {
    const std::string_view suffix = name.substr(underscore + 1);
    if (suffix != "in") column.unit = find_unit(suffix);  // "signal_in" is an input, not inches
    base = name.substr(0, underscore);
  }
  for (auto at = name.find_first_of(" ,/"); column.unit == nullptr && at != name.npos;
       at = name.find_first_of(" ,/", at + 1)) {
    const std::string_view unit = trimmed(name.substr(at + 1));
    base = trimmed(name.substr(0, at));
    const bool said = name[at] != ' ' || base.ends_with(" in") || unit.size() > 1;  // "plate N" may be one of many
    if (base.empty() || !said || unit == "in") continue;
    column.unit = find_unit(unit);
    if (base.ends_with(" in")) base = trimmed(base.substr(0, base.size() - 3));
  }
  if (column.unit == nullptr || emg) return column;
  column.kinds = kinds_called(base);
  std::erase_if(column.kinds, [&](const ChannelKind* kind) { return !kind->accepts(*column.unit); });
  return column;
}

}  // namespace mbk::recording
