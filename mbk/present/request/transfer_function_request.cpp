#include "mbk/present/request/transfer_function_request.h"

#include <fmt/format.h>

#include <charconv>
#include <numbers>
#include <string_view>
#include <utility>

#include "mbk/present/request/number_of.h"
#include "mbk/present/request/signal_names.h"
#include "mbk/present/request/stage_tables.h"

namespace mbk::request {
namespace {

/// A whole number at the front of `text`, which is shortened by it.
std::optional<Index> take_number(std::string_view& text) {
  Index value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

/// "2:5" is every model of 2 to 5 poles with fewer zeros; "4/1,4/2" are these.
Result<std::vector<std::pair<Index, Index>>> orders_of(const std::string& given) {
  constexpr Index kMax = 12;
  std::vector<std::pair<Index, Index>> orders;
  const auto wrong =
      bad_usage(fmt::format("--orders {} is neither FROM:TO nor a list of POLES/ZEROS", quoted(given)),
                fmt::format("write it as 2:5 or 4/1,4/2,5/2, with 1 to {} poles and no more zeros than poles", kMax));
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

/// Poles and zeros, or the orders to choose from.
Result<void> set_orders(const TransferFunctionRequest& request, identify::TransferFunctionOptions& fit) {
  if (!request.orders.empty()) {
    if (request.poles || request.zeros)
      return bad_usage("--orders chooses the numbers of poles and zeros automatically", "omit --poles and --zeros");
    fit.orders = MBK_TRY(orders_of(request.orders));
    return {};
  }
  if (!request.poles) {
    return bad_usage("--poles is missing", "pass --poles 4 --zeros 3, or --orders 1:4 to try several");
  }
  fit.poles = *request.poles;
  fit.zeros = request.zeros.value_or(*request.poles - 1);
  if (fit.zeros > fit.poles) {
    return bad_usage(fmt::format("a model with {} zero{} and {} pole{} is improper", fit.zeros,
                                 fit.zeros == 1 ? "" : "s", fit.poles, fit.poles == 1 ? "" : "s"),
                     "exchange input and output, or use fewer zeros");
  }
  return {};
}

}  // namespace

const OptionTable<TransferFunctionRequest>& transfer_function_signal_table() {
  static const auto kTable = [] {
    OptionTable<TransferFunctionRequest> table;
    table
        .add({"--input", "NAME",
              "input signal: a channel, the number or name of a column, a row or a variable of the file (default: "
              "input)",
              not_empty()},
             &TransferFunctionRequest::input)
        .add({"--output", "NAME", "output signal, named likewise (default: output)", not_empty()},
             &TransferFunctionRequest::output)
        .add({"--reference", "NAME", "signal that drives the closed loop, named likewise, for --method clsrivc",
              not_empty()},
             &TransferFunctionRequest::reference);
    return table;
  }();
  return kTable;
}

const OptionTable<TransferFunctionRequest>& transfer_function_clock_table() {
  static const auto kTable = [] {
    OptionTable<TransferFunctionRequest> table;
    OptionFacts resample = resample_option();
    resample.help += "; srivc needs no even sampling";
    table
        .include(
            window_table(), [](auto& request) -> auto& { return request.options.window; })
        .add(resample, &TransferFunctionRequest::resample)
        .add({"--sample-rate", "HZ|recorded",
              "decimate to this rate, in Hz, after a low-pass filter (default: 50 to 100 Hz for oe and bj, "
              "otherwise the recorded rate)",
              not_empty()},
             &TransferFunctionRequest::sample_rate);
    return table;
  }();
  return kTable;
}

const OptionTable<TransferFunctionRequest>& transfer_function_model_table() {
  using Request = TransferFunctionRequest;
  static const auto kTable = [] {
    OptionTable<Request> table;
    table.group("Model")
        .add({"--poles", "N", "number of poles", whole_number(1, 20)}, &Request::poles)
        .add({"--zeros", "N", "number of zeros (default: one fewer than poles)", whole_number(0, 20)}, &Request::zeros)
        .add({"--orders", "FROM:TO|LIST",
              "fit several models and select one: 2:5 for 2 to 5 poles with fewer zeros each, or a list of POLES/ZEROS",
              not_empty()},
             &Request::orders)
        .add({"--invert", "",
              "also invert the model to an impedance: the input is the force on the moving body, the output this "
              "quantity of "
              "its motion"},
             &Request::invert)
        .add(
            {"--method", "",
             "srivc: refined instrumental variables in continuous time; rivc: the same with a noise model; clsrivc: "
             "for a "
             "closed loop, with instruments from the reference; oe: output error in discrete time; bj: Box-Jenkins, in "
             "discrete time with a noise model (default: srivc)"},
            [](auto& request) -> auto& { return request.options.fit.method; })
        .add(
            {"--hold", std::string(option_values::kAuto),
             "behaviour of the input between samples, for continuous time. zero: constant; first: linear; auto: "
             "decided from "
             "the steps of the input (default: auto)"},
            [](auto& request) -> auto& { return request.options.fit.hold; })
        .add({"--delay", "S|auto", "delay from input to output, in seconds; auto estimates it (default: 0)",
              not_empty()},
             &Request::delay)
        .add(
            {"--max-delay", "S",
             "longest delay that --delay auto tries, in seconds (default: 0.5, at most a tenth of the shortest "
             "recording)",
             positive()},
            [](auto& request) -> auto& { return request.options.max_delay; })
        .add_row(
            {{"--from-rest", "",
              "the system is at rest at zero at the start of each segment (default: an initial state and an offset are "
              "estimated for each segment)"},
             [](Request& request, const auto& /*flag*/) { request.options.fit.free_start = false; },
             [](const Request& request) { return request.options.fit.free_start; }})
        .add(
            {"--noise-order", "N", "maximum order of the noise model of rivc and bj (default: 8)", whole_number(1, 50)},
            [](auto& request) -> auto& { return request.options.fit.max_noise_order; })
        .add(
            {"--hac-lag", "S",
             "correlation time of the residual, in seconds, that the standard errors allow for; 0: white (default: 1)",
             not_negative()},
            [](auto& request) -> auto& { return request.options.fit.hac_lag_s; });
    return table;
  }();
  return kTable;
}

Result<measurement::TransferFunctionMeasurement> transfer_function_options(TransferFunctionRequest& request) {
  measurement::TransferFunctionMeasurement options = request.options;
  MBK_TRY(check_order(options.window));
  identify::TransferFunctionOptions& fit = options.fit;
  MBK_TRY(set_orders(request, fit));
  if (fit.method == TransferFunctionMethod::closed_loop && request.reference.empty()) {
    return bad_usage("--method clsrivc needs the reference that drives the loop", "name it with --reference");
  }
  fit.find_delay = request.delay == "auto";
  if (!fit.find_delay) {
    const auto delay = number_of(request.delay);
    if (!delay || !(*delay >= 0.0 && *delay < 1e6)) {
      return bad_usage(
          fmt::format("--delay {} is neither 'auto' nor a non-negative number of seconds", mbk::quoted(request.delay)));
    }
    fit.delay = *delay;
  }
  if (request.sample_rate == "recorded") {
    options.sample_rate_hz = 0.0;
  } else if (!request.sample_rate.empty()) {
    options.sample_rate_hz = number_of(request.sample_rate);
    if (!options.sample_rate_hz || !(*options.sample_rate_hz > 0.0)) {
      return bad_usage(fmt::format("--sample-rate {} is neither 'recorded' nor a positive rate in Hz",
                                   mbk::quoted(request.sample_rate)));
    }
  }
  for (const double hz : request.start_poles_hz) fit.start_poles.push_back(2.0 * std::numbers::pi * hz);
  const SignalName signals[] = {{request.input, "input", options.input, &options.input_sign},
                                {request.output, "output", options.output, &options.output_sign},
                                {request.reference, "drive", options.reference, nullptr}};
  MBK_TRY(place_signals(request.reading, signals));
  return options;
}

}  // namespace mbk::request
