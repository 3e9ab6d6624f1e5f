#include "mbk/present/request/stage_tables.h"

#include <fmt/format.h>

#include <optional>

namespace mbk::request {

const OptionTable<preprocess::WindowLimits>& window_table() {
  using preprocess::WindowLimits;
  static const auto kTable = [] {
    OptionTable<WindowLimits> table;
    table.group(kWindowGroup)
        .add({"--from", "S", "first second that counts, from the start of the recording", not_negative()},
             &WindowLimits::from_s)
        .add({"--split", "S", "data before it identify, data after it are held out", positive()},
             &WindowLimits::split_s)
        .add({"--to", "S", "last second that counts", positive()}, &WindowLimits::to_s);
    return table;
  }();
  return kTable;
}

const OptionTable<preprocess::Options>& filter_table() {
  using preprocess::Options;
  static const auto kTable = [] {
    OptionTable<Options> table;
    table.group(kFilterGroup)
        .add({"--sg-window", "W", "Savitzky–Golay window W in samples, odd", odd_number(3, 1'000'001)},
             &Options::smoothing_window)
        .add({"--sg-order", "N", "Savitzky–Golay order N (6)", whole_number(1, 1000)}, &Options::smoothing_order)
        .add_row({{"--cutoff",
                   "HZ|none",
                   "zero-phase Butterworth low-pass; otherwise by the excited band",
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
            {"--extension", "", "how signals are continued at their ends for the zero-phase filter (odd)"},
            [](auto& options) -> auto& { return options.padding.extension; })
        .add(
            {"--padding", "N", "by how many samples (15)", whole_number(0, 1'000'000)},
            [](auto& options) -> auto& { return options.padding.samples; })
        .add({"--every", "N",
              "the fit takes every so many of the filtered samples; otherwise ten for each period of the cutoff, and "
              "all in reference mode",
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
              "ls: least squares; iv: instrumental variables, which need the reference and hold in closed loop too; "
              "otherwise iv where the reference is a force and they hold, else ls"},
             &Options::method)
        .add({"--structure", "", "full; symmetric: M and K symmetric; mass-spring: M = m I, no damping, K symmetric"},
             &Options::structure)
        .add({"--parameters-from", "",
              "all: parameters from every window, fit judged on the held-out half (default for underdamped)"},
             &Options::parameters_from)
        .add({"--handle-mass", "KG",
              "mass between sensor and hand, subtracted from the inertia; otherwise what the recording says, and "
              "none in reference mode",
              not_negative()},
             &Options::handle_mass)
        .add({"--hac-lag", "S", "reach of the residual's correlation in the standard errors (1)", positive()},
             &Options::hac_lag_s)
        .add({"--bootstrap", "N",
              "so many fits to data drawn anew from blocks of 2.5 s, for intervals of every parameter, ellipse, "
              "eigenvalue and the excess of passivity that rest on no formula (0: none; 1000 take a moment)",
              whole_number(0, 1'000'000)},
             &Options::bootstrap)
        .add({"--seed", "N", "of the bootstrap (1)", whole_number(0, 2'000'000'000)}, &Options::seed)
        .add({"--decimate-check", "", "fit again at 100 Hz and say what changes"}, &Options::decimate_check);
    return table;
  }();
  return kTable;
}

OptionFacts resample_option(const char* group) {
  return {.name = "--resample",
          .value = "HZ",
          .help = "put an uneven clock right first, by straight lines; never done unasked",
          .check = positive(),
          .group = group};
}

OptionFacts force_delay_option(const char* group) {
  constexpr double kLongestDelayMs = 1000.0;
  return {.name = "--force-delay-ms",
          .value = "MS",
          .help = "by which the force was read late, as 'mbk sensor delay' finds it: undone first (0)",
          .check = number_within(kLongestDelayMs),
          .group = group};
}

OptionFacts force_rotation_option(const char* group) {
  return {.name = "--force-rotation-deg",
          .value = "DEG",
          .help = "turn the force by this angle from x to y first: for a force sensor mounted at an angle (0)",
          .check = number_within(180.0),
          .group = group};
}

OptionFacts protocol_option(const char* group) {
  return {.name = "--protocol",
          .value = std::string(option_values::kAuto),
          .help = "how the limb was perturbed; auto looks at the reference and says what it saw",
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
