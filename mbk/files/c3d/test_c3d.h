#pragma once

// C3D files that the tests write themselves, for every processor and either kind of number.

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/files/contents/test_bytes.h"

namespace mbk::recording::test {

/// Numbers as a processor writes them: 84 Intel, 85 DEC, 86 SGI.
struct C3dNumbers {
  int processor = 84;

  [[nodiscard]] std::string word(double value) const {
    return raw(static_cast<std::uint16_t>(static_cast<std::int32_t>(value)), processor == 86);
  }
  [[nodiscard]] std::string real(double value) const {
    if (processor != 85) return raw(static_cast<float>(value), processor == 86);
    int exponent = 0;
    const double fraction = std::frexp(std::abs(value), &exponent);  // 0.1f in binary
    if (fraction == 0.0) return std::string(4, '\0');
    const auto digits = static_cast<std::uint32_t>(std::lround(std::ldexp(fraction, 24)));
    const std::uint32_t bits =
        (value < 0 ? 0x80000000u : 0u) | static_cast<std::uint32_t>(exponent + 128) << 23u | (digits & 0x7FFFFFu);
    return raw(static_cast<std::uint16_t>(bits >> 16u)) + raw(static_cast<std::uint16_t>(bits & 0xFFFFu));
  }

  // ---- records of the parameter section; the distance to the next is always that behind the record ----

  [[nodiscard]] std::string group(int id, std::string_view name) const {
    return static_cast<char>(name.size()) + std::string(1, static_cast<char>(-id)) + std::string(name) + word(3) +
           std::string(1, '\0');
  }
  [[nodiscard]] std::string parameter(int id, std::string_view name, int type, const std::vector<int>& dimensions,
                                      const std::string& data) const {
    std::string content = std::string(1, static_cast<char>(type)) + static_cast<char>(dimensions.size());
    for (const int d : dimensions) content += static_cast<char>(d);
    content += data + '\0';
    return static_cast<char>(name.size()) + std::string(1, static_cast<char>(id)) + std::string(name) +
           word(static_cast<double>(content.size()) + 2) + content;
  }
  [[nodiscard]] std::string words(int id, std::string_view name, const std::vector<double>& values) const {
    std::string data;
    for (const double value : values) data += word(value);
    return parameter(id, name, 2, {static_cast<int>(values.size())}, data);
  }
  [[nodiscard]] std::string reals(int id, std::string_view name, const std::vector<double>& values) const {
    std::string data;
    for (const double value : values) data += real(value);
    return parameter(id, name, 4, {static_cast<int>(values.size())}, data);
  }
  [[nodiscard]] std::string texts(int id, std::string_view name, const std::vector<std::string>& values) const {
    std::size_t longest = 1;
    for (const std::string& value : values) longest = std::max(longest, value.size());
    std::string data;
    for (std::string value : values) {
      value.resize(longest, ' ');
      data += value;
    }
    return parameter(id, name, -1, {static_cast<int>(longest), static_cast<int>(values.size())}, data);
  }
};

/// `values` in parts of at most 255, each under its own name: LABELS, LABELS2, …
template <class Value, class Write>
std::string in_parts(const std::vector<Value>& values, std::string_view name, const Write& write) {
  std::string records;
  for (std::size_t begin = 0, part = 1; begin < values.size(); begin += 255, ++part) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = values.begin() + static_cast<std::ptrdiff_t>(std::min(begin + 255, values.size()));
    records += write(std::string(name) + (part > 1 ? std::to_string(part) : ""), std::vector<Value>(first, last));
  }
  return records;
}

/// A C3D file, in the words of the format; `bytes` writes it.
struct C3d {
  static constexpr int kPoint = 1, kAnalog = 2, kTrial = 3, kEvent = 4;  ///< numbers of the groups

  int processor = 84;
  bool real = true;
  double scale = 0.5;                         ///< of the points; its sign is `real`'s
  std::vector<std::string> points, channels;  ///< labels
  Matrix coordinates;                         ///< frames × 4·points: x, y, z in POINT:UNITS, residual
  int samples = 1;                            ///< of each channel in a frame
  Matrix analog;                              ///< frames·samples × channels, as stored
  std::vector<double> analog_scale, analog_offset;
  std::vector<std::string> analog_units;
  double general_scale = 1.0, rate = 100.0;
  std::string format = "SIGNED", point_units = "mm";
  std::string records;                                 ///< further ones, which go before those of the same name
  double first = 1.0;                                  ///< frame
  std::vector<std::pair<double, std::string>> events;  ///< of the header; four letters

  [[nodiscard]] C3dNumbers numbers() const { return {processor}; }
  [[nodiscard]] Index frames() const { return points.empty() ? analog.rows() / samples : coordinates.rows(); }

  [[nodiscard]] std::string parameters(std::size_t data_block) const {
    const C3dNumbers n = numbers();
    const auto count = [](const auto& all) { return static_cast<double>(all.size()); };
    std::string text = n.group(kPoint, "POINT") + n.group(kAnalog, "ANALOG") + n.group(kTrial, "TRIAL") +
                       n.group(kEvent, "EVENT") + records;
    text += n.words(kPoint, "USED", {count(points)});
    text += n.reals(kPoint, "SCALE", {real ? -scale : scale}) + n.reals(kPoint, "RATE", {rate});
    text += n.words(kPoint, "DATA_START", {static_cast<double>(data_block)});
    text += n.words(kPoint, "FRAMES", {static_cast<double>(std::min<Index>(frames(), 65535))});
    text += n.texts(kPoint, "UNITS", {point_units});
    const auto write_texts = [&](int group) {
      return [&n, group](const std::string& name, const auto& part) { return n.texts(group, name, part); };
    };
    const auto write_reals = [&](const std::string& name, const auto& part) { return n.reals(kAnalog, name, part); };
    const auto write_words = [&](const std::string& name, const auto& part) { return n.words(kAnalog, name, part); };
    text += in_parts(points, "LABELS", write_texts(kPoint));
    text += n.words(kAnalog, "USED", {count(channels)});
    text += n.reals(kAnalog, "GEN_SCALE", {general_scale}) + n.reals(kAnalog, "RATE", {rate * samples});
    text += n.texts(kAnalog, "FORMAT", {format});
    text += in_parts(channels, "LABELS", write_texts(kAnalog)) + in_parts(analog_units, "UNITS", write_texts(kAnalog));
    text += in_parts(analog_scale, "SCALE", write_reals) + in_parts(analog_offset, "OFFSET", write_words);
    return text + '\0';
  }

  [[nodiscard]] std::string header(std::size_t data_block) const {
    const C3dNumbers n = numbers();
    const auto count = [](const auto& all) { return static_cast<double>(all.size()); };
    const double last = std::min(first + static_cast<double>(frames()) - 1.0, 65535.0);
    std::string text = "\x02\x50" + n.word(count(points)) + n.word(count(channels) * samples) + n.word(first) +
                       n.word(last) + n.word(0) + n.real(real ? -scale : scale) +
                       n.word(static_cast<double>(data_block)) + n.word(samples) + n.real(rate);
    text.resize(298);
    text += n.word(12345) + n.word(count(events)) + n.word(0);
    for (const auto& event : events) text += n.real(event.first);
    text.resize(396);
    for (const auto& event : events) text += event.second;
    text.resize(512);
    return text;
  }

  [[nodiscard]] std::string data() const {
    const C3dNumbers n = numbers();
    const auto number = [&](double value) { return real ? n.real(value) : n.word(std::round(value)); };
    std::string text;
    for (Index f = 0; f < frames(); ++f) {
      for (Index k = 0; k < static_cast<Index>(4 * points.size()); ++k) {
        text += number(coordinates(f, k) / (real || k % 4 == 3 ? 1.0 : scale));
      }
      for (Index k = 0; k < static_cast<Index>(channels.size()) * samples; ++k) {
        const auto each = static_cast<Index>(channels.size());
        text += number(analog(f * samples + k / each, k % each));
      }
    }
    return text;
  }

  [[nodiscard]] std::string bytes() const {
    const std::size_t blocks = (4 + parameters(0).size() + 511) / 512;
    const std::size_t data_block = 2 + blocks;
    std::string section =
        std::string("\x01\x50", 2) + static_cast<char>(blocks) + static_cast<char>(processor) + parameters(data_block);
    section.resize(512 * blocks);
    std::string values = data();
    values.resize((values.size() + 511) / 512 * 512);
    return header(data_block) + section + values;
  }
};

/// Two points, one of them lost now and then, and three channels of different scales at twice their rate, in numbers
/// that both kinds of file hold exactly.
inline C3d small_c3d(int processor = 84, bool real = true) {
  C3d file;
  file.processor = processor;
  file.real = real;
  file.points = {"HAND", "ELBOW"};
  file.channels = {"Force X", "Angle", "EMG"};
  file.samples = 2;
  file.analog_scale = {0.25, 0.5, 2.0};
  file.analog_offset = {2048, 0, -3};
  file.analog_units = {"N", "deg", "uV"};
  constexpr Index kFrames = 6;
  file.coordinates.resize(kFrames, 8);
  file.analog.resize(2 * kFrames, 3);
  for (Index f = 0; f < kFrames; ++f) {
    for (Index k = 0; k < 8; ++k) file.coordinates(f, k) = k % 4 == 3 ? 1.0 : 0.5 * static_cast<double>(f * f - 7 * k);
    if (f % 3 == 1) file.coordinates(f, 7) = -1.0;
  }
  for (Index s = 0; s < 2 * kFrames; ++s) {
    for (Index c = 0; c < 3; ++c) file.analog(s, c) = static_cast<double>(100 * c + s * s);
  }
  file.events = {{0.02, "PUSH"}, {0.05, "STOP"}};
  return file;
}

}  // namespace mbk::recording::test
