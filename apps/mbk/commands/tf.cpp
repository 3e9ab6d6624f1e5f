#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/preprocess_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/options/report_file.h"
#include "apps/mbk/terminal/signal_names.h"
#include "apps/mbk/options/threads_option.h"
#include "apps/mbk/options/word_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/measure/analyse/describe_transfer_function.h"
#include "mbk/measure/measurement/identify_transfer_function.h"
#include "mbk/measure/preprocess/resample.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/transfer_function_text.h"
#include "mbk/present/result/transfer_function_json.h"

namespace mbk::app {
namespace {

struct TfArguments {
  ReadingArguments reading;
  WindowArguments window;
  OutputArguments output;
  ReportArguments report;
  std::optional<double> resample_hz;
  TransferFunctionMethod method = TransferFunctionMethod::srivc;
  std::optional<InputHold> hold;
  std::optional<AdmittanceOutput> invert;
  double hac_lag_s = 1.0;
  unsigned threads = 0;
  std::vector<std::filesystem::path> held_out;
  std::string input = "input", output_signal = "output", reference, orders, delay = "0", sample_rate;
  std::filesystem::path charts;
  std::optional<long> poles, zeros;
  std::vector<double> start_poles_hz;
  std::optional<double> max_delay_s;
  long noise_order = 8;
  bool from_rest = false;
};

/// A whole number at the front of `text`, which is shortened by it.
std::optional<Index> take_number(std::string_view& text) {
  Index value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

/// The number that `text` is.
std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "2:5" is every model of 2 to 5 poles with fewer zeros; "4/1,4/2" are these.
Result<std::vector<std::pair<Index, Index>>> orders_of(const std::string& given) {
  constexpr Index kMax = 12;
  std::vector<std::pair<Index, Index>> orders;
  const auto wrong =
      bad_usage(fmt::format("--orders: {} is neither FROM:TO nor POLES/ZEROS,…", quoted(given)),
                fmt::format("as in 2:5 or 4/1,4/2,5/2, with 1 to {} poles and at most as many zeros", kMax));
  std::string_view rest = given;
  for (bool more = true; more;) {
    const auto first = take_number(rest);
    const char mark = rest.empty() ? '\0' : rest.front();
    if (!first || *first < 1 || *first > kMax || (mark != ':' && mark != '/')) return wrong;
    rest.remove_prefix(1);
    const auto second = take_number(rest);
    if (!second || *second < 0) return wrong;
    if (mark == '/') {
      if (*second > *first) return wrong;
      orders.emplace_back(*first, *second);
    } else {
      if (*second < *first || *second > kMax) return wrong;
      for (Index poles = *first; poles <= *second; ++poles) {
        for (Index zeros = 0; zeros < poles; ++zeros) orders.emplace_back(poles, zeros);
      }
    }
    more = !rest.empty();
    if (more && rest.front() != ',') return wrong;
    if (more) rest.remove_prefix(1);
  }
  return orders;
}

Result<measurement::TransferFunctionMeasurement> options_of(const TfArguments& a) {
  measurement::TransferFunctionMeasurement options;
  const auto window = MBK_TRY(window_limits(a.window));
  options.window = window;
  identify::TransferFunctionOptions& fit = options.fit;
  if (!a.orders.empty()) {
    if (a.poles || a.zeros)
      return bad_usage("--orders chooses poles and zeros automatically", "leave --poles and --zeros out");
    auto orders = MBK_TRY(orders_of(a.orders));
    fit.orders = std::move(orders);
  } else if (!a.poles) {
    return bad_usage("--poles is missing", "pass --poles 4 --zeros 3, or --orders 1:4 to try several");
  } else {
    fit.poles = *a.poles;
    fit.zeros = a.zeros.value_or(*a.poles - 1);
    if (fit.zeros > fit.poles) {
      return bad_usage(
          fmt::format("{} zeros beside {} poles: a system that ends has at most as many", fit.zeros, fit.poles),
          "exchange input and output, or take fewer zeros");
    }
  }
  fit.method = a.method;
  if (fit.method == TransferFunctionMethod::closed_loop && a.reference.empty()) {
    return bad_usage("--method clsrivc needs the reference that drives the loop", "name it by --reference");
  }
  fit.find_delay = a.delay == "auto";
  if (!fit.find_delay) {
    const auto delay = number_in(a.delay);
    if (!delay || !(*delay >= 0.0 && *delay < 1e6)) {
      return bad_usage(fmt::format("--delay: {} is neither a number of seconds from 0 on nor 'auto'", quoted(a.delay)));
    }
    fit.delay = *delay;
  }
  if (a.sample_rate == "recorded") {
    options.sample_rate_hz = 0.0;
  } else if (!a.sample_rate.empty()) {
    options.sample_rate_hz = number_in(a.sample_rate);
    if (!options.sample_rate_hz || !(*options.sample_rate_hz > 0.0)) {
      return bad_usage(
          fmt::format("--sample-rate: {} is neither a rate in Hz above 0 nor 'recorded'", quoted(a.sample_rate)));
    }
  }
  options.max_delay = a.max_delay_s;
  fit.hold = a.hold;
  fit.max_noise_order = a.noise_order;
  fit.hac_lag_s = a.hac_lag_s;
  fit.free_start = !a.from_rest;
  fit.threads = a.threads;
  for (const double hz : a.start_poles_hz) fit.start_poles.push_back(2.0 * std::numbers::pi * hz);
  return options;
}

Result<std::vector<Recording>> read_all(const TfArguments& a, const std::vector<std::filesystem::path>& files) {
  ReadingArguments reading = a.reading;
  reading.files = files;
  auto recordings = files.empty() ? Result<std::vector<Recording>>() : read_perturbations(reading);
  if (!recordings) return recordings;
  for (const Recording& recording : *recordings) say_exclusions(recording, false);
  if (!a.resample_hz) return recordings;
  for (Recording& recording : *recordings) {
    recording = MBK_TRY(preprocess::resample(recording, Hertz(*a.resample_hz)));
  }
  return recordings;
}

constexpr std::array kChartNames = {"magnitude", "phase", "nyquist"};

std::filesystem::path chart_file(const TfArguments& arguments, std::size_t chart) {
  return arguments.charts.string() + "_" + kChartNames[chart] + ".svg";
}

/// Every recording that a result is computed from.
std::vector<std::filesystem::path> files_of(const TfArguments& arguments) {
  std::vector<std::filesystem::path> files = arguments.reading.files;
  files.insert(files.end(), arguments.held_out.begin(), arguments.held_out.end());
  return files;
}

/// What can be said of every file that is to be written before the work begins.
Result<void> check_written(const TfArguments& arguments) {
  Output output = arguments.output.to;
  const bool charts_alone = !output.file && !arguments.report.file && !arguments.charts.empty();
  if (charts_alone) output.overwrite = false;
  if (auto ok = check_files(arguments.reading.files, output, arguments.report); !ok || arguments.charts.empty())
    return ok;
  for (std::size_t k = 0; k < kChartNames.size(); ++k) {
    if (auto ok = check_new_file(chart_file(arguments, k), "--charts", arguments.output.to.overwrite,
                                 arguments.reading.files);
        !ok) {
      return ok;
    }
  }
  return {};
}

Result<void> write_charts(const TfArguments& arguments, const std::vector<Chart>& charts) {
  for (std::size_t k = 0; k < charts.size() && !arguments.charts.empty(); ++k) {
    const Output file{chart_file(arguments, k), arguments.output.to.overwrite};
    MBK_TRY(file.write(report::chart_svg(charts[k]), files_of(arguments)));
  }
  return {};
}

int run(const TfArguments& given, const std::string& typed) {
  TfArguments arguments = given;
  if (auto ok = check_written(arguments); !ok) return report_error(ok.error());
  auto options = options_of(arguments);
  if (!options) return report_error(options.error());
  const SignalName signals[] = {{arguments.input, "input", options->input, &options->input_sign},
                                {arguments.output_signal, "output", options->output, &options->output_sign},
                                {arguments.reference, "drive", options->reference, nullptr}};
  if (auto ok = place_signals(arguments.reading, signals); !ok) return report_error(ok.error());
  const auto recordings = read_all(arguments, arguments.reading.files);
  if (!recordings) return report_error(recordings.error());
  const auto held_out = read_all(arguments, arguments.held_out);
  if (!held_out) return report_error(held_out.error());
  auto found = measurement::identify_transfer_function(*recordings, *held_out, *options);
  if (!found) return report_error(found.error());
  found->input = shown_name(given.input);
  found->output = shown_name(given.output_signal);
  found->reference = shown_name(given.reference);
  const auto findings = analyse::describe(*found, given.invert);
  if (!findings) return report_error(findings.error());
  if (arguments.report.file) {
    const std::string report = result::report_json(*found, *findings, typed, arguments.report.note);
    if (auto ok = write_page(arguments.report, arguments.output.to.overwrite, report, files_of(arguments)); !ok)
      return report_error(ok.error());
  }
  if (auto ok = write_charts(arguments, report::response_charts(*found, findings->response)); !ok) {
    return report_error(ok.error());
  }
  std::string text =
      arguments.output.json ? result::to_json(*found, *findings) : report::transfer_function_text(*found);
  if (!arguments.output.json && findings->inverse) text += report::inverted_admittance_text(*findings->inverse);
  if (auto ok = arguments.output.write(text, files_of(arguments)); !ok) return report_error(ok.error());
  return found->usable ? kFine : kNotUsable;
}

}  // namespace

Action add_tf(Command app, const std::string& typed) {
  auto arguments = std::make_shared<TfArguments>();
  const Command command = app.add_command("tf", "a transfer function from one signal to another");
  command.footer(
      "Examples:\n"
      "  mbk tf arm.csv --input torque_Nm --output acceleration --poles 6 --zeros 5\n"
      "  mbk tf log.mat --input Fx --output x --orders 1:4\n"
      "      a table of all models of 1 to 4 poles, and the one that the data support\n"
      "  mbk tf log.csv --input 2 --output 3 --rate 500 --poles 2 --zeros 0 --delay auto --json\n"
      "  mbk tf loop.csv --input motor --output angle --reference wanted --method clsrivc --poles 3\n"
      "  mbk tf arm.csv --input torque --output angle --method bj --poles 2 --zeros 2 --sample-rate 50\n"
      "  mbk tf log.mat --input -Fx --output x --poles 2 --zeros 0 --invert position --report log.html\n"
      "      from the force on the hand to where it moves, and turned round: the impedance with M, B, K\n\n"
      "FILEs are one system: they are fitted together. What did not settle, or settled on an unstable\n"
      "model, is refused.\n\n"
      "Exit codes: " +
      std::string(kExitCodes));
  add_reading_options(command, arguments->reading);
  command
      .add_option("--input", arguments->input,
                  "the cause: a channel, or a column's number or name, a row or a variable of the file (input)")
      .type_name("NAME")
      .check(not_empty());
  command.add_option("--output", arguments->output_signal, "the effect, likewise (output)")
      .type_name("NAME")
      .check(not_empty());
  command.add_option("--reference", arguments->reference, "what drives the loop, likewise, for clsrivc")
      .type_name("NAME")
      .check(not_empty());
  const Option held_out =
      command.add_option("--held-out", arguments->held_out, "recordings that only judge the fit").type_name("FILE");
  command.accept_former_name(held_out, "--held-back");
  add_window_options(command, arguments->window);
  command
      .add_option("--resample", arguments->resample_hz,
                  "put an uneven clock right first, by straight lines; never done unasked, and srivc does without")
      .type_name("HZ")
      .check(positive());
  command
      .add_option("--sample-rate", arguments->sample_rate,
                  "leave samples out, behind a low-pass (oe and bj: down to 50 to 100; the others: recorded)")
      .type_name("HZ|recorded")
      .check(not_empty());
  const char* const model = "Model";
  command.add_option("--poles", arguments->poles, "how many").type_name("N").check(whole_number(1, 20)).group(model);
  command.add_option("--zeros", arguments->zeros, "how many (one fewer than poles)")
      .type_name("N")
      .check(whole_number(0, 20))
      .group(model);
  command
      .add_option("--orders", arguments->orders,
                  "choose among models: 2:5 for 2 to 5 poles with fewer zeros, or a list POLES/ZEROS")
      .type_name("FROM:TO|LIST")
      .check(not_empty())
      .group(model);
  add_choice(command, "--invert", arguments->invert,
             "also the inverse: the input is the force on what moves, the output that motion of it; gives the "
             "impedance")
      .group(model);
  add_choice(command, "--method", arguments->method,
             "srivc: refined instrumental variables in continuous time; rivc: with a model of the noise; "
             "clsrivc: in a loop, with instruments from the reference; oe: output error in discrete time; "
             "bj: Box-Jenkins, with a model of the noise")
      .group(model);
  add_choice_or_auto(command, "--hold", arguments->hold,
                     "the input between its samples, for continuous time: zero keeps each value, first moves in "
                     "straight lines; auto sees it in the input's steps (auto)")
      .group(model);
  command.add_option("--delay", arguments->delay, "seconds by which the effect lags; auto finds it (0)")
      .type_name("S|auto")
      .check(not_empty())
      .group(model);
  const Option max_delay =
      command
          .add_option("--max-delay", arguments->max_delay_s,
                      "how far --delay auto looks, s (0.5, and no more than a tenth of the shortest recording)")
          .type_name("S")
          .check(positive())
          .group(model);
  command.accept_former_name(max_delay, "--most-delay");
  command
      .add_option("--start-pole", arguments->start_poles_hz,
                  "a frequency at which the search begins, tried beside six over the band")
      .type_name("HZ")
      .check(positive())
      .expected(1)
      .take_all()
      .group(model);
  command
      .add_flag("--from-rest", arguments->from_rest,
                "the system is at rest at zero where a segment begins; otherwise an initial state and an offset are "
                "found for each")
      .group(model);
  command.add_option("--noise-order", arguments->noise_order, "greatest order of the noise model of rivc and bj (8)")
      .type_name("N")
      .check(whole_number(1, 50))
      .group(model);
  command
      .add_option("--hac-lag", arguments->hac_lag_s,
                  "reach of the residual's correlation in the standard errors; 0 takes it as white (1)")
      .type_name("S")
      .check(not_negative())
      .group(model);
  add_threads_option(command, arguments->threads, "starts tried").group(model);
  add_output_options(command, arguments->output, "mbk.tf/1");
  add_report_options(command, arguments->report);
  command.add_option("--charts", arguments->charts, "also write charts: PREFIX_magnitude.svg, _phase.svg, _nyquist.svg")
      .type_name("PREFIX")
      .check(not_empty());
  command.get_option("--overwrite")
      .description("replace the files of --out, --report and --charts where they are there");
  return [arguments, typed] { return run(*arguments, typed); };
}

}  // namespace mbk::app
