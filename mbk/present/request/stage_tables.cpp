#include "mbk/present/request/stage_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/units.h"

namespace mbk::request {

const OptionTable<preprocess::WindowLimits>& window_table() {
  using preprocess::WindowLimits;
  static const auto kTable = [] {
    OptionTable<WindowLimits> table;
    table.group(kWindowGroup)
        .add({"--from", "S", "start of the analysed interval, in seconds from the start of the recording",
              not_negative()},
             &WindowLimits::from_s)
        .add({"--split", "S",
              "use the data before this time, in seconds, to identify the model and the data after it as validation "
              "data",
              positive()},
             &WindowLimits::split_s)
        .add({"--to", "S", "end of the analysed interval, in seconds from the start of the recording", positive()},
             &WindowLimits::to_s);
    return table;
  }();
  return kTable;
}

const OptionTable<preprocess::Options>& filter_table() {
  using preprocess::Options;
  static const auto kTable = [] {
    OptionTable<Options> table;
    table.group(kFilterGroup)
        .add({"--sg-window", "W", "Savitzky–Golay window: an odd number of samples", odd_number(3, 1'000'001)},
             &Options::smoothing_window)
        .add({"--sg-order", "N", "Savitzky–Golay order (default: 6)", whole_number(1, 1000)}, &Options::smoothing_order)
        .add_row(
            {{"--cutoff",
              "HZ|none",
              "cutoff frequency of the zero-phase Butterworth low-pass filter, in Hz (default: from the excited band)",
              {[](const std::string& given) -> std::string {
                const bool good = given == "none" || positive().wrong(given).empty();
                return good ? "" : fmt::format("{} is neither a positive number nor 'none'", quoted(given));
              }}},
             [](Options& options, const std::vector<std::string>& texts) {
               options.no_lowpass = texts.back() == "none";
               options.cutoff.reset();
               if (!options.no_lowpass) option_values::set(options.cutoff, texts, 1.0);
             },
             [](const Options& options) { return !options.no_lowpass && !options.cutoff; }})
        .add(
            {"--extension", "", "how signals are extended at their ends for the zero-phase filter (default: odd)"},
            [](auto& options) -> auto& { return options.padding.extension; })
        .add(
            {"--padding", "N", "samples that signals are extended by at each end (default: 15)",
             whole_number(0, 1'000'000)},
            [](auto& options) -> auto& { return options.padding.samples; })
        .add({"--every", "N",
              "fit every Nth filtered sample (default: ten samples for each period of the cutoff; all samples in "
              "reference mode)",
              whole_number(1, 1'000'000)},
             &Options::every);
    return table;
  }();
  return kTable;
}

const OptionTable<identify::Options>& identify_table() {
  using identify::Options;
  static const auto kTable = [] {
    OptionTable<Options> table;
    table.group("Model")
        .add({"--method", "",
              "ls: least squares; iv: instrumental variables, which need the recorded reference and are unbiased in "
              "closed loop too (default: iv if the reference is a strong instrument, with every first-stage F (how "
              "well the "
              "reference predicts the motion) above 104.7, and the result is usable; otherwise ls; in reference mode "
              "always ls)"},
             &Options::method)
        .add({"--structure", "",
              "structure of M, B and K. full: unconstrained; symmetric: M and K symmetric; mass-spring: M = m I, no "
              "damping, K "
              "symmetric"},
             &Options::structure)
        .add({"--parameters-from", "",
              "all: estimate the parameters from every window and judge the fit on the held-out half (default for "
              "underdamped)"},
             &Options::parameters_from)
        .add({"--handle-mass", "KG",
              "mass between force sensor and hand, in kg, subtracted from the inertia (default: the mass in the "
              "recording; "
              "in reference mode none)",
              not_negative()},
             &Options::handle_mass)
        .add({"--hac-lag", "S",
              "correlation time of the residual, in seconds, that the standard errors allow for (default: 1)",
              positive()},
             &Options::hac_lag_s)
        .add({"--bootstrap", "N",
              "number of block-bootstrap resamples (blocks of 2.5 s) for confidence intervals of the parameters, "
              "ellipses, "
              "eigenvalues and the excess of passivity, damping to spare (default: 0, none; 1000 take some seconds)",
              whole_number(0, 1'000'000)},
             &Options::bootstrap)
        .add({"--seed", "N", "random seed of the bootstrap (default: 1)", whole_number(0, 2'000'000'000)},
             &Options::seed)
        .add({"--decimate-check", "", "fit again at 100 Hz and report what changes"}, &Options::decimate_check);
    return table;
  }();
  return kTable;
}

OptionFacts resample_option(const char* group) {
  return {.name = "--resample",
          .value = "HZ",
          .help = "resample unevenly sampled data to this rate by linear interpolation (default: never)",
          .check = positive(),
          .group = group};
}

OptionFacts force_delay_option(const char* group) {
  constexpr double kLongestDelayMs = 1000.0;
  return {.name = "--force-delay-ms",
          .value = "MS",
          .help = "delay of the force signal, as 'mbk sensor delay' measures it, in ms; corrected first (default: 0)",
          .check = number_within(kLongestDelayMs),
          .group = group};
}

std::optional<preprocess::RotationVector> rotation_vector(const std::string& text) {
  const OptionCheck angle = number_within(180.0);
  std::vector<double> degrees;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string one = text.substr(begin, end - begin);
    if (!angle.wrong(one).empty()) return std::nullopt;
    option_values::set(degrees.emplace_back(), one, kDegrees);
    begin = end + 1;
  }
  if (degrees.size() == 1) return preprocess::RotationVector{0.0, 0.0, degrees[0]};
  if (degrees.size() == 3) return preprocess::RotationVector{degrees[0], degrees[1], degrees[2]};
  return std::nullopt;
}

OptionFacts force_rotation_option(const char* group) {
  return {.name = "--force-rotation-deg",
          .value = "DEG",
          .help =
              "rotate the force by this angle from x towards y first, for a force sensor mounted at an angle; with "
              "three axes also RX,RY,RZ, a rotation vector (default: 0)",
          .check = {[](const std::string& given) {
            if (rotation_vector(given)) return std::string();
            return given.find(',') == given.npos
                       ? number_within(180.0).wrong(given)
                       : fmt::format("{} is not three numbers from -180 to 180, RX,RY,RZ", quoted(given));
          }},
          .group = group};
}

OptionFacts protocol_option(const char* group) {
  return {.name = "--protocol",
          .value = std::string(option_values::kAuto),
          .help = "how the limb was perturbed; auto decides from the reference and reports its choice (default: auto)",
          .group = group};
}

Result<void> check_order(const preprocess::WindowLimits& window) {
  const auto before = [](const char* first, std::optional<double> begin, const char* second,
                         std::optional<double> end) -> Result<void> {
    if (!begin || !end || *begin < *end) return {};
    return bad_usage(fmt::format("{} {:g} s is not before {} {:g} s", first, *begin, second, *end));
  };
  MBK_TRY(before("--from", window.from_s, "--to", window.to_s));
  MBK_TRY(before("--from", window.from_s, "--split", window.split_s));
  return before("--split", window.split_s, "--to", window.to_s);
}

}  // namespace mbk::request
