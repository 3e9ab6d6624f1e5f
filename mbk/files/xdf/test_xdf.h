#pragma once

// Bytes of XDF files that the tests write themselves.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/files/contents/test_bytes.h"

namespace mbk::recording::test {

class Xdf {
 public:
  /// The content of a chunk behind its tag, of any tag, with its length in 1, 4 or 8 bytes.
  Xdf& chunk(std::uint16_t tag, const std::string& content, int length_bytes = 4) {
    const std::uint64_t length = content.size() + 2;
    bytes_ += static_cast<char>(length_bytes);
    bytes_ += raw(length).substr(0, static_cast<std::size_t>(length_bytes));
    bytes_ += raw(tag) + content;
    return *this;
  }
  Xdf& header(std::string_view info = "<version>1.0</version>") {
    return chunk(1, "<?xml version=\"1.0\"?><info>" + std::string(info) + "</info>");
  }
  Xdf& stream(std::uint32_t id, std::string_view name, std::string_view format, int channels, double rate,
              std::string_view description = "", std::string_view type = "Force") {
    return chunk(2, raw(id) + "<?xml version=\"1.0\"?><info><name>" + std::string(name) + "</name><type>" +
                        std::string(type) + "</type><channel_count>" + std::to_string(channels) +
                        "</channel_count><nominal_srate>" + std::to_string(rate) + "</nominal_srate><channel_format>" +
                        std::string(format) + "</channel_format><desc>" + std::string(description) + "</desc></info>");
  }
  static std::string labels(const std::vector<std::pair<std::string, std::string>>& labels_and_units) {
    std::string text = "<channels>";
    for (const auto& [label, unit] : labels_and_units) {
      text += "<channel><label>" + label + "</label><unit>" + unit + "</unit></channel>";
    }
    return text + "</channels>";
  }
  static std::string stamped(double stamp) { return "\x08" + raw(stamp); }
  static std::string unstamped() { return std::string(1, '\0'); }
  static std::string text(const std::string& value) {
    return std::string{'\x01', static_cast<char>(value.size())} + value;
  }
  Xdf& samples(std::uint32_t id, const std::vector<std::string>& each) {
    std::string content = raw(id) + std::string{'\x04'} + raw(static_cast<std::uint32_t>(each.size()));
    for (const std::string& one : each) content += one;
    return chunk(3, content);
  }
  Xdf& offset(std::uint32_t id, double time, double value) { return chunk(4, raw(id) + raw(time) + raw(value), 1); }
  Xdf& boundary() {
    return chunk(5, std::string("\x43\xA5\x46\xDC\xCB\xF5\x41\x0F\xB3\x0E\xD5\x46\x73\x83\xCB\xE4", 16), 1);
  }
  Xdf& footer(std::uint32_t id, int samples) {
    return chunk(6, raw(id) + "<?xml version=\"1.0\"?><info><sample_count>" + std::to_string(samples) +
                        "</sample_count></info>");
  }
  Xdf& append(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_ = "XDF:";
};

/// Two streams, offsets, markers and a footer.
inline Xdf small_xdf(std::string_view format = "double64") {
  Xdf file;
  file.header().stream(1, "Robot", format, 2, 100.0, Xdf::labels({{"x", "mm"}, {"Fx", "N"}}));
  file.stream(2, "Markers", "string", 1, 0.0).boundary();
  const auto value = [&](int number) {
    if (format == "int8") return raw(static_cast<std::int8_t>(number));
    if (format == "int16") return raw(static_cast<std::int16_t>(number));
    if (format == "int32") return raw(static_cast<std::int32_t>(number));
    if (format == "int64") return raw(static_cast<std::int64_t>(number));
    if (format == "float32") return raw(static_cast<float>(number));
    return raw(static_cast<double>(number));
  };
  std::vector<std::string> samples;
  for (int k = 0; k < 10; ++k) {
    samples.push_back((k % 4 == 3 ? Xdf::unstamped() : Xdf::stamped(5.0 + 0.01 * k)) + value(k) + value(-2 * k));
  }
  file.samples(1, samples).offset(1, 5.0, -1.0).offset(1, 5.05, -1.0).offset(2, 5.0, -1.0);
  file.samples(2, {Xdf::stamped(5.02) + Xdf::text("onset"), Xdf::stamped(5.06) + Xdf::text("42")});
  file.boundary().footer(1, 10).footer(2, 2);
  return file;
}

}  // namespace mbk::recording::test
