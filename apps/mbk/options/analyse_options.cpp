#include "apps/mbk/options/analyse_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "apps/mbk/options/word_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/model/trial/arm_posture.h"

namespace mbk::app {
namespace {

/// X,Y,UPPER,FORE[,left|right] as the metadata that a recording would hold; nothing where it is none.
std::optional<std::map<std::string, std::string>> arm_metadata(const std::string& given) {
  constexpr std::array kKeys = {"shoulder_x_m", "shoulder_y_m", "upper_arm_m", "forearm_m", "elbow"};
  std::map<std::string, std::string> metadata = {{"elbow", std::string(word_of(ElbowSide::right))}};
  std::size_t begin = 0;
  for (std::size_t k = 0; k < kKeys.size(); ++k) {
    const std::size_t end = std::min(given.find(',', begin), given.size());
    const std::string word = given.substr(begin, end - begin);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool number = error == std::errc() && stop == word.data() + word.size() && std::isfinite(value);
    if (k < 2 ? !number : (k < 4 ? !number || !(value > 0.0) : !value_of<ElbowSide>(word))) return std::nullopt;
    metadata[kKeys[k]] = word;
    if (end == given.size()) return k >= 3 ? std::optional(metadata) : std::nullopt;
    begin = end + 1;
  }
  return std::nullopt;
}

}  // namespace

void add_analyse_options(Command command, AnalyseArguments& arguments) {
  add_choice(
      command, "--domain", arguments.domain,
      "joint: M, B and K at shoulder and elbow too (or at the joints of the robot, where the arm is not known), in "
      "the posture of the recording")
      .group("Model");
  command
      .add_option("--arm", arguments.arm,
                  "the person's arm, where the recording does not hold it: place of the shoulder in the robot's frame, "
                  "lengths of upper arm and forearm (to the grip), in metres; the elbow is to the right unless ',left' "
                  "follows")
      .type_name("X,Y,UPPER,FORE")
      .check([](const std::string& given) {
        return arm_metadata(given) ? "" : fmt::format("{} is not X,Y,UPPER,FORE in metres", quoted(given));
      })
      .group("Model");
}

void add_arm(const AnalyseArguments& arguments, Recording& recording) {
  const auto arm = arm_metadata(arguments.arm);
  for (const auto& [key, value] : arm.value_or(std::map<std::string, std::string>{})) recording.metadata[key] = value;
}

}  // namespace mbk::app
