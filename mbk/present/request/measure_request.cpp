#include "mbk/present/request/measure_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>

#include "mbk/base/core/units.h"
#include "mbk/model/trial/arm_posture.h"
#include "mbk/present/request/named_robot.h"
#include "mbk/present/request/stage_tables.h"

namespace mbk::request {
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

/// --mode, --procedure and --protocol.
OptionTable<preprocess::Options> protocol_table() {
  using preprocess::Options;
  OptionTable<Options> table;
  table.group(kWindowGroup)
      .add({"--mode", "", "reference: the published procedure, sample for sample"}, &Options::mode)
      .add({"--procedure", "",
            "in reference mode: W 101, 5 Hz, ẍ from the position (this one unless said) | W 151, 4.5 Hz, ẍ from "
            "the accelerometer"},
           &Options::procedure)
      .is_default_where([](const Options& options) { return options.procedure != Procedure::chapter5; })
      .add(protocol_option(kWindowGroup), &Options::protocol)
      .include(window_table(), &Options::window);
  return table;
}

/// --acceleration and --force-source.
OptionTable<preprocess::Options> source_table() {
  using preprocess::Options;
  OptionTable<Options> table;
  table.group(kFilterGroup)
      .add({"--acceleration", "", "where ẍ comes from"}, &Options::acceleration)
      .add({"--force-source", "",
            "virtual: without a force sensor, from motion, motor torques and the robot's dynamics; observer: the same "
            "as it could be had while the robot runs, for comparison"},
           &Options::force_source);
  return table;
}

}  // namespace

const OptionTable<MeasureRequest>& measure_table() {
  static const auto kTable = [] {
    const auto preprocess = [](auto& request) -> auto& {
      return request.options.preprocess;
    };
    OptionTable<MeasureRequest> table;
    table.include(read_table(), &MeasureRequest::reading)
        .include(sensor_table(), &MeasureRequest::sensor)
        .include(protocol_table(), preprocess)
        .include(filter_table(), preprocess)
        .add(
            resample_option(kFilterGroup), [](auto& request) -> auto& { return request.options.resample; })
        .include(source_table(), preprocess)
        .group(kFilterGroup)
        .add({.name = "--robot",
              .value = "FILE",
              .help = "the robot's dynamics, from 'mbk robot identify --json'; without it those of the thesis's robot",
              .check = not_empty(),
              .names_file = true},
             &MeasureRequest::robot)
        .add(
            force_delay_option(kFilterGroup), [](auto& request) -> auto& { return request.options.force_delay; },
            kMilliseconds)
        .add(
            force_rotation_option(kFilterGroup), [](auto& request) -> auto& { return request.options.force_rotation; },
            kDegrees)
        .include(
            identify_table(), [](auto& request) -> auto& { return request.options.identify; })
        .group("Plausibility")
        .add(
            {.name = "--ignore-range",
             .value = "NAMES",
             .help = "plausible ranges that are not checked, by name, as in --ignore-range stiffness,motion",
             .takes_several = true},
            [](auto& request) -> auto& { return request.options.ignored_ranges; });
    return table;
  }();
  return kTable;
}

const OptionTable<MeasureRequest>& arm_table() {
  static const auto kTable = [] {
    OptionTable<MeasureRequest> table;
    table.group("Model")
        .add_either(
            {"--domain", "",
             "joint: M, B and K at shoulder and elbow too (or at the joints of the robot, where the arm is not "
             "known), in the posture of the recording"},
            "hand", "joint", [](auto& request) -> auto& { return request.options.joint_domain; })
        .add({"--arm",
              "X,Y,UPPER,FORE",
              "the person's arm, where the recording does not hold it: place of the shoulder in the robot's frame, "
              "lengths of upper arm and forearm (to the grip), in metres; the elbow is to the right unless ',left' "
              "follows",
              {[](const std::string& given) {
                return arm_metadata(given) ? "" : fmt::format("{} is not X,Y,UPPER,FORE in metres", quoted(given));
              }}},
             &MeasureRequest::arm);
    return table;
  }();
  return kTable;
}

Result<measurement::Options> measurement_options(const MeasureRequest& request, bool draws_arm) {
  measurement::Options options = request.options;
  preprocess::Options& p = options.preprocess;
  MBK_TRY(check_order(p.window));
  if (p.procedure && p.mode != Mode::reference) {
    return bad_usage(fmt::format("--procedure {} belongs to --mode reference", word_of(*p.procedure)),
                     "add that, or leave --procedure out");
  }
  if (!request.arm.empty() && !options.joint_domain && !draws_arm) {
    return bad_usage("--arm belongs to --domain joint, or to --report, which draws it", "add one, or leave --arm out");
  }
  p.axes = request.reading.options.axes;
  if (p.force_source != ForceSource::sensor) {
    auto robot = MBK_TRY(robot_of(request.robot));
    p.robot = std::make_shared<const robot::DynamicModel>(std::move(robot));
    if (options.force_delay != 0.0) {
      return bad_usage("--force-delay-ms belongs to a force that was measured", "leave it out");
    }
    if (options.force_rotation != 0.0) {
      return bad_usage("--force-rotation-deg belongs to a force that was measured", "leave it out");
    }
  } else if (request.robot) {
    return bad_usage("--robot belongs to --force-source virtual or observer", "add that, or leave --robot out");
  }
  return options;
}

ReadRequest reading_for(ReadRequest reading, const measurement::Options& options) {
  const auto& robot = options.preprocess.robot;
  if (robot) reading.options.joints = robot->mechanism->joint_names();
  return reading;
}

void add_arm(const std::string& arm, Recording& recording) {
  const auto metadata = arm_metadata(arm);
  if (!metadata) return;
  for (const auto& [key, value] : *metadata) recording.metadata[key] = value;
}

}  // namespace mbk::request
