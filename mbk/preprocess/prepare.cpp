#include "mbk/preprocess/prepare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mbk/dsp/butterworth.h"
#include "mbk/dsp/savitzky_golay.h"
#include "mbk/preprocess/band.h"
#include "mbk/preprocess/clock.h"

namespace mbk::preprocess {
namespace {

constexpr int kButterworthOrder = 5;
/// Forward and backward, the filter passes 0.6 of its cutoff with a gain of 0.994.
constexpr double kCutoffOverBand = 1.0 / 0.6;
/// The smoothing filter's own −3 dB lies this far above the cutoff: (6, 101) at 1 kHz for 5 Hz.
constexpr double kSmoothingOverCutoff = 4.6;

/// The channels that a fit needs, side by side, as recorded.
struct Signals {
  Matrix position, force, reference, acceleration;  ///< N×n; the last two may be empty
};

std::array<const char*, 2> names(std::string_view what, int axes) {
  if (axes == 1) {
    if (what == "position") return {"position", nullptr};
    if (what == "force") return {"reaction", nullptr};
    if (what == "reference") return {"reference", nullptr};
    return {"acceleration", nullptr};
  }
  if (what == "position") return {"hand_x", "hand_y"};
  if (what == "force") return {"force_x", "force_y"};
  if (what == "reference") return {"reference_x", "reference_y"};
  return {"acceleration_x", "acceleration_y"};
}

/// The columns of one quantity, or nothing where any of them is missing.
Matrix gather(const Recording& recording, std::string_view what, int axes) {
  Matrix columns(recording.samples(), axes);
  for (int axis = 0; axis < axes; ++axis) {
    const Channel* channel = recording.find(names(what, axes)[static_cast<std::size_t>(axis)]);
    if (channel == nullptr) return {};
    columns.col(axis) = channel->values;
  }
  return columns;
}

Result<Matrix> require(const Recording& recording, std::string_view what, int axes) {
  Matrix columns = gather(recording, what, axes);
  if (columns.size() > 0) return columns;
  std::string missing, present, first;
  for (int axis = 0; axis < axes; ++axis) {
    const char* name = names(what, axes)[static_cast<std::size_t>(axis)];
    if (recording.find(name) != nullptr) continue;
    missing += fmt::format("{}'{}'", missing.empty() ? "" : " and ", name);
    if (first.empty()) first = name;
  }
  for (const Channel& channel : recording.channels) present += (present.empty() ? "" : ", ") + channel.name;
  return bad_data(fmt::format("channel {} is missing (there are: {})", missing, present.empty() ? "none" : present),
                  fmt::format("say where it is: --channels {}=COLUMN", first));
}

Result<Signals> select_signals(const Recording& recording, int axes, bool acceleration_from_sensor) {
  Signals signals;
  for (const auto& [what, target] : {std::pair{"position", &signals.position}, std::pair{"force", &signals.force}}) {
    auto columns = require(recording, what, axes);
    if (!columns) return tl::unexpected(columns.error());
    *target = std::move(*columns);
  }
  if (acceleration_from_sensor) {
    auto columns = require(recording, "acceleration", axes);
    if (!columns) return tl::unexpected(columns.error());
    signals.acceleration = std::move(*columns);
  }
  signals.reference = gather(recording, "reference", axes);
  return signals;
}

/// Time inside the cuts must be even enough to be called even.
Result<void> check_clock(const Clock& clock, double median, const WindowPlan& plan, std::vector<Warning>& warnings) {
  double sum = 0.0, largest = 0.0;
  Index count = 0;
  for (const Cut& cut : plan.cuts) {
    for (Index i = cut.begin + 1; i < cut.end; ++i, ++count) {
      const double interval = clock.seconds(i) - clock.seconds(i - 1);
      const auto at = [&] { return fmt::format("at sample {} ({:.6f} s)", i + 1, clock.seconds(i)); };
      if (!(interval > 0.0)) {
        return bad_data(
            interval == 0.0 ? fmt::format("time repeats {}", at()) : fmt::format("time runs backwards {}", at()),
            "choose a window without it with --from and --to");
      }
      if (interval > 1.5 * median) {
        return bad_data(
            fmt::format("a gap of {:.4g} s in time {}, where samples are {:.4g} s apart", interval, at(), median),
            "choose a window without it with --from and --to, or put the samples on an even clock with "
            "--resample HZ");
      }
      sum += (interval - median) * (interval - median);
      largest = std::max(largest, std::abs(interval - median));
    }
  }
  const double jitter = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
  if (jitter > 0.01 * median) {
    warnings.push_back({WarningCode::clock_jitter,
                        fmt::format("the clock jitters by {:.2g} ms (standard deviation; at most {:.2g} ms) around "
                                    "{:.4g} ms, and the samples are taken as even",
                                    1e3 * jitter, 1e3 * largest, 1e3 * median),
                        "compare with --resample HZ; record with a steadier clock"});
  }
  return {};
}

/// The windows are read off the reference, so that it must be there throughout.
Result<void> check_reference(const Clock& clock, const Matrix& reference, const WindowLimits& limits, int axes) {
  for (Index axis = 0; axis < reference.cols(); ++axis) {
    for (Index i = 0; i < reference.rows(); ++i) {
      const double at = clock.seconds(i);
      const bool outside = (limits.from_s && at < *limits.from_s) || (limits.to_s && at >= *limits.to_s);
      if (outside || std::isfinite(reference(i, axis))) continue;
      return bad_data(fmt::format("channel '{}' is not a number at sample {} ({:.6f} s)",
                                  names("reference", axes)[static_cast<std::size_t>(axis)], i + 1, at),
                      "choose a window without it with --from and --to, or use --protocol free");
    }
  }
  return {};
}

/// Settings that no filter can have are refused before anything is sized by them.
Result<void> check_choices(const Options& options) {
  constexpr int kLongestWindow = 1000000;
  if (options.axes < 0 || options.axes > 2) return bad_usage(fmt::format("{} axes: 1 or 2 are possible", options.axes));
  if (options.smoothing_window && (*options.smoothing_window < 1 || *options.smoothing_window > kLongestWindow)) {
    return bad_usage(
        fmt::format("a Savitzky–Golay window of {} samples is not in 1…{}", *options.smoothing_window, kLongestWindow));
  }
  if (options.smoothing_order && (*options.smoothing_order < 0 || *options.smoothing_order > kLongestWindow)) {
    return bad_usage(
        fmt::format("a Savitzky–Golay order of {} is not in 0…{}", *options.smoothing_order, kLongestWindow));
  }
  if (options.cutoff && !(options.cutoff->value > 0.0 && std::isfinite(options.cutoff->value))) {
    return bad_usage(fmt::format("a cutoff of {:g} Hz is not above 0", options.cutoff->value));
  }
  if (options.padding.samples < 0) return bad_usage(fmt::format("a padding of {} samples", options.padding.samples));
  return {};
}

Result<void> check_finite(const Clock& clock, const Signals& signals, const WindowPlan& plan, int axes) {
  const std::array<std::pair<const char*, const Matrix*>, 3> quantities = {
      {{"position", &signals.position}, {"force", &signals.force}, {"acceleration", &signals.acceleration}}};
  for (const auto& [what, columns] : quantities) {
    for (Index axis = 0; axis < columns->cols(); ++axis) {
      for (const Cut& cut : plan.cuts) {
        const Index bad = first_non_finite(columns->col(axis).segment(cut.begin, cut.end - cut.begin));
        if (bad < 0) continue;
        const Index sample = cut.begin + bad;
        return bad_data(
            fmt::format("channel '{}' is not a number at sample {} ({:.6f} s)",
                        names(what, axes)[static_cast<std::size_t>(axis)], sample + 1, clock.seconds(sample)),
            "choose a window without it with --from and --to, or mend the recording");
      }
    }
  }
  return {};
}

/// The position must move well beyond the steps in which it is recorded.
void warn_of_small_motion(const Signals& signals, const WindowPlan& plan, std::vector<Warning>& warnings) {
  constexpr double kStepsEnough = 20.0;  // standard deviations of the motion in steps: the rounding is then 1.4 % of it
  double step = std::numeric_limits<double>::infinity(), motion = 0.0;
  for (const Cut& cut : plan.cuts) {
    const Matrix piece = signals.position.middleRows(cut.begin, cut.end - cut.begin);
    const Matrix centred = piece.rowwise() - piece.colwise().mean();
    motion = std::max(motion, std::sqrt(centred.cwiseAbs2().colwise().mean().maxCoeff()));
    const Matrix changes = (piece.bottomRows(piece.rows() - 1) - piece.topRows(piece.rows() - 1)).cwiseAbs();
    for (const double change : changes.reshaped()) {
      if (change > 0.0) step = std::min(step, change);
    }
  }
  if (motion < kStepsEnough * step) {
    warnings.push_back({WarningCode::motion_too_small,
                        std::isinf(step) ? std::string("the position does not move")
                                         : fmt::format("the position moves by {:.2g} (standard deviation) and is "
                                                       "recorded in steps of {:.2g}",
                                                       motion, step),
                        "perturb more, and check that the position channel and its unit are the right ones"});
  }
}

/// A force that never changes is a sensor that did not measure; a position that never changes shows no motion.
Result<void> check_alive(const Signals& signals, const WindowPlan& plan, int axes) {
  const auto constant = [&](const Matrix& columns, Index axis) {
    const double value = columns(plan.cuts.front().begin, axis);
    return std::ranges::all_of(plan.cuts, [&](const Cut& cut) {
      return (columns.col(axis).segment(cut.begin, cut.end - cut.begin).array() == value).all();
    });
  };
  const auto refusal = [&](const char* what, const Matrix& columns, Index axis, const char* remedy) {
    return bad_data(
        fmt::format("channel '{}' is {:g} throughout the window", names(what, axes)[static_cast<std::size_t>(axis)],
                    columns(plan.cuts.front().begin, axis)),
        remedy);
  };
  Index resting = 0;
  for (Index axis = 0; axis < axes; ++axis) {
    if (constant(signals.force, axis)) {
      return refusal("force", signals.force, axis, "check that the sensor was on, or name its channel with --channels");
    }
    resting += constant(signals.position, axis) ? 1 : 0;
  }
  if (resting < axes) return {};
  return refusal("position", signals.position, 0, "choose a window in which the limb moves, with --from and --to");
}

/// Filter settings and the words that say where they come from.
struct FilterPlan {
  dsp::SavitzkyGolay smoothing;
  std::optional<Hertz> cutoff;
  std::string rule;
};

FilterPlan reference_filters(const Options& options) {
  const bool chapter5 = options.procedure == Procedure::chapter5;
  const bool changed = options.smoothing_order || options.smoothing_window || options.acceleration;
  return {{6, chapter5 ? 151 : 101},
          Hertz(chapter5 ? 4.5 : 5.0),
          fmt::format("{} of the published procedure{}", text(options.procedure), changed ? ", changed as asked" : "")};
}

FilterPlan improved_filters(const Options& options, const Band& band, Hertz rate, Index shortest_cut) {
  FilterPlan plan;
  const double wanted = options.cutoff.value_or(Hertz(band.high.value * kCutoffOverBand)).value;
  const double cutoff = std::min(wanted, 0.4 * rate.value);
  plan.cutoff = Hertz(cutoff);
  plan.rule = fmt::format("{:.3g} Hz, the top of the excited band, over 0.6", band.high.value);
  if (cutoff < wanted) plan.rule += ", limited to 0.4 of the sample rate";
  const int order = options.smoothing_order.value_or(6);
  plan.smoothing.order = order;
  plan.smoothing.window =
      dsp::savitzky_golay_window(order, Hertz(std::min(kSmoothingOverCutoff * cutoff, 0.4 * rate.value)), rate);
  // A short pulse must keep most of its samples.
  const Index longest = std::max<Index>(shortest_cut / 4, order + 3) | 1;
  plan.smoothing.window = static_cast<int>(std::min<Index>(plan.smoothing.window, longest));
  return plan;
}

void apply_choices(const Options& options, FilterPlan& plan) {
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
}

/// One cut through both filters: [x ẋ ẍ F], each n columns; row i belongs to sample cut.begin + half window + trim + i.
Result<Matrix> filter_cut(const Signals& signals, const Cut& cut, const FilterPlan& filters, Index trim, Hertz rate,
                          const dsp::Padding& padding) {
  const Index n = signals.position.cols(), length = cut.end - cut.begin;
  if (length < filters.smoothing.window + 2 * trim + (filters.cutoff ? padding.samples + 1 : 0)) {
    return bad_data(fmt::format("a window of {} samples is too short for a Savitzky–Golay window of {}{}", length,
                                filters.smoothing.window,
                                filters.cutoff ? fmt::format(" and a padding of {}", padding.samples) : ""),
                    "record longer, or choose a smaller --sg-window or --padding");
  }
  const auto smooth = [&](const Matrix& columns, int derivative) {
    return dsp::savitzky_golay(filters.smoothing, derivative, columns.middleRows(cut.begin, length), rate);
  };
  const bool sensor = signals.acceleration.size() > 0;
  Matrix all(length - filters.smoothing.window + 1 - 2 * trim, 4 * n);
  const std::array<Result<Matrix>, 4> parts = {smooth(signals.position, 0), smooth(signals.position, 1),
                                               sensor ? smooth(signals.acceleration, 0) : smooth(signals.position, 2),
                                               smooth(signals.force, 0)};
  for (Index k = 0; k < 4; ++k) {
    const Result<Matrix>& part = parts[static_cast<std::size_t>(k)];
    if (!part) return tl::unexpected(part.error());
    all.middleCols(k * n, n) = part->middleRows(trim, all.rows());
  }
  if (!filters.cutoff) return all;
  auto lowpass = dsp::butterworth_lowpass(kButterworthOrder, *filters.cutoff, rate);
  if (!lowpass) return tl::unexpected(lowpass.error());
  return dsp::filter_zero_phase(*lowpass, all, padding);
}

/// What moves, by the units of position and force; where one is unknown the other decides.
Result<Motion> motion_of(const Recording& recording, int axes) {
  if (axes == 2) return Motion::translation;
  const std::string &position = recording.find("position")->unit, &reaction = recording.find("reaction")->unit;
  const bool rotates = position == "rad" || reaction == "N.m", shifts = position == "m" || reaction == "N";
  if (rotates && shifts) {
    return bad_data(fmt::format("position in {} and reaction in {} do not belong together", position, reaction),
                    "correct the units in --channels, as in x=2:deg,F=3:N.m");
  }
  return rotates ? Motion::rotation : (shifts ? Motion::translation : Motion::unknown);
}

int axes_of(const Recording& recording, int wanted) {
  if (wanted != 0) return wanted;
  return recording.find("position") != nullptr || recording.find("reaction") != nullptr ? 1 : 2;
}

}  // namespace

Result<PreparedTrial> prepare(const Recording& recording, const Inspection& inspection, const Options& options) {
  if (auto ok = check_choices(options); !ok) return tl::unexpected(ok.error());
  const bool published = options.mode == Mode::reference;
  const Index samples = recording.samples();
  constexpr Index kFewest = 20;  // about three for each parameter of one axis
  if (samples < kFewest || !(inspection.rate_hz > 0.0)) {
    return bad_data(fmt::format("{} sample{} cannot show a motion", samples, samples == 1 ? "" : "s"), "record longer");
  }
  const Hertz rate(inspection.rate_hz);
  const Clock clock(recording.time, rate);

  PreparedTrial trial;
  trial.axes = axes_of(recording, options.axes);
  trial.sources = recording.sources;
  trial.notes = recording.notes;
  trial.recording_duration = inspection.duration + inspection.interval_median;
  Preparation& how = trial.preparation;
  how.mode = options.mode;
  how.procedure = options.procedure;
  how.cut_before_filter = !published;
  how.acceleration_from_sensor =
      options.acceleration.value_or(published && options.procedure == Procedure::chapter5
                                        ? AccelerationSource::sensor
                                        : AccelerationSource::derivative) == AccelerationSource::sensor;

  const auto signals = select_signals(recording, trial.axes, how.acceleration_from_sensor);
  if (!signals) return tl::unexpected(signals.error());

  const auto motion = motion_of(recording, trial.axes);
  if (!motion) return tl::unexpected(motion.error());
  trial.motion = *motion;

  const ProtocolFinding found = detect_protocol(signals->reference);
  how.protocol = options.protocol.value_or(found.protocol);
  how.protocol_rule = options.protocol ? "given" : found.rule;
  if (how.protocol != Protocol::free && signals->reference.size() == 0) {
    return bad_data(fmt::format("protocol '{}' needs the reference, channel '{}', which is missing", text(how.protocol),
                                names("reference", trial.axes)[0]),
                    "name it with --channels, or use --protocol free");
  }

  if (how.protocol != Protocol::free) {
    auto ok = check_reference(clock, signals->reference, options.window, trial.axes);
    if (!ok) return tl::unexpected(ok.error());
  }

  FilterPlan filters = reference_filters(options);
  apply_choices(options, filters);
  auto plan = published ? reference_windows(how.protocol, signals->reference, clock, options.window,
                                            filters.smoothing.half_window())
                        : improved_windows(how.protocol, signals->reference, clock, options.window);
  if (!plan) return tl::unexpected(plan.error());
  if (auto ok = check_clock(clock, inspection.interval_median, *plan, trial.warnings); !ok)
    return tl::unexpected(ok.error());
  if (auto ok = check_finite(clock, *signals, *plan, trial.axes); !ok) return tl::unexpected(ok.error());

  warn_of_small_motion(*signals, *plan, trial.warnings);

  if (auto ok = check_alive(*signals, *plan, trial.axes); !ok) return tl::unexpected(ok.error());

  const bool by_reference = how.protocol == Protocol::sinusoidal;
  const auto band = excited_band(by_reference ? signals->reference : signals->position, plan->cuts, rate);
  if (!band) return tl::unexpected(band.error());
  if (!published) {
    Index shortest = samples;
    for (const Cut& cut : plan->cuts) shortest = std::min(shortest, cut.end - cut.begin);
    filters = improved_filters(options, *band, rate, shortest);
    apply_choices(options, filters);
  }

  Index total = 0;
  std::vector<Matrix> filtered;
  for (const Cut& cut : plan->cuts) {
    auto piece = filter_cut(*signals, cut, filters, plan->trim, rate, options.padding);
    if (!piece) return tl::unexpected(piece.error());
    total += piece->rows();
    filtered.push_back(std::move(*piece));
  }

  const Index n = trial.axes, lost = filters.smoothing.half_window() + plan->trim;
  trial.sample_time = 1.0 / rate.value;
  trial.time.resize(total);
  for (Matrix* signal : {&trial.position, &trial.velocity, &trial.acceleration, &trial.force_hand_on_robot}) {
    signal->resize(total, n);
  }
  if (signals->reference.size() > 0) trial.reference.resize(total, n);
  Index row = 0;
  for (std::size_t k = 0; k < filtered.size(); ++k) {
    const Cut& cut = plan->cuts[k];
    const Matrix& piece = filtered[k];
    const Index rows = piece.rows(), first = cut.begin + lost;
    trial.time.segment(row, rows) = recording.time.segment(first, rows).array() - recording.time[0];
    trial.position.middleRows(row, rows) = piece.leftCols(n);
    trial.velocity.middleRows(row, rows) = piece.middleCols(n, n);
    trial.acceleration.middleRows(row, rows) = piece.middleCols(2 * n, n);
    trial.force_hand_on_robot.middleRows(row, rows) = piece.rightCols(n);
    if (trial.reference.size() > 0) trial.reference.middleRows(row, rows) = signals->reference.middleRows(first, rows);
    for (const Stretch& keep : cut.keep) {
      const Index begin = std::max(keep.begin, first), end = std::min(keep.end, first + rows);
      if (begin < end) trial.stretches.push_back({begin - first + row, end - first + row, keep.purpose});
    }
    row += rows;
  }
  if (trial.stretches.empty()) return bad_data("no sample is left after filtering", "record longer");

  how.window_rule = plan->rule;
  how.from_s = trial.time[trial.stretches.front().begin];
  how.to_s = trial.time[trial.stretches.back().end - 1];
  how.split_s = plan->split_s;
  how.perturbations = static_cast<int>(how.protocol == Protocol::underdamped ? trial.stretches.size() : 1);
  how.smoothing_order = filters.smoothing.order;
  how.smoothing_window = filters.smoothing.window;
  how.cutoff = filters.cutoff;
  how.cutoff_rule = filters.rule;
  how.band_low = band->low;
  how.band_high = band->high;
  return trial;
}

}  // namespace mbk::preprocess
