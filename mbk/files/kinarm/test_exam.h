#pragma once

// KINARM exams that the tests write themselves, of both kinds.

#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/files/c3d/test_c3d.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/test_bytes.h"
#include "mbk/files/contents/utf16.h"

namespace mbk::recording::test {

/// A zip archive whose members are stored as they are.
inline std::string zip_of(const std::vector<std::pair<std::string, std::string>>& members) {
  std::string file, directory;
  const auto word = [](std::size_t n) { return raw(static_cast<std::uint32_t>(n)); };
  const auto half = [](std::size_t n) { return raw(static_cast<std::uint16_t>(n)); };
  for (const auto& [name, bytes] : members) {
    const auto sum = crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
    const std::string facts = half(20) + half(0) + half(0) + half(0) + half(0x21) + word(sum) + word(bytes.size()) +
                              word(bytes.size()) + half(name.size()) + half(0);
    directory += "PK\x01\x02" + half(20) + facts + half(0) + half(0) + half(0) + word(0) + word(file.size()) + name;
    file += "PK\x03\x04" + facts + name + bytes;
  }
  return file + directory + "PK\x05\x06" + half(0) + half(0) + half(members.size()) + half(members.size()) +
         word(directory.size()) + word(file.size()) + half(0);
}

inline std::string exam_text(std::string_view utf8) {
  const std::u16string wide = utf16_from_utf8(utf8);
  std::string bytes = raw(static_cast<std::int32_t>(wide.size()));
  for (const char16_t unit : wide) bytes += raw(static_cast<std::uint16_t>(unit));
  return bytes;
}

inline std::string exam_group(std::string_view name) {
  return raw(std::int32_t{1}) + exam_text(name) + exam_text("a group");
}

inline std::string exam_parameter(std::string_view name, const std::vector<float>& values) {
  std::string bytes = raw(std::int32_t{2}) + exam_text(name) + exam_text("") + raw(std::int32_t{3}) +
                      raw(static_cast<std::int32_t>(values.size()));
  for (const float value : values) bytes += raw(value);
  return bytes;
}

inline std::string exam_parameter(std::string_view name, std::int32_t value) {
  return raw(std::int32_t{2}) + exam_text(name) + exam_text("") + raw(std::int32_t{2}) + raw(std::int32_t{1}) +
         raw(value);
}

inline std::string exam_parameter(std::string_view name, std::string_view value) {
  return raw(std::int32_t{2}) + exam_text(name) + exam_text("") + raw(std::int32_t{0}) + raw(std::int32_t{1}) +
         exam_text(value);
}

inline std::string exam_parameters(const std::string& records) {
  return raw(std::int32_t{3}) + records + raw(std::int32_t{0});
}

inline std::string exam_signal(std::string_view label, std::string_view unit, const std::vector<float>& values) {
  std::string bytes = raw(std::int32_t{1}) + exam_text(label) + exam_text("a signal") + exam_text(unit) +
                      raw(static_cast<std::int32_t>(values.size()));
  for (const float value : values) bytes += raw(value);
  return bytes;
}

inline std::string exam_position(std::string_view label, const std::vector<float>& x, const std::vector<float>& y) {
  std::string bytes =
      raw(std::int32_t{1}) + exam_text(label) + exam_text("") + raw(static_cast<std::int32_t>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) bytes += raw(x[i]) + raw(y[i]);
  return bytes;
}

/// The arm and robot of a test: two links, a pointer, a robot of a mass whose motors are commanded a force, a hand
/// that pushes with M, B, K, and a sensor.
struct ArmOfTest {
  double link1 = 0.31, link2 = 0.28, pointer = 0.0;
  double sensor_sign = 1.0;  ///< −1: the sensor reads the force of the robot on the hand
  double robot_mass = 1.2;
  bool commanded = true;  ///< the motors move the hand; otherwise the hand moves the robot
  double hand_stiffness = 150;
};

struct SignalOfTest {
  std::string label, unit;
  std::vector<float> values;
};

struct TrialOfTest {
  std::string folder = "01_01_01";
  std::int32_t number = 1, break_id = 0;
  int frames = 400;
  float rate_hz = 1000.0F;
  std::vector<SignalOfTest> signals;
  std::vector<float> hand_x, hand_y;
  std::string hand = "Right_Hand";
  std::vector<std::pair<std::string, float>> events;
  std::string parameters;  ///< more records
  std::string video;       ///< videoack.bin

  [[nodiscard]] const std::vector<float>& values(std::string_view label) const {
    for (const SignalOfTest& signal : signals) {
      if (signal.label == label) return signal.values;
    }
    static const std::vector<float> none;
    return none;
  }
};

/// Joints that move by several sines, and everything that follows from them.
inline void add_arm(TrialOfTest& trial, const std::string& side, const ArmOfTest& arm, double phase = 0.0) {
  const auto frames = static_cast<std::size_t>(trial.frames);
  const char* const labels[] = {"L1Ang", "L2Ang",    "L1Vel",    "L2Vel",     "L1Acc",
                                "L2Acc", "M1TorCMD", "M2TorCMD", "FS_ForceX", "FS_ForceY"};
  const char* const units[] = {"rad", "rad", "rad/s", "rad/s", "rad/s^2", "rad/s^2", "Nm", "Nm", "N", "N"};
  std::vector<std::vector<float>> signals(10, std::vector<float>(frames));
  trial.hand_x.resize(frames);
  trial.hand_y.resize(frames);
  const double base[] = {0.7, 1.9};
  for (std::size_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(trial.rate_hz);
    double q[2], v[2] = {0, 0}, a[2] = {0, 0};
    for (int j = 0; j < 2; ++j) {
      q[j] = base[j];
      for (int k = 1; k <= 4; ++k) {
        const double w = 2.0 * M_PI * (1.3 * k + 0.4 * j), size = 0.03 / k;
        q[j] += size * std::sin(w * t + phase + j + 2.0 * k);
        v[j] += size * w * std::cos(w * t + phase + j + 2.0 * k);
        a[j] -= size * w * w * std::sin(w * t + phase + j + 2.0 * k);
      }
      // what is stored is what is computed from
      q[j] = static_cast<double>(static_cast<float>(q[j]));
      v[j] = static_cast<double>(static_cast<float>(v[j]));
      a[j] = static_cast<double>(static_cast<float>(a[j]));
    }
    const double s1 = std::sin(q[0]), c1 = std::cos(q[0]), s2 = std::sin(q[1]), c2 = std::cos(q[1]);
    const Eigen::Matrix2d J{{-arm.link1 * s1, -arm.link2 * s2 - arm.pointer * c2},
                            {arm.link1 * c1, arm.link2 * c2 - arm.pointer * s2}};
    const Eigen::Vector2d place{arm.link1 * c1 + arm.link2 * c2 - arm.pointer * s2,
                                arm.link1 * s1 + arm.link2 * s2 + arm.pointer * c2};
    const Eigen::Vector2d turning =
        -arm.link1 * v[0] * v[0] * Eigen::Vector2d{c1, s1} -
        v[1] * v[1] * (arm.link2 * Eigen::Vector2d{c2, s2} + arm.pointer * Eigen::Vector2d{-s2, c2});
    const Eigen::Vector2d velocity = J * Eigen::Vector2d{v[0], v[1]};
    const Eigen::Vector2d acceleration = J * Eigen::Vector2d{a[0], a[1]} + turning;
    const Eigen::Vector2d rest{
        arm.link1 * std::cos(base[0]) + arm.link2 * std::cos(base[1]) - arm.pointer * std::sin(base[1]),
        arm.link1 * std::sin(base[0]) + arm.link2 * std::sin(base[1]) + arm.pointer * std::cos(base[1])};
    Eigen::Vector2d hand = -(1.5 * acceleration + 8.0 * velocity + arm.hand_stiffness * (place - rest));
    Eigen::Vector2d motors = arm.robot_mass * acceleration - hand;
    if (!arm.commanded) {
      hand = arm.robot_mass * acceleration;
      motors.setZero();
    }
    const Eigen::Vector2d torque = J.transpose() * motors;
    const double row[] = {
        q[0], q[1], v[0], v[1], a[0], a[1], torque[0], torque[1], arm.sensor_sign * hand[0], arm.sensor_sign * hand[1]};
    for (std::size_t k = 0; k < 10; ++k) signals[k][i] = static_cast<float>(row[k]);
    trial.hand_x[i] = static_cast<float>(place[0]);
    trial.hand_y[i] = static_cast<float>(place[1]);
  }
  for (std::size_t k = 0; k < 10; ++k) trial.signals.push_back({side + "_" + labels[k], units[k], signals[k]});
}

/// A `.kinarm` file.
struct ExamOfTest {
  std::vector<TrialOfTest> trials;
  std::string common;  ///< records of raw/common/parameters.bin

  /// Of an End-Point robot with the links of `arm`.
  [[nodiscard]] static std::string end_point(const ArmOfTest& arm, std::string_view side = "RIGHT") {
    return exam_group(std::string(side) + "_KINARM") + exam_parameter("VERSION", "KINARM_EP_2.0") +
           exam_parameter("IS_PRESENT", std::int32_t{1}) +
           exam_parameter("L1_L", std::vector<float>{static_cast<float>(arm.link1)}) +
           exam_parameter("L2_L", std::vector<float>{static_cast<float>(arm.link2)});
  }

  [[nodiscard]] std::vector<std::pair<std::string, std::string>> members() const {
    std::vector<std::pair<std::string, std::string>> all = {{"description.txt", "of Jane Doe"},
                                                            {"raw/common/parameters.bin", exam_parameters(common)}};
    for (const TrialOfTest& trial : trials) {
      const std::string folder = "raw/" + trial.folder + "/";
      const bool hand = !trial.hand_x.empty() && !trial.hand.empty();
      std::string header = raw(std::int32_t{3}) + raw(static_cast<std::int32_t>(trial.frames)) +
                           raw(static_cast<std::int32_t>(trial.signals.size())) + raw(std::int32_t{hand ? 1 : 0}) +
                           raw(static_cast<std::int32_t>(trial.events.size())) + raw(std::int32_t{0}) +
                           raw(trial.rate_hz) + exam_text("Doe_Jane_2021");
      for (const SignalOfTest& signal : trial.signals) header += exam_text(signal.label);
      if (hand) header += exam_text(trial.hand);
      all.emplace_back(folder + "header.bin", header);
      all.emplace_back(folder + "parameters.bin",
                       exam_parameters(exam_group("TRIAL") + exam_parameter("TRIAL_NUM", trial.number) +
                                       exam_parameter("TP", std::int32_t{4}) +
                                       exam_parameter("BREAK_ID", trial.break_id) + trial.parameters));
      for (const SignalOfTest& signal : trial.signals) {
        all.emplace_back(folder + signal.label + ".kinematics", exam_signal(signal.label, signal.unit, signal.values));
      }
      if (hand) {
        all.emplace_back(folder + trial.hand + ".position", exam_position(trial.hand, trial.hand_x, trial.hand_y));
      }
      std::string events = raw(std::int32_t{3}) + raw(static_cast<std::int32_t>(trial.events.size()));
      for (const auto& [label, time] : trial.events) events += exam_text(label) + exam_text("") + raw(time);
      all.emplace_back(folder + "examevents.bin", events);
      if (!trial.video.empty()) all.emplace_back(folder + "videoack.bin", trial.video);
    }
    return all;
  }

  [[nodiscard]] std::string bytes() const { return zip_of(members()); }
};

/// One trial of a right arm on an End-Point robot.
inline ExamOfTest small_exam(const ArmOfTest& arm = {}, int trials = 1, int frames = 400) {
  ExamOfTest exam;
  exam.common =
      ExamOfTest::end_point(arm) + exam_group("ANALOG") + exam_parameter("RATE", std::vector<float>{1000.0F}) +
      exam_group("EXPERIMENT") + exam_parameter("TASK_PROTOCOL", "Reaching, 8 targets") +
      exam_parameter("START_DATE_TIME", "2021-03-04 10:11") + exam_parameter("OPERATOR", "R. Roe") +
      exam_parameter("TASK_PROGRAM_BUILD_TDK", "3.4.2") + exam_group("SUBJECT") + exam_parameter("LAST_NAME", "Doe") +
      exam_parameter("DATE_OF_BIRTH", "1970-01-01") + exam_parameter("AGE", std::int32_t{51});
  for (int k = 0; k < trials; ++k) {
    TrialOfTest& trial = exam.trials.emplace_back();
    trial.number = k + 1;
    trial.folder = "02_0" + std::to_string(k % 10) + "_" + std::to_string(k / 10 + 1);
    trial.frames = frames;
    trial.events = {{"Début 開始", 0.1F}, {"STOP", 0.35F}};
    add_arm(trial, "Right", arm, 0.5 * k);
  }
  return exam;
}

inline std::shared_ptr<const Buffer> buffer_of(const std::string& bytes) {
  auto buffer = std::make_shared<Buffer>(bytes.size());
  std::memcpy(buffer->data.get(), bytes.data(), bytes.size());
  return buffer;
}

}  // namespace mbk::recording::test
