#include "mbk/measure/preprocess/filters.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/filter_chain.h"
#include "mbk/model/trial/filtered_band.h"

namespace mbk::preprocess {
namespace {

/// The smoothing filter's own −3 dB lies this far above the cutoff: (6, 101) at 1 kHz for 5 Hz.
constexpr double kSmoothingOverCutoff = 4.6;

FilterPlan with_choices(FilterPlan plan, const Options& options) {
  if (options.smoothing_order) plan.smoothing.order = *options.smoothing_order;
  if (options.smoothing_window) plan.smoothing.window = *options.smoothing_window;
  if (options.cutoff) {
    plan.cutoff = options.cutoff;
    plan.rule = "given";
  }
  if (options.no_lowpass) {
    plan.cutoff.reset();
    plan.rule = "none, as asked";
  }
  if (options.every) plan.every = *options.every;
  return plan;
}

Result<dsp::FilterChain> chain_of(const FilterPlan& filters, const dsp::Padding& padding, Hertz rate) {
  dsp::FilterChain chain{filters.smoothing, {}, padding};
  if (filters.cutoff) {
    auto lowpass = MBK_TRY(dsp::butterworth_lowpass(kLowpassOrder, *filters.cutoff, rate));
    chain.lowpass = std::move(lowpass);
  }
  return chain;
}

}  // namespace

FilterPlan reference_filters(const Options& options) {
  const Procedure procedure = options.procedure.value_or(Procedure::chapter3);
  const bool chapter5 = procedure == Procedure::chapter5;
  const bool changed = options.smoothing_order || options.smoothing_window || options.acceleration;
  return with_choices(
      {{6, chapter5 ? 151 : 101},
       Hertz(chapter5 ? 4.5 : 5.0),
       fmt::format("{} of the published procedure{}", word_of(procedure), changed ? ", modified as requested" : "")},
      options);
}

FilterPlan improved_filters(const Options& options, const Band& band, Hertz rate, Index shortest_cut) {
  FilterPlan plan;
  const double asked = options.cutoff.value_or(Hertz(band.high.value / kPassed)).value;
  const double cutoff = std::min(asked, 0.4 * rate.value);
  plan.cutoff = Hertz(cutoff);
  plan.rule = fmt::format("{:.3g} Hz, the upper end of the excited band, divided by 0.6", band.high.value);
  if (cutoff < asked) plan.rule += ", limited to 0.4 of the sample rate";
  const int order = options.smoothing_order.value_or(6);
  plan.smoothing.order = order;
  plan.smoothing.window =
      dsp::savitzky_golay_window(order, Hertz(std::min(kSmoothingOverCutoff * cutoff, 0.4 * rate.value)), rate);
  // A short pulse must keep most of its samples.
  const Index longest = std::max<Index>(shortest_cut / 4, order + 3) | 1;
  plan.smoothing.window = static_cast<int>(std::min<Index>(plan.smoothing.window, longest));
  if (!options.no_lowpass) plan.every = enough_of(rate, Hertz(cutoff), shortest_cut);
  return with_choices(std::move(plan), options);
}

Result<Index> filtered_rows(const Cut& cut, const FilterPlan& filters, Index trim, const dsp::Padding& padding) {
  const Index length = cut.end - cut.begin;
  if (length < filters.smoothing.window + 2 * trim + (filters.cutoff ? padding.samples + 1 : 0)) {
    return bad_data(fmt::format("a window of {} samples is too short for a Savitzky–Golay window of {}{}", length,
                                filters.smoothing.window,
                                filters.cutoff ? fmt::format(" and a padding of {}", padding.samples) : ""),
                    "record longer, or choose a smaller --sg-window or --padding");
  }
  return dsp::rows_left({filters.smoothing, {}, padding}, length - 2 * trim, filters.every);
}

Result<void> filter_cut(const Signals& signals, const Cut& cut, const FilterPlan& filters, Index trim, Hertz rate,
                        const dsp::Padding& padding, bool with_reference, std::span<double* const> to) {
  MBK_TRY(filtered_rows(cut, filters, trim, padding));
  const Index n = signals.position.cols(), length = cut.end - cut.begin;
  const auto chain = MBK_TRY(chain_of(filters, padding, rate));
  std::vector<dsp::Column> columns;
  std::vector<const Columns*> quantities = {&signals.position, &signals.force_hand_on_robot, &signals.acceleration};
  if (with_reference) quantities.push_back(&signals.reference);
  quantities.push_back(&signals.force_sensitivity);
  for (const Columns* quantity : quantities) {
    for (Index k = 0; k < quantity->cols(); ++k) {
      columns.emplace_back(quantity->col(k).data() + cut.begin + trim, length - 2 * trim);
    }
  }
  std::vector<dsp::FilterOutput> outputs;
  const auto want = [&](Index first, int derivative) {
    for (Index k = 0; k < n; ++k) outputs.push_back({first + k, derivative});
  };
  want(0, 0);
  want(0, 1);
  if (signals.acceleration.size() > 0) {
    want(2 * n, 0);
  } else {
    want(0, 2);
  }
  want(n, 0);
  if (with_reference) {
    for (const int derivative : {2, 1, 0}) want(2 * n + signals.acceleration.cols(), derivative);
  }
  const Index computed = signals.force_sensitivity.cols();
  for (Index k = 0; k < computed; ++k) outputs.push_back({static_cast<Index>(columns.size()) - computed + k, 0});
  return dsp::smooth_then_lowpass(chain, columns, outputs, rate, filters.every, to);
}

Result<Matrix> filter_values(const Matrix& signals, const FilterPlan& filters, Hertz rate,
                             const dsp::Padding& padding) {
  const auto chain = MBK_TRY(chain_of(filters, padding, rate));
  std::vector<dsp::Column> columns;
  std::vector<dsp::FilterOutput> outputs;
  for (Index k = 0; k < signals.cols(); ++k) {
    columns.emplace_back(signals.col(k).data(), signals.rows());
    outputs.push_back({k, 0});
  }
  return dsp::smooth_then_lowpass(chain, columns, outputs, rate);
}

}  // namespace mbk::preprocess
