#include "apps/mbk/options/preprocess_options.h"

#include <fmt/format.h>

#include <charconv>

#include "apps/mbk/options/word_options.h"
#include "mbk/base/core/option_checks.h"

namespace mbk::app {
namespace {

constexpr double kLongestDelayMs = 1000.0;
constexpr const char* kWindow = "Analysed interval";
constexpr const char* kFilters = "Filters";

/// Limits of time must be in order; whether they lie in the recording is seen when it is read.
Result<void> check_order(const WindowArguments& a) {
  const auto before = [](const char* first, std::optional<double> begin, const char* second,
                         std::optional<double> end) -> Result<void> {
    if (!begin || !end || *begin < *end) return {};
    return bad_usage(fmt::format("{} {:g} s is not before {} {:g} s", first, *begin, second, *end));
  };
  MBK_TRY(before("--from", a.from_s, "--to", a.to_s));
  MBK_TRY(before("--from", a.from_s, "--split", a.split_s));
  return before("--split", a.split_s, "--to", a.to_s);
}

}  // namespace

void add_window_options(Command command, WindowArguments& a) {
  command.add_option("--from", a.from_s, "first second that counts, from the start of the recording")
      .type_name("S")
      .check(not_negative())
      .group(kWindow);
  command.add_option("--split", a.split_s, "data before it identify, data after it are held out")
      .type_name("S")
      .check(positive())
      .group(kWindow);
  command.add_option("--to", a.to_s, "last second that counts").type_name("S").check(positive()).group(kWindow);
}

void add_filter_options(Command command, FilterArguments& a) {
  command.add_option("--sg-window", a.sg_window, "Savitzky–Golay window W in samples, odd")
      .type_name("W")
      .check(odd_number(3, 1'000'001))
      .group(kFilters);
  command.add_option("--sg-order", a.sg_order, "Savitzky–Golay order N (6)")
      .type_name("N")
      .check(whole_number(1, 1000))
      .group(kFilters);
  command.add_option("--cutoff", a.cutoff, "zero-phase Butterworth low-pass; otherwise by the excited band")
      .type_name("HZ|none")
      .check([](const std::string& given) -> std::string {
        const bool good = given == "none" || positive().wrong(given).empty();
        return good ? "" : fmt::format("{} is neither a positive number nor 'none'", quoted(given));
      })
      .group(kFilters);
  add_choice(command, "--extension", a.extension,
             "how signals are continued at their ends for the zero-phase filter (odd)")
      .group(kFilters);
  command.add_option("--padding", a.padding, "by how many samples (15)")
      .type_name("N")
      .check(whole_number(0, 1'000'000))
      .group(kFilters);
  command
      .add_option(
          "--every", a.every,
          "the fit takes every so many of the filtered samples; otherwise ten for each period of the cutoff, and "
          "all in reference mode")
      .type_name("N")
      .check(whole_number(1, 1'000'000))
      .group(kFilters);
  command
      .add_option("--resample", a.resample_hz, "put an uneven clock right first, by straight lines; never done unasked")
      .type_name("HZ")
      .check(positive())
      .group(kFilters);
}

void add_protocol_options(Command command, PreprocessArguments& a) {
  add_choice(command, "--mode", a.mode, "reference: the published procedure, sample for sample").group(kWindow);
  add_choice(command, "--procedure", a.procedure,
             "in reference mode: W 101, 5 Hz, ẍ from the position (this one unless said) | W 151, 4.5 Hz, ẍ from "
             "the accelerometer")
      .group(kWindow);
  add_choice_or_auto(command, "--protocol", a.protocol,
                     "how the limb was perturbed; auto looks at the reference and says what it saw")
      .group(kWindow);
  add_window_options(command, a.window);
}

void add_signal_options(Command command, PreprocessArguments& a) {
  add_filter_options(command, a.filters);
  add_choice(command, "--acceleration", a.acceleration, "where ẍ comes from").group(kFilters);

  add_choice(command, "--force-source", a.force_source,
             "virtual: without a force sensor, from motion, motor torques and the robot's dynamics; observer: the same "
             "as it could be had while the robot runs, for comparison")
      .group(kFilters);
  command
      .add_option("--robot", a.robot,
                  "the robot's dynamics, from 'mbk robot identify --json'; without it those of the thesis's robot")
      .type_name("FILE")
      .check(not_empty())
      .group(kFilters);
  command
      .add_option("--force-delay-ms", a.force_delay_ms,
                  "by which the force was read late, as 'mbk sensor delay' finds it: undone first (0)")
      .type_name("MS")
      .check(number_within(kLongestDelayMs))
      .group(kFilters);
  command
      .add_option("--force-rotation-deg", a.force_rotation_deg,
                  "turn the force by this angle from x to y first: for a force sensor mounted at an angle (0)")
      .type_name("DEG")
      .check(number_within(180.0))
      .group(kFilters);
}

Result<preprocess::WindowLimits> window_limits(const WindowArguments& a) {
  MBK_TRY(check_order(a));
  return preprocess::WindowLimits{a.from_s, a.split_s, a.to_s};
}

Result<preprocess::Options> signal_options(const WindowArguments& window, const FilterArguments& filters) {
  const auto limits = MBK_TRY(window_limits(window));
  preprocess::Options p;
  p.window = limits;
  p.smoothing_order = filters.sg_order;
  p.smoothing_window = filters.sg_window;
  p.no_lowpass = filters.cutoff == "none";
  if (!filters.cutoff.empty() && !p.no_lowpass) {
    double hz = 0.0;
    std::from_chars(filters.cutoff.data(), filters.cutoff.data() + filters.cutoff.size(), hz);
    p.cutoff = Hertz(hz);
  }
  p.padding = {filters.extension, filters.padding};
  p.every = filters.every;
  return p;
}

}  // namespace mbk::app
