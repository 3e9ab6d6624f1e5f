#include "mbk/files/recording/stale_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>

#include "mbk/base/dsp/fourier.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::recording {
namespace {

constexpr Index kMinSamples = 200, kMinChanges = 40;

double quantile(std::vector<double> values, double part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

/// A run of equal values between two changes.
struct Run {
  Index begin = 0, length = 0;
  double value = 0.0;
  double before = 0.0, after = 0.0;  ///< the changes that lead to it and away from it, with their signs
};

/// The runs of a channel with a change on either side, and statistics of all changes.
struct Runs {
  std::vector<Run> runs;       ///< run k lies between changes k and k + 1
  std::vector<Index> changes;  ///< samples whose value is not that of the sample before
  std::vector<double> jumps;   ///< by how much
  double least = 0.0;          ///< the 5 % quantile of their sizes
  double step = 0.0;           ///< the same, or what `common_size` finds
  double varied = 0.0;         ///< share of the changes that are at least twice as large
  double low = 0.0, high = 0.0;
};

/// The size that most of some changes have to within 2 %, where that is more than 15 % of them: the step of an encoder
/// or a converter, also where its numbers were computed further and differ in their last digits; 0: there is none.
double common_size(const std::vector<double>& sizes) {
  constexpr std::size_t kLooked = 4096;
  constexpr double kBin = 0.02, kCommon = 0.15;
  std::map<long, double> bins;  // shares, by the logarithm of the size
  const std::size_t every = sizes.size() / kLooked + 1, looked = (sizes.size() + every - 1) / every;
  for (std::size_t k = 0; k < sizes.size(); k += every) {
    bins[std::lround(std::log(sizes[k]) / kBin)] += 1.0 / static_cast<double>(looked);
  }
  double most = kCommon, size = 0.0;
  for (const auto& [bin, share] : bins) {
    const auto next = bins.find(bin + 1);  // a size may lie on the edge of two bins
    const double both = share + (next == bins.end() ? 0.0 : next->second);
    if (both <= most) continue;
    most = both;
    size = std::exp(kBin * static_cast<double>(bin));
  }
  return size;
}

/// Changes that follow each other, whose sizes are compared.
constexpr std::size_t kBlock = 64;

/// Block by block, whether the changes have more sizes than the steps of one or two encoders.
std::vector<bool> blocks_of_many_sizes(const std::vector<double>& sizes) {
  constexpr double kSame = 0.02;  // relative
  std::vector<bool> many;
  std::vector<double> sorted;
  for (std::size_t begin = 0; begin < sizes.size(); begin += kBlock) {
    const std::size_t from = std::min(begin, sizes.size() - std::min(kBlock, sizes.size()));
    sorted.assign(sizes.begin() + static_cast<std::ptrdiff_t>(from),
                  sizes.begin() + static_cast<std::ptrdiff_t>(std::min(from + kBlock, sizes.size())));
    std::ranges::sort(sorted);
    std::size_t different = 1;
    for (std::size_t k = 1; k < sorted.size(); ++k) different += sorted[k] > (1.0 + kSame) * sorted[k - 1] ? 1 : 0;
    many.push_back(8 * different >= 3 * sorted.size());
  }
  return many;
}

/// @param values  finite
Runs runs_of(const Eigen::Ref<const Vector>& values) {
  Runs all;
  std::vector<double> sizes;
  for (Index i = 1; i < values.size(); ++i) {
    if (values[i] == values[i - 1]) continue;
    all.changes.push_back(i);
    all.jumps.push_back(values[i] - values[i - 1]);
    sizes.push_back(std::abs(all.jumps.back()));
  }
  if (std::ssize(all.changes) < kMinChanges) return all;
  all.least = quantile(sizes, 0.05);
  all.step = std::max(all.least, common_size(sizes));
  const auto large = std::ranges::count_if(sizes, [&](double size) { return size >= 2.0 * all.step; });
  all.varied = static_cast<double>(large) / static_cast<double>(sizes.size());
  all.low = values.minCoeff();
  all.high = values.maxCoeff();
  all.runs.resize(all.changes.size() - 1);
  for (std::size_t k = 0; k < all.runs.size(); ++k) {
    const Index begin = all.changes[k];
    all.runs[k] = {begin, all.changes[k + 1] - begin, values[begin], all.jumps[k], all.jumps[k + 1]};
  }
  return all;
}

std::vector<double> sizes_of(const Runs& all) {
  std::vector<double> sizes;
  for (const double jump : all.jumps) sizes.push_back(std::abs(jump));
  return sizes;
}

/// The median size of the four changes before a run and the four after it.
double scale_around(const Runs& all, std::size_t run) {
  constexpr Index kEachSide = 4;
  const Index k = static_cast<Index>(run), count = std::ssize(all.jumps);
  const Index first = std::max<Index>(0, k + 1 - kEachSide), last = std::min(count - 1, k + kEachSide);
  std::array<double, 2 * kEachSide> sizes{};
  std::size_t found = 0;
  for (Index j = first; j <= last; ++j) {
    const double size = std::abs(all.jumps[static_cast<std::size_t>(j)]);
    std::size_t place = found++;
    for (; place > 0 && sizes[place - 1] > size; --place) sizes[place] = sizes[place - 1];
    sizes[place] = size;
  }
  return found % 2 == 1 ? sizes[found / 2] : 0.5 * (sizes[found / 2 - 1] + sizes[found / 2]);
}

/// The value that most of some runs have.
struct Common {
  double value = 0.0;
  Index runs = 0, of = 0;
};

template <class Chosen>
Common most_common(const Runs& all, const Chosen& chosen) {
  std::unordered_map<double, Index> counts;
  Common common;
  for (std::size_t k = 0; k < all.runs.size(); ++k) {
    if (!chosen(k)) continue;
    ++common.of;
    const Index count = ++counts[all.runs[k].value];
    if (count > common.runs) common = {all.runs[k].value, count, common.of};
  }
  return common;
}

void mark(const Run& run, Index from, std::vector<bool>& samples) {
  std::fill(samples.begin() + run.begin + from, samples.begin() + run.begin + run.length, true);
}

double share_of(const std::vector<bool>& samples) {
  return static_cast<double>(std::ranges::count(samples, true)) / static_cast<double>(samples.size());
}

/// Whether all runs have one of a few values, as those of a sequence of steps that a controller made.
bool has_few_values(const Runs& all) {
  constexpr std::size_t kFew = 16;
  std::vector<double> values;
  for (const Run& run : all.runs) {
    if (std::ranges::find(values, run.value) != values.end()) continue;
    values.push_back(run.value);
    if (values.size() > kFew) return false;
  }
  return true;
}

// ---- a value that marks missing measurements ----

/// Loss while a channel was at a value: distance of the adjacent measurements from it.
struct Lost {
  double value = 0.0;
  std::vector<double> away;
};

double nearest_beside(const Run& run) {
  return std::min(std::abs(run.before), std::abs(run.after));
}

/// The value of at least a tenth of the runs that comes 20 times as often as any other, told from up to 511 of them.
std::optional<double> most_frequent(const Runs& all) {
  constexpr std::size_t kLooked = 511;
  constexpr Index kMin = 20, kTimes = 20, kPart = 10;
  const std::size_t every = (all.runs.size() / kLooked) | 1U;  // odd: values may alternate
  std::vector<double> some;
  for (std::size_t k = 0; k < all.runs.size() && some.size() < kLooked; k += every) some.push_back(all.runs[k].value);
  std::ranges::sort(some);
  Index most = 0, second = 0;
  double value = 0.0;
  for (auto from = some.begin(); from != some.end();) {
    const auto to = std::upper_bound(from, some.end(), *from);
    const Index count = to - from;
    second = std::max(second, std::min(count, most));
    if (count > most) value = *from;
    most = std::max(most, count);
    from = to;
  }
  const bool found = most >= kMin && kPart * most >= std::ssize(some) && most >= kTimes * second;
  return found ? std::optional(value) : std::nullopt;
}

/// The value to which the channel leaps from far, to go on behind it where it was before, or that is most frequent.
std::optional<Lost> lost_at_one_value(const Runs& all) {
  constexpr Index kMin = 5;
  constexpr double kMax = 0.6, kFar = 6.0;
  const double usual = numeric::median(sizes_of(all));
  const auto leaps = [&](std::size_t k) {
    const Run& run = all.runs[k];
    const double nearest = nearest_beside(run);
    return nearest > kFar * usual && std::abs(run.before + run.after) < 0.5 * nearest;
  };
  Lost lost;
  const auto take = [&](double value, const auto& chosen) {
    lost.value = value;
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
      if (all.runs[k].value == value && chosen(k)) lost.away.push_back(nearest_beside(all.runs[k]));
    }
    return lost;
  };
  const Common leapt = most_common(all, leaps);
  if (leapt.runs >= kMin && static_cast<double>(leapt.runs) >= kMax * static_cast<double>(leapt.of)) {
    return take(leapt.value, leaps);
  }
  const auto frequent = most_frequent(all);
  if (!frequent) return std::nullopt;
  return take(*frequent, [](std::size_t) { return true; });
}

/// Losses are independent of the signal. A channel that rests at a value (no contact, a dead band, the start of each
/// reach) approaches and leaves it from nearby.
std::optional<Stale> find_placeholder(const Eigen::Ref<const Vector>& values, const Runs& all) {
  constexpr double kShare = 0.002, kRank = 0.15, kStepsApart = 2.5, kApart = 0.02;
  if (has_few_values(all)) return std::nullopt;
  auto lost = lost_at_one_value(all);
  if (!lost) return std::nullopt;
  const double value = lost->value;
  std::vector<double> away;
  double low = std::numeric_limits<double>::infinity(), high = -low;  // without the value
  for (const double one : values) {
    if (one == value) continue;
    away.push_back(std::abs(one - value));
    low = std::min(low, one);
    high = std::max(high, one);
  }
  if (away.empty() || !(numeric::median(std::move(lost->away)) > quantile(away, kRank))) return std::nullopt;
  // The end of a range marks missing data only if it is far from the measurements.
  const double gap = std::max(low - value, value - high);
  if (gap > 0.0 && gap < std::max(kStepsApart * all.least, kApart * (high - low))) return std::nullopt;
  Stale stale{{Staleness::placeholder, 1.0, 0.0, value}, std::vector<bool>(static_cast<std::size_t>(values.size()))};
  for (Index i = 0; i < values.size(); ++i) stale.samples[static_cast<std::size_t>(i)] = values[i] == value;
  stale.updates.share = share_of(stale.samples);
  stale.updates.interval = 1.0 / (1.0 - stale.updates.share);
  if (stale.updates.share < kShare) return std::nullopt;
  return stale;
}

// ---- updates at a lower rate than the recording's ----

/// How far changes at these samples keep to a comb of that many per sample: |Σ exp(2πi f n)| over their number, 1 where
/// all do.
double concentration(const std::vector<Index>& changes, double frequency) {
  double cosines = 0.0, sines = 0.0;
  for (const Index change : changes) {
    const double turns = frequency * static_cast<double>(change);
    const double angle = 2.0 * std::numbers::pi * (turns - std::floor(turns));
    cosines += std::cos(angle);
    sines += std::sin(angle);
  }
  return std::hypot(cosines, sines) / static_cast<double>(changes.size());
}

/// The period of updates [samples] that the changes at the end of repeated values keep to; 0: there is none. A channel
/// that moves by single steps must keep to a whole number exactly: slow motion in steps nearly does so, too.
double period_of(const Runs& all, Index samples, bool of_steps) {
  constexpr double kKept = 0.7, kKeptInSteps = 0.97;
  constexpr Index kLongest = 1 << 17;
  constexpr double kSlowest = 1.0 / 500.0, kFundamental = 0.7;
  std::vector<Index> changes;
  for (const Run& run : all.runs) {
    const Index end = run.begin + run.length;
    if (run.length >= 2 && end < kLongest) changes.push_back(end);
  }
  if (std::ssize(changes) < kMinChanges) return 0.0;
  Index length = 1;
  while (length < std::min(samples, kLongest)) length *= 2;
  Vector indicator = Vector::Zero(length);
  for (const Index change : changes) indicator[change] = 1.0;
  const Eigen::ArrayXd line =
      dsp::fourier_transform(indicator).head(length / 2 + 1).array().abs() / static_cast<double>(changes.size());
  const auto first = static_cast<Index>(std::ceil(kSlowest * static_cast<double>(length)));
  const Index beyond = line.size() - first;
  if (beyond < 2) return 0.0;
  const double highest = line.tail(beyond).maxCoeff();
  Index at = first;
  while (line[at] < kFundamental * highest) ++at;
  while (at + 1 < line.size() && line[at + 1] > line[at]) ++at;
  double frequency = 0.0, kept = 0.0;
  for (int k = -8; k <= 8; ++k) {
    const double tried = (static_cast<double>(at) + k / 8.0) / static_cast<double>(length);
    const double here = concentration(changes, tried);
    if (here > kept) {
      kept = here;
      frequency = tried;
    }
  }
  // The same line stands for one update in 1/(1 − f) samples, where there are more changes than one in 1/f.
  const auto count = static_cast<double>(all.changes.size());
  double period = 1.0 / frequency;
  if (count > 1.05 * static_cast<double>(samples) / period) period = 1.0 / (1.0 - frequency);
  const double whole = std::round(period), width = std::abs(period - whole) < 1e-3 * period ? 0.0 : 1.0 / period;
  const double expected = width == 0.0 ? 1.0 : std::sin(std::numbers::pi * width) / (std::numbers::pi * width);
  if (of_steps && (width > 0.0 || kept < kKeptInSteps)) return 0.0;
  if (!(period > 1.2) || kept < kKept * expected) return 0.0;
  return width == 0.0 ? whole : period;
}

/// Of runs that are longer than a period, a measurement follows every period: it had the same value.
Stale held(double period, const Runs& all, Index samples) {
  Stale stale{{Staleness::held, period}, std::vector<bool>(static_cast<std::size_t>(samples), true)};
  const auto begin_at = [&](Index begin, Index length) {
    for (double at = 0.0; at <= static_cast<double>(length) - 0.5 * period || at == 0.0; at += period) {
      stale.samples[static_cast<std::size_t>(begin + std::min<Index>(length - 1, std::lround(at)))] = false;
    }
  };
  begin_at(0, all.changes.front());
  for (const Run& run : all.runs) begin_at(run.begin, run.length);
  begin_at(all.changes.back(), samples - all.changes.back());
  stale.updates.share = share_of(stale.samples);
  return stale;
}

std::optional<Stale> find_held(const Runs& all, Index samples) {
  constexpr double kRepeats = 0.1, kVaried = 0.1, kMultiples = 0.05;
  const auto count = static_cast<double>(all.runs.size());
  const auto part = [&](auto is) { return static_cast<double>(std::ranges::count_if(all.runs, is)) / count; };
  if (part([](const Run& run) { return run.length >= 2; }) < kRepeats || has_few_values(all)) return std::nullopt;
  const double period = period_of(all, samples, all.varied <= kVaried);
  if (period == 0.0) return std::nullopt;
  // A ramp in equal steps changes regularly, too, but by one step, and never skips one.
  const double multiples = part([&](const Run& run) { return static_cast<double>(run.length) >= 1.7 * period; });
  if (all.varied <= kVaried && multiples <= kMultiples) return std::nullopt;
  return held(period, all, samples);
}

// ---- repeats and freezes ----

/// Finds repeats and freezes among samples that move.
class Repeats {
 public:
  Repeats(const Runs& all, Index samples) : all_(all), samples_(samples) {
    scale_.resize(all.runs.size());
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
      if (all.runs[k].length >= 2 || k % kSampled == 0) scale_[k] = scale_around(all, k);
    }
    many_sizes_ = blocks_of_many_sizes(sizes_of(all));
    rest_ = most_common(all, [&](std::size_t k) { return moves(k) && all.runs[k].length >= 2; });
  }

  [[nodiscard]] std::optional<Stale> find() const {
    if (auto stale = repeated()) return stale;
    return frozen();
  }

 private:
  static constexpr Index kShortRun = 10;
  static constexpr std::size_t kSampled = 16;  ///< every Nth run of one sample is examined

  [[nodiscard]] double share(Index count) const { return static_cast<double>(count) / static_cast<double>(samples_); }
  [[nodiscard]] bool at_extreme(const Run& run) const { return run.value == all_.low || run.value == all_.high; }
  /// A signal in steps moves by many of them in each sample.
  [[nodiscard]] bool moves(std::size_t k) const {
    constexpr double kSteps = 4.0;
    return many_sizes_[k / kBlock] && scale_[k] >= kSteps * all_.least && !at_extreme(all_.runs[k]);
  }
  /// At the value to which the channel returns again and again.
  [[nodiscard]] bool rests(const Run& run) const {
    constexpr Index kMin = 5;
    constexpr double kOften = 0.3;
    return rest_.runs >= kMin && static_cast<double>(rest_.runs) > kOften * static_cast<double>(rest_.of) &&
           run.value == rest_.value;
  }

  /// White noise turns in two changes of three, motion hardly ever.
  [[nodiscard]] double turns() const {
    Index turns = 0;
    for (std::size_t j = 1; j < all_.jumps.size(); ++j) {
      turns += (all_.jumps[j] < 0.0) != (all_.jumps[j - 1] < 0.0) ? 1 : 0;
    }
    return static_cast<double>(turns) / static_cast<double>(all_.jumps.size());
  }

  /// In motion, the change behind a repeated value makes up for it; in noise it turns as often as any other. The values
  /// of a median filter, or of a robot that sticks and starts slowly, do neither.
  [[nodiscard]] bool misses_samples() const {
    constexpr double kOfNoise = 0.62, kOfMotion = 0.4;
    std::vector<double> larger;
    for (std::size_t k = 0; k < all_.runs.size(); ++k) {
      const Run& run = all_.runs[k];
      if (run.length < 2 || run.length > kShortRun || !moves(k)) continue;
      larger.push_back(std::abs(run.after) / scale_[k]);
    }
    if (larger.empty()) return false;
    return turns() / kOfNoise + std::max(0.0, numeric::median(std::move(larger)) - 1.0) / kOfMotion > 1.0;
  }

  [[nodiscard]] bool is_in_steps() const {
    constexpr double kNear = 0.05, kNearlyAll = 0.95;
    const auto whole = std::ranges::count_if(all_.jumps, [&](double jump) {
      const double steps = std::abs(jump) / all_.step;
      return steps > 0.5 && std::abs(steps - std::round(steps)) < kNear;
    });
    return static_cast<double>(whole) > kNearlyAll * static_cast<double>(all_.jumps.size());
  }

  /// A channel in steps that moves by two of them and more in one sample passes none at rest.
  [[nodiscard]] bool rests_in_motion() const {
    constexpr double kSteps = 1.9, kOne = 1.1;
    Index at_rest = 0, by_one = 0;
    if (!is_in_steps()) return false;
    for (std::size_t k = 1; k < all_.runs.size(); ++k) {
      if (rests(all_.runs[k])) continue;
      const double before = all_.jumps[k] / all_.step, after = all_.jumps[k + 1] / all_.step;
      const bool straight = (before < 0.0) == (after < 0.0) && std::abs(before) > kSteps && std::abs(after) > kSteps;
      at_rest += straight && all_.runs[k].length == 2 ? 1 : 0;
      const double last = all_.jumps[k - 1] / all_.step;
      by_one += (last < 0.0) == (after < 0.0) && std::abs(last) > kSteps && std::abs(after) > kSteps &&
                        std::abs(before) < kOne && all_.runs[k].length == 1
                    ? 1
                    : 0;
    }
    return at_rest >= kMinChanges && at_rest > 2 * by_one;
  }

  [[nodiscard]] std::optional<Stale> repeated() const {
    constexpr double kRepeats = 0.12, kMinShare = 0.03;
    Index moving = 0, longer = 0, short_runs = 0, in_short = 0, stale_short = 0, stale_all = 0;
    for (std::size_t k = 0; k < all_.runs.size(); ++k) {
      const Run& run = all_.runs[k];
      if (!moves(k) || rests(run)) continue;
      const Index count = run.length >= 2 ? 1 : Index{kSampled};  // single samples represent their neighbours
      moving += count;
      longer += run.length >= 2 ? 1 : 0;
      stale_all += run.length - 1;
      if (run.length > kShortRun) continue;
      short_runs += count;
      in_short += count * run.length;
      stale_short += run.length - 1;
    }
    const bool in_passing = short_runs >= kMinChanges && share(stale_short) >= kMinShare &&
                            static_cast<double>(stale_short) > kRepeats * static_cast<double>(in_short) &&
                            misses_samples();
    const bool mostly = moving >= kMinChanges && share(stale_all) >= kMinShare && all_.varied > 0.3 &&
                        static_cast<double>(longer) > 0.6 * static_cast<double>(moving);
    const bool in_steps = !in_passing && !mostly && rests_in_motion();
    if (!in_passing && !mostly && !in_steps) return std::nullopt;
    Stale stale{{Staleness::repeated}, std::vector<bool>(static_cast<std::size_t>(samples_))};
    for (std::size_t k = 0; k < all_.runs.size(); ++k) {
      const Run& run = all_.runs[k];
      const bool straight = std::min(std::abs(run.before), std::abs(run.after)) > all_.step;
      if (in_steps ? straight && run.length <= kShortRun
                   : moves(k) && !rests(run) && (mostly || run.length <= kShortRun)) {
        mark(run, 1, stale.samples);
      }
    }
    stale.updates.share = share_of(stale.samples);
    stale.updates.interval = 1.0 / (1.0 - stale.updates.share);
    return stale;
  }

  /// The channel moves up to the run and behind it, sample by sample, and stops and starts at once.
  struct Stop {
    bool abrupt = false;
    bool catches_up = false;  ///< the change behind it is far larger than those that follow
    bool fine = false;        ///< in changes of many sizes
  };
  [[nodiscard]] Stop stop_at(std::size_t k) const {
    constexpr std::size_t kBeside = 8;
    constexpr double kAbrupt = 0.3, kFar = 3.0;
    if (k < kBeside || k + kBeside >= all_.runs.size()) return {};
    std::array<double, kBeside> before{}, after{};
    Index samples_before = 0, samples_after = 0;
    for (std::size_t i = 0; i < kBeside; ++i) {
      before[i] = std::abs(all_.jumps[k - 1 - i]);
      after[i] = std::abs(all_.jumps[k + 2 + i < all_.jumps.size() ? k + 2 + i : k + 1]);
      samples_before += all_.runs[k - 1 - i].length;
      samples_after += all_.runs[k + 1 + i].length;
    }
    if (std::max(samples_before, samples_after) > static_cast<Index>(2 * kBeside)) return {};
    const auto median = [](std::array<double, kBeside>& sizes) {
      std::ranges::nth_element(sizes, sizes.begin() + kBeside / 2);
      return sizes[kBeside / 2];
    };
    const double usual_before = median(before), usual_after = median(after);
    const Run& run = all_.runs[k];
    return {std::abs(run.before) >= kAbrupt * usual_before && std::abs(run.after) >= kAbrupt * usual_after,
            std::abs(run.after) >= kFar * usual_after, many_sizes_[k / kBlock]};
  }

  [[nodiscard]] std::optional<Stale> frozen() const {
    constexpr Index kShortest = 8, kShortestInNoise = 16, kMin = 2, kAlike = 3;
    constexpr double kMinShare = 0.005, kOften = 0.3, kNoise = 0.58;
    std::vector<std::size_t> stops;
    Index catching_up = 0;
    const bool noisy = turns() > kNoise;
    for (std::size_t k = 0; k < all_.runs.size(); ++k) {
      const Run& run = all_.runs[k];
      if (run.length < kShortest || at_extreme(run) || rests(run)) continue;
      const Stop stop = stop_at(k);
      if (!stop.abrupt || (!stop.catches_up && (!stop.fine || run.length < kShortestInNoise))) continue;
      stops.push_back(k);
      catching_up += stop.catches_up ? 1 : 0;
    }
    const auto found = std::ssize(stops);
    if (found < kMin || (!noisy && 2 * catching_up < found)) return std::nullopt;
    const auto is_stop = [&](std::size_t k) { return std::ranges::binary_search(stops, k); };
    const Common common = most_common(all_, is_stop);
    if (common.runs > 1 && static_cast<double>(common.runs) > kOften * static_cast<double>(found)) return std::nullopt;
    std::vector<double> lengths;
    for (const std::size_t k : stops) lengths.push_back(static_cast<double>(all_.runs[k].length));
    // A channel that freezes does so in other runs of that length, too; one that rests mostly does not freeze.
    const double as_long = 0.5 * numeric::median(std::move(lengths));
    Stale stale{{Staleness::frozen}, std::vector<bool>(static_cast<std::size_t>(samples_))};
    Index marked = 0;
    for (std::size_t k = 0; k < all_.runs.size(); ++k) {
      const Run& run = all_.runs[k];
      if (at_extreme(run) || rests(run) || (!is_stop(k) && static_cast<double>(run.length) < as_long)) continue;
      ++marked;
      mark(run, 1, stale.samples);
    }
    stale.updates.share = share_of(stale.samples);
    if (marked > kAlike * found || stale.updates.share < kMinShare) return std::nullopt;
    return stale;
  }

  const Runs& all_;
  Index samples_;
  std::vector<double> scale_;  ///< around each run that is looked at
  std::vector<bool> many_sizes_;
  Common rest_;
};

/// Whether enough values repeat for anything to be found: most channels need no closer look.
bool repeats_enough(const Runs& all, Index samples) {
  Index stale = 0, in_long = 0;
  for (const Run& run : all.runs) {
    stale += run.length - 1;
    if (run.length >= 5) in_long += run.length;
  }
  return 33 * stale >= samples || 100 * in_long >= samples;
}

/// Whether a channel hardly ever repeats a value and has no jumps to speak of, as most channels. Of a long one a
/// quarter is looked at.
bool is_plain(const Eigen::Ref<const Vector>& values) {
  constexpr Index kLooked = 1024, kPart = 256, kShort = 16384, kSpikes = 5;
  constexpr double kFar = 20.0;
  const Index n = values.size(), stride = n > kShort ? 4 * kPart : kPart;
  const double* const x = values.data();
  std::vector<double> some;
  for (Index k = 0; k < kLooked; ++k) {
    const Index i = 1 + k * (n - 2) / (kLooked - 1);
    some.push_back(std::abs(x[i] - x[i - 1]));
  }
  const double far = kFar * quantile(std::move(some), 0.25);
  Index looked = 0, repeats = 0, spikes = 0;
  for (Index begin = 1; begin < n; begin += stride) {
    const Index end = std::min(n, begin + kPart);
    for (Index i = begin; i < end; ++i) {
      const double change = std::abs(x[i] - x[i - 1]);
      repeats += change == 0.0 || (i >= 2 && x[i] == x[i - 2]) ? 1 : 0;
      spikes += change > far ? 1 : 0;
    }
    looked += end - begin;
  }
  return 100 * repeats <= looked && spikes < kSpikes;
}

Stale find_in_finite(const Eigen::Ref<const Vector>& values) {
  if (values.size() < kMinSamples || is_plain(values)) return {};
  const Runs all = runs_of(values);
  if (std::ssize(all.changes) < kMinChanges) return {};
  if (auto stale = find_placeholder(values, all)) return std::move(*stale);
  if (auto stale = find_held(all, values.size())) return std::move(*stale);
  if (!repeats_enough(all, values.size())) return {};
  if (auto stale = Repeats(all, values.size()).find()) return std::move(*stale);
  return {};
}

}  // namespace

Stale find_stale(const Eigen::Ref<const Vector>& values) {
  if (values.allFinite()) return find_in_finite(values);
  std::vector<Index> finite;
  for (Index i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) finite.push_back(i);
  }
  Stale some = find_in_finite(values(finite));
  if (some.samples.empty()) return some;
  Stale all{some.updates, std::vector<bool>(static_cast<std::size_t>(values.size()))};
  for (std::size_t k = 0; k < finite.size(); ++k) {
    all.samples[static_cast<std::size_t>(finite[k])] = some.samples[k];
  }
  return all;
}

}  // namespace mbk::recording
