#include "apps/mbk/options/sensor_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "apps/mbk/options/output.h"
#include "apps/mbk/options/word_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/units.h"
#include "mbk/files/contents/read_text.h"
#include "mbk/present/result/sensor_json.h"

namespace mbk::app {
namespace {

std::optional<double> number_of(std::string_view text) {
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// "auto:2", or one voltage for each axis: "0.06,0.28".
Result<void> read_zero(const std::string& text, calibration::SensorUse& use) {
  const auto wrong = [&] {
    return bad_usage(
        fmt::format("--sensor-zero: {} is neither auto:SECONDS nor one voltage for each axis", quoted(text)),
        "as in --sensor-zero auto:2 or --sensor-zero 0.063,0.282");
  };
  if (text.starts_with("auto:")) {
    use.zero_from_s = number_of(std::string_view(text).substr(5));
    if (!use.zero_from_s || !(*use.zero_from_s > 0.0)) return wrong();
    return {};
  }
  std::vector<double> values;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto value = number_of(std::string_view(text).substr(begin, end - begin));
    if (!value) return wrong();
    values.push_back(*value);
    begin = end + 1;
  }
  use.zero_voltage = Eigen::Map<const Vector>(values.data(), std::ssize(values));
  return {};
}

}  // namespace

Option add_sensor_frame(Command command, calibration::SensorFrame& frame, const char* description) {
  return add_choice(command, "--sensor-frame", frame, description);
}

void add_sensor_options(Command command, SensorArguments& arguments) {
  const char* const group = "Force sensor";
  const Option sensor =
      command
          .add_option("--sensor", arguments.file,
                      "calibration that makes the force of the recording's voltages Vx, Vy; 'mbk sensor calibrate "
                      "--json' writes it")
          .type_name("FILE.json")
          .check(not_empty())
          .group(group);
  command
      .add_option("--lever-arm-mm", arguments.lever_arm_mm,
                  "from the gauges to the hand; the slope is scaled with it, the zero is not (as in the calibration)")
      .type_name("MM")
      .check(positive())
      .needs(sensor)
      .group(group);
  command
      .add_option("--sensor-zero", arguments.zero,
                  "voltage of no force in these recordings: auto:S is the mean of the first S seconds (as in the "
                  "calibration)")
      .type_name("VX,VY|auto:S")
      .check(not_empty())
      .needs(sensor)
      .group(group);
  add_sensor_frame(command, arguments.frame,
                   "link: the sensor turns with the last link, at q2; base: it does not; auto: link where q2 is there")
      .needs(sensor)
      .group(group);
  add_choice(command, "--sensor-delay", arguments.delay,
             "undo: move the force earlier by the delay that the calibration saw (keep)")
      .needs(sensor)
      .group(group);
}

Result<std::optional<calibration::SensorUse>> sensor_use(const SensorArguments& arguments) {
  if (!arguments.file) return std::nullopt;
  calibration::SensorUse use;
  if (!arguments.zero.empty()) {
    MBK_TRY(read_zero(arguments.zero, use));
  }
  const auto text = MBK_TRY(read_text(*arguments.file));
  auto calibration = result::sensor_calibration_from_json(text);
  if (!calibration) return tl::unexpected(calibration.error().in(arguments.file->string()));
  use.calibration = std::move(*calibration);
  use.name = arguments.file->string();
  if (arguments.lever_arm_mm) use.lever_arm = *arguments.lever_arm_mm / kMillimetres;
  use.frame = arguments.frame;
  use.undo_delay = arguments.delay == SensorDelay::undo;
  return use;
}

}  // namespace mbk::app
