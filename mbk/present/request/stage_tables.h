#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/option_table.h"
#include "mbk/base/core/result.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/preprocess/force_rotation.h"
#include "mbk/measure/preprocess/options.h"

/// The options of stages that several requests share.
namespace mbk::request {

inline constexpr const char* kWindowGroup = "Analysed interval";
inline constexpr const char* kFilterGroup = "Filters";

/// --from, --split, --to.
[[nodiscard]] const OptionTable<preprocess::WindowLimits>& window_table();
/// --sg-window, --sg-order, --cutoff, --extension, --padding, --every.
[[nodiscard]] const OptionTable<preprocess::Options>& filter_table();
/// --method, --structure, --parameters-from, --handle-mass, --hac-lag, --bootstrap, --seed, --decimate-check.
[[nodiscard]] const OptionTable<identify::Options>& identify_table();

/// --resample, which several requests place in different groups.
[[nodiscard]] OptionFacts resample_option(const char* group = "");
/// --force-delay-ms and --force-rotation-deg, likewise.
[[nodiscard]] OptionFacts force_delay_option(const char* group = "");
[[nodiscard]] OptionFacts force_rotation_option(const char* group = "");
/// [rad] of "ANGLE" about z or "RX,RY,RZ" [°]; nothing for other texts.
[[nodiscard]] std::optional<preprocess::RotationVector> rotation_vector(const std::string& text);
template <class Request>
[[nodiscard]] typename OptionTable<Request>::Row force_rotation_row(const char* group) {
  return {force_rotation_option(group),
          [](Request& request, const std::vector<std::string>& texts) {
            request.options.force_rotation = rotation_vector(texts.back()).value_or(preprocess::RotationVector{});
          },
          [](const Request& request) { return request.options.force_rotation == preprocess::RotationVector{}; }};
}
/// --protocol, likewise.
[[nodiscard]] OptionFacts protocol_option(const char* group);

/// Limits of time must be in order; whether they lie in the recording is seen when it is read.
/// @fails  usage: they are not.
[[nodiscard]] Result<void> check_order(const preprocess::WindowLimits& window);

}  // namespace mbk::request
