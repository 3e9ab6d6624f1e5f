#include "mbk/present/request/sensor_request.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/files/contents/read_text.h"
#include "mbk/present/request/number_of.h"
#include "mbk/present/result/sensor_json.h"

namespace mbk::request {
namespace {

/// "auto:2", or one voltage for each axis: "0.06,0.28".   @returns  whether it is one of them
bool read_zero(const std::string& text, calibration::SensorUse& use) {
  if (text.starts_with("auto:")) {
    use.zero_from_s = number_of(std::string_view(text).substr(5));
    return use.zero_from_s && *use.zero_from_s > 0.0;
  }
  std::vector<double> values;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto value = number_of(std::string_view(text).substr(begin, end - begin));
    if (!value) return false;
    values.push_back(*value);
    begin = end + 1;
  }
  use.zero_voltage = Eigen::Map<const Vector>(values.data(), std::ssize(values));
  return true;
}

std::string wrong_zero(const std::string& text) {
  calibration::SensorUse unused;
  if (text.empty()) return not_empty().wrong(text);
  if (read_zero(text, unused)) return "";
  return fmt::format("{} is neither auto:SECONDS nor one voltage for each axis, as in auto:2 or 0.063,0.282",
                     quoted(text));
}

}  // namespace

const OptionTable<SensorRequest>& sensor_table() {
  static const auto kTable = [] {
    const std::string sensor = "--sensor";
    OptionTable<SensorRequest> table;
    table.group("Force sensor")
        .add(
            {.name = sensor,
             .value = "FILE.json",
             .help =
                 "calibration that converts the recorded voltages Vx, Vy to force, as written by 'mbk sensor calibrate "
                 "--json'",
             .check = not_empty(),
             .names_file = true},
            &SensorRequest::file)
        .add(
            {"--lever-arm-mm", "MM",
             "lever arm from the strain gauges to the hand, in mm; scales the slope but not the zero (default: as in "
             "the "
             "calibration)",
             positive(), sensor},
            [](auto& request) -> auto& { return request.use.lever_arm; }, kMillimetres)
        .add_row({{"--sensor-zero",
                   "VX,VY|auto:S",
                   "voltage at zero force in these recordings; auto:S takes the mean of the first S seconds (default: "
                   "as in the "
                   "calibration)",
                   {wrong_zero},
                   sensor},
                  [](SensorRequest& request, const std::vector<std::string>& texts) {
                    read_zero(texts.back(), request.use);
                  },
                  [](const SensorRequest& request) { return !request.use.zero_voltage && !request.use.zero_from_s; }})
        .add(
            {"--sensor-frame",
             "",
             "link: the sensor rotates with the last link, at angle q2; base: it does not; auto: link if q2 was "
             "recorded "
             "(default: auto)",
             {},
             sensor},
            [](auto& request) -> auto& { return request.use.frame; })
        .add_either(
            {"--sensor-delay",
             "",
             "undo: advance the force by the delay that the calibration found (default: keep)",
             {},
             sensor},
            "keep", "undo", [](auto& request) -> auto& { return request.use.undo_delay; });
    return table;
  }();
  return kTable;
}

Result<std::optional<calibration::SensorUse>> sensor_use(const SensorRequest& request) {
  if (!request.file) return std::nullopt;
  const auto text = MBK_TRY(read_text(*request.file));
  auto calibration = result::sensor_calibration_from_json(text);
  if (!calibration) return tl::unexpected(calibration.error().in(request.file->string()));
  calibration::SensorUse use = request.use;
  use.calibration = std::move(*calibration);
  use.name = request.file->string();
  return use;
}

}  // namespace mbk::request
