#include "mbk/measure/preprocess/recording_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "mbk/base/numeric/statistics.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {

Result<void> check_choices(const Options& options) {
  constexpr int kLongestWindow = 1000000;
  if (options.axes < 0 || options.axes > 3)
    return bad_usage(fmt::format("{} axes are not supported; use 1, 2 or 3", options.axes));
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
  if (options.every && *options.every < 1) {
    return bad_usage(fmt::format("--every {} is not 1 or more", *options.every), "choose 1 or more for --every");
  }
  if (options.padding.samples < 0)
    return bad_usage(fmt::format("a padding of {} samples is not 0 or more", options.padding.samples));
  return {};
}

std::string why_missing(const Recording& recording, std::string_view channel) {
  for (const std::string& note : recording.notes) {
    const std::size_t end = note.find(':');
    const bool not_used = std::min(note.find("not used"), note.find("not taken")) < end;
    if (not_used && note.find(channel) < end) return "; " + note;
  }
  return "";
}

Result<void> check_length(Index samples, const Inspection& inspection) {
  if (samples < kMinSamples) {
    return bad_data(fmt::format("{} sample{} cannot show a motion", samples, samples == 1 ? "" : "s"), "record longer");
  }
  if (!std::isfinite(inspection.duration)) {
    return bad_data("the first or last time is not a number", "correct the recording");
  }
  if (!(inspection.rate_hz > 0.0)) {
    return bad_data("time never increases", "check which channel is the time, and whether it is reversed");
  }
  if (inspection.duration <= 0.0 && inspection.backward_times > 0) {
    return bad_data(fmt::format("time runs backwards{} at sample {}, and the last time is before the first",
                                inspection.backward_times == 1 ? "" : ", first", inspection.first_backward + 1),
                    "correct the time, or assign another column as time with --channels");
  }
  return {};
}

namespace {

/// The step of time to a sample.
Result<void> check_step(const Clock& clock, const Inspection& inspection, Index i) {
  const double interval = clock.seconds(i) - clock.seconds(i - 1);
  const auto at = [&] { return fmt::format("at sample {} ({:.6f} s)", i + 1, clock.seconds(i)); };
  if (!(interval > 0.0)) {
    constexpr Index kOften = 10;
    const auto fault = [&] {
      if (std::isnan(clock.seconds(i - 1))) return fmt::format("time is not a number at sample {}", i);
      if (std::isnan(interval)) return fmt::format("time is not a number at sample {}", i + 1);
      return fmt::format("time {} {}", interval == 0.0 ? "repeats" : "runs backwards", at());
    };
    if (interval < 0.0 && inspection.backward_times > 1 && inspection.first_backward == i) {
      return bad_data(fmt::format("time runs backwards {} times, first {}", inspection.backward_times, at()),
                      "correct the time, or pass --rate HZ if the samples are evenly spaced");
    }
    const bool coarse = interval == 0.0 && kOften * inspection.duplicated_times > clock.samples();
    return bad_data(fault(), coarse ? "time is too coarse: give the sample rate, as in --rate 1000"
                                    : "choose a window without it with --from and --to");
  }
  if (std::ranges::binary_search(inspection.gaps, i - 1, {}, &Gap::sample)) {
    return bad_data(fmt::format("time has a gap of {:.4g} s {}; the sample interval is {:.4g} s", interval, at(),
                                inspection.interval_median),
                    "choose a window without it with --from and --to, or resample with --resample HZ");
  }
  return {};
}

bool has_gap(const Inspection& inspection, Index begin, Index end) {
  const auto first = std::ranges::lower_bound(inspection.gaps, begin, {}, &Gap::sample);
  return first != inspection.gaps.end() && first->sample < end;
}

}  // namespace

Result<void> check_clock(const Clock& clock, const Inspection& inspection, const WindowPlan& plan,
                         std::vector<Warning>& warnings) {
  constexpr Index kTogether = 512;
  const double median = inspection.interval_median;
  double sum = 0.0, largest = 0.0;
  Index count = 0;
  Eigen::ArrayXd intervals(kTogether);
  for (const Cut& cut : plan.cuts) {
    for (Index begin = cut.begin + 1; begin < cut.end; begin += kTogether) {
      const Index end = std::min(begin + kTogether, cut.end), size = end - begin;
      double before = clock.seconds(begin - 1);
      for (Index i = begin; i < end; ++i) {
        const double now = clock.seconds(i);
        intervals[i - begin] = now - before;
        before = now;
      }
      const auto here = intervals.head(size);
      if (!(here > 0.0).all() || has_gap(inspection, begin - 1, end - 1)) {
        for (Index i = begin; i < end; ++i) {
          MBK_TRY(check_step(clock, inspection, i));
        }
      }
      sum += (here - median).square().sum();
      largest = std::max(largest, (here - median).abs().maxCoeff());
      count += size;
    }
  }
  const double jitter = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
  if (jitter > 0.01 * median) {
    warnings.push_back({WarningCode::clock_jitter,
                        fmt::format("the clock jitters by {:.2g} ms (standard deviation; at most {:.2g} ms) around "
                                    "{:.4g} ms, but the samples are treated as uniform",
                                    1e3 * jitter, 1e3 * largest, 1e3 * median),
                        "record with a steadier clock, or compare with --resample HZ"});
  }
  return {};
}

Result<void> check_missing(const Clock& clock, const std::vector<MissingSamples>& missing, const WindowLimits& limits) {
  for (const MissingSamples& gap : missing) {
    const double from = clock.seconds(gap.first), to = clock.seconds(gap.first + gap.count - 1);
    if ((limits.from_s && to < *limits.from_s) || (limits.to_s && from >= *limits.to_s)) continue;
    return bad_data(
        fmt::format("{} missing from sample {} on ({:.6f} s to {:.6f} s; NaN in every channel)",
                    gap.count == 1 ? "a sample is" : fmt::format("{} samples are", gap.count), gap.first + 1, from, to),
        "choose a window without them with --from and --to; 'mbk info' names every gap");
  }
  return {};
}

Result<void> check_reference(const Clock& clock, const Signals& signals, const WindowLimits& limits) {
  for (Index axis = 0; axis < signals.reference.cols(); ++axis) {
    const Index first = first_non_finite(signals.reference.col(axis));
    for (Index i = std::max<Index>(first, 0); first >= 0 && i < signals.reference.rows(); ++i) {
      const double at = clock.seconds(i);
      const bool outside = (limits.from_s && at < *limits.from_s) || (limits.to_s && at >= *limits.to_s);
      if (outside || std::isfinite(signals.reference(i, axis))) continue;
      return bad_data(fmt::format("channel '{}' is not a number at sample {} ({:.6f} s)",
                                  kReferenceChannels.name(signals.axes, axis), i + 1, at),
                      "choose a window without it with --from and --to, or use --protocol free");
    }
  }
  return {};
}

namespace {

/// "; force freezes repeatedly, …" if samples of that channel were found to be missing.
std::string why_lost(const std::vector<Warning>& warnings, const std::string& channel) {
  for (const Warning& warning : warnings) {
    const bool lost = warning.code == WarningCode::missing_samples || warning.code == WarningCode::held_signal;
    if (lost && warning.channel == channel) return "; " + warning.message;
  }
  return {};
}

}  // namespace

Result<void> check_finite(const Clock& clock, const Signals& signals, const WindowPlan& plan,
                          const std::vector<Warning>& warnings) {
  const std::array<std::pair<QuantityChannels, const Columns*>, 3> quantities = {
      {{kPositionChannels, &signals.position},
       {kForceChannels, &signals.force_hand_on_robot},
       {kAccelerationChannels, &signals.acceleration}}};
  for (const auto& [quantity, columns] : quantities) {
    for (Index axis = 0; axis < columns->cols(); ++axis) {
      for (const Cut& cut : plan.cuts) {
        const Index bad = first_non_finite(columns->col(axis).segment(cut.begin, cut.end - cut.begin));
        if (bad < 0) continue;
        const Index sample = cut.begin + bad;
        const std::string name(quantity.name(signals.axes, axis));
        return bad_data(fmt::format("channel '{}' is not a number at sample {} ({:.6f} s){}", name, sample + 1,
                                    clock.seconds(sample), why_lost(warnings, name)),
                        "choose a window without it with --from and --to, or correct the recording");
      }
    }
  }
  return {};
}

void warn_of_small_motion(const Signals& signals, const WindowPlan& plan, std::vector<Warning>& warnings) {
  constexpr double kStepsEnough = 20.0;  // standard deviations of the motion in steps: the rounding is then 1.4 % of it
  double step = std::numeric_limits<double>::infinity(), motion = 0.0;
  for (const Cut& cut : plan.cuts) {
    for (Index axis = 0; axis < signals.axes; ++axis) {
      const auto piece = signals.position.col(axis).segment(cut.begin, cut.end - cut.begin);
      motion = std::max(motion, std::sqrt((piece.array() - piece.mean()).square().mean()));
      for (Index i = 1; i < piece.size(); ++i) {
        const double change = std::abs(piece[i] - piece[i - 1]);
        if (change > 0.0) step = std::min(step, change);
      }
    }
  }
  if (motion < kStepsEnough * step) {
    warnings.push_back(
        {WarningCode::motion_too_small,
         std::isinf(step)
             ? std::string("the position does not move")
             : fmt::format("the position moves by only {:.2g} (standard deviation), but is recorded in steps of {:.2g}",
                           motion, step),
         "perturb more, and check the position channel and its unit"});
  }
}

namespace {

/// How strongly force and position vary within about a second from a sample on.
struct Activity {
  Index begin = 0, end = 0;
  double force = 0.0, motion = 0.0;  ///< standard deviations over all axes
};

double variation(const Columns& columns, Index begin, Index samples) {
  double square = 0.0;
  for (Index axis = 0; axis < columns.cols(); ++axis) {
    const auto piece = columns.col(axis).segment(begin, samples).array();
    square += (piece - piece.mean()).square().mean();
  }
  return std::sqrt(square);
}

std::vector<Activity> activity(const Clock& clock, const Signals& signals, const WindowPlan& plan) {
  const auto second = std::max<Index>(kMinSamples, std::lround(clock.rate().value));
  std::vector<Activity> blocks;
  for (const Cut& cut : plan.cuts) {
    const Index count = std::max<Index>(1, (cut.end - cut.begin) / second);
    for (Index k = 0; k < count; ++k) {
      const Index begin = cut.begin + (cut.end - cut.begin) * k / count;
      const Index end = cut.begin + (cut.end - cut.begin) * (k + 1) / count;
      blocks.push_back({begin, end, variation(signals.force_hand_on_robot, begin, end - begin),
                        variation(signals.position, begin, end - begin)});
    }
  }
  return blocks;
}

}  // namespace

void warn_of_lost_contact(const Clock& clock, const Signals& signals, const WindowPlan& plan,
                          std::vector<Warning>& warnings) {
  constexpr double kGone = 0.1, kThere = 0.4;        // of the usual force
  constexpr double kMoves = 0.5, kMovesAlike = 2.0;  // of the usual motion: neither rest nor another movement
  constexpr std::size_t kShows = 3, kLasts = 2;      // blocks
  const std::vector<Activity> blocks = activity(clock, signals, plan);
  const auto usual = [&](std::size_t count, double Activity::*what) {
    std::vector<double> levels;
    for (std::size_t k = 0; k < count; ++k) levels.push_back(blocks[k].*what);
    return levels.size() < kShows ? 0.0 : numeric::median(levels);
  };
  const double of_all = usual(blocks.size(), &Activity::force);
  double strongest = 0.0;
  for (const Activity& one : blocks) strongest = std::max(strongest, one.force);
  for (std::size_t k = 0; k + kLasts <= blocks.size(); ++k) {
    if (!(blocks[k].force < kGone * strongest)) continue;  // whatever is usual
    // Of the blocks before, or of all, where the hand was away first.
    const bool by_before = usual(k, &Activity::force) >= of_all;
    const std::size_t count = by_before ? k : blocks.size();
    const double force = usual(count, &Activity::force), motion = usual(count, &Activity::motion);
    const auto is_lost = [&](const Activity& one) {
      return one.force < kGone * force && one.motion > kMoves * motion && one.motion < kMovesAlike * motion;
    };
    std::size_t end = k;
    double left = 0.0;
    while (end < blocks.size() && is_lost(blocks[end])) left = std::max(left, blocks[end++].force);
    // Sudden: a sweep in frequency also changes the force, but gradually. One block may contain the change.
    const auto is_there = [&](std::size_t at) { return at < blocks.size() && blocks[at].force >= kThere * force; };
    const bool sudden =
        (k > 0 && (is_there(k - 1) || (k > 1 && is_there(k - 2)))) || is_there(end) || is_there(end + 1);
    if (end - k < kLasts || !sudden) continue;
    const bool comes_back = end < blocks.size();
    const double first = clock.seconds(blocks.front().begin), last = clock.seconds(blocks.back().end);
    const double gone = clock.seconds(blocks[k].begin), back = comes_back ? clock.seconds(blocks[end].begin) : last;
    const double before = k == 0 ? 0.0 : clock.seconds(blocks[k - 1].begin) - first, after = last - back;
    const std::string when =
        !comes_back ? fmt::format("from {:.3g} s on", gone) : fmt::format("from {:.3g} s to {:.3g} s", gone, back);
    const std::string remedy =
        before >= after ? fmt::format("--to {:.3g}", std::floor(10.0 * (first + before)) / 10.0)
                        : fmt::format("--from {:.3g}", std::ceil(10.0 * clock.seconds(blocks[end].end)) / 10.0);
    warnings.push_back({WarningCode::contact_lost,
                        fmt::format("{} the force varies by at most {:.2g} % of its usual level, while the motion "
                                    "continues: the hand probably left the handle, or the force sensor failed",
                                    when, 100.0 * left / force),
                        fmt::format("measure the part without it: {}", remedy)});
    return;
  }
}

Result<void> check_alive(const Signals& signals, const WindowPlan& plan) {
  const auto constant = [&](const Columns& columns, Index axis) {
    const double value = columns(plan.cuts.front().begin, axis);
    return std::ranges::all_of(plan.cuts, [&](const Cut& cut) {
      return (columns.col(axis).segment(cut.begin, cut.end - cut.begin).array() == value).all();
    });
  };
  const auto refusal = [&](const QuantityChannels& quantity, const Columns& columns, Index axis, const char* remedy) {
    return bad_data(fmt::format("channel '{}' is {:g} throughout the window", quantity.name(signals.axes, axis),
                                columns(plan.cuts.front().begin, axis)),
                    remedy);
  };
  Index resting = 0;
  for (Index axis = 0; axis < signals.axes; ++axis) {
    if (constant(signals.force_hand_on_robot, axis)) {
      return refusal(kForceChannels, signals.force_hand_on_robot, axis,
                     "check that the sensor was on, or assign another column with --channels");
    }
    resting += constant(signals.position, axis) ? 1 : 0;
  }
  if (resting < signals.axes) return {};
  return refusal(kPositionChannels, signals.position, 0,
                 "choose a window in which the limb moves, with --from and --to");
}

}  // namespace mbk::preprocess
