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
      .add({"--mode", "",
            "default, or reference: reproduce the published procedure sample for sample (default: default)"},
           &Options::mode)
      .add({"--procedure", "",
            "with --mode reference. chapter3: Savitzky–Golay window 101, cutoff 5 Hz, ẍ from the position; chapter5: "
            "window 151, cutoff 4.5 Hz, ẍ from the accelerometer (default: chapter3)"},
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
      .add({"--acceleration", "", "source of ẍ: the accelerometer, or the derivative of the position"},
           &Options::acceleration)
      .add({"--force-source", "",
            "source of the force. virtual: no force sensor; from motion, motor torques and the robot's dynamics; "
            "observer: "
            "the same estimated causally, as while the robot runs, for comparison (default: sensor)"},
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
              .help =
                  "the robot's dynamics, as written by 'mbk robot identify --json' (default: the robot of the thesis)",
              .check = not_empty(),
              .names_file = true},
             &MeasureRequest::robot)
        .add(
            force_delay_option(kFilterGroup), [](auto& request) -> auto& { return request.options.force_delay; },
            kMilliseconds)
        .add_row(force_rotation_row<MeasureRequest>(kFilterGroup))
        .include(
            identify_table(), [](auto& request) -> auto& { return request.options.identify; })
        .group("Plausibility")
        .add(
            {.name = "--ignore-range",
             .value = "NAMES",
             .help = "plausible ranges not to check, by name: --ignore-range stiffness,motion",
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
             "joint: also M, B and K at shoulder and elbow, or at the robot's joints if the arm is unknown, in the "
             "posture of "
             "the recording (default: hand)"},
            "hand", "joint", [](auto& request) -> auto& { return request.options.joint_domain; })
        .add({"--arm",
              "X,Y,UPPER,FORE",
              "the person's arm, if the recording does not contain it: shoulder position in the robot's frame and "
              "lengths "
              "of upper arm and forearm (to the grip), in metres; the elbow points to the right unless ',left' follows",
              {[](const std::string& given) {
                return arm_metadata(given)
                           ? ""
                           : fmt::format("{} is not of the form X,Y,UPPER,FORE in metres", quoted(given));
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
    return bad_usage(fmt::format("--procedure {} is valid only with --mode reference", word_of(*p.procedure)),
                     "add --mode reference, or omit --procedure");
  }
  if (!request.arm.empty() && !options.joint_domain && !draws_arm) {
    return bad_usage("--arm is valid only with --domain joint or --report", "add one of them, or omit --arm");
  }
  p.axes = request.reading.options.axes;
  if (p.force_source != ForceSource::sensor) {
    auto robot = MBK_TRY(robot_of(request.robot));
    p.robot = std::make_shared<const robot::DynamicModel>(std::move(robot));
    if (options.force_delay != 0.0) {
      return bad_usage("--force-delay-ms is valid only for a measured force", "omit it");
    }
    if (options.force_rotation != preprocess::RotationVector{}) {
      return bad_usage("--force-rotation-deg is valid only for a measured force", "omit it");
    }
  } else if (request.robot) {
    return bad_usage("--robot is valid only with --force-source virtual or observer",
                     "add --force-source, or omit --robot");
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
