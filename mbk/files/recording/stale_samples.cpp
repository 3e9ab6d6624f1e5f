#include "mbk/files/recording/stale_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>

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

/// The runs of a channel that have a change on either side, and what is known of all changes.
struct Runs {
  std::vector<Run> runs;       ///< run k lies between changes k and k + 1
  std::vector<Index> changes;  ///< samples whose value is not that of the sample before
  std::vector<double> jumps;   ///< by how much
  double least = 0.0;          ///< the 5 % quantile of their sizes
  double step = 0.0;           ///< the same, or what `common_size` finds
  double usual = 0.0;          ///< the lower quartile
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

/// Block by block, whether the changes have so many sizes that they are no few steps of one or two encoders.
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
  all.usual = quantile(sizes, 0.25);
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

/// The four changes before a run and the four after it.
struct Around {
  double scale = 0.0;  ///< median of their sizes
  double small = 0.0;  ///< lower quartile
  int turns = 0;       ///< how many have another sign than the one before, on the same side
};

Around around(const Runs& all, std::size_t run) {
  constexpr Index kEachSide = 4;
  const Index k = static_cast<Index>(run), count = std::ssize(all.jumps);
  const Index first = std::max<Index>(0, k + 1 - kEachSide), last = std::min(count - 1, k + kEachSide);
  std::array<double, 2 * kEachSide> sizes{};
  std::size_t found = 0;
  Around result;
  for (Index j = first; j <= last; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const double size = std::abs(all.jumps[at]);
    std::size_t place = found++;
    for (; place > 0 && sizes[place - 1] > size; --place) sizes[place] = sizes[place - 1];
    sizes[place] = size;
    const bool same_side = j > first && j != k + 1;
    if (same_side && (all.jumps[at] < 0.0) != (all.jumps[at - 1] < 0.0)) ++result.turns;
  }
  result.scale = found % 2 == 1 ? sizes[found / 2] : 0.5 * (sizes[found / 2 - 1] + sizes[found / 2]);
  result.small = sizes[found / 4];
  return result;
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

// ---- a value that stands where nothing was measured ----

std::optional<Stale> find_placeholder(const Eigen::Ref<const Vector>& values, const Runs& all) {
  constexpr Index kFewest = 5, kLongestRun = 10;
  constexpr double kFar = 20.0, kFarFromUsual = 10.0, kShare = 0.002, kRank = 0.15;
  const auto is_odd = [&](std::size_t k) {
    const Run& run = all.runs[k];
    const double nearest = std::min(std::abs(run.before), std::abs(run.after));
    return run.length <= kLongestRun && (run.before < 0.0) != (run.after < 0.0) &&
           std::abs(run.before + run.after) < 0.5 * nearest && nearest > kFarFromUsual * all.usual &&
           nearest > kFar * around(all, k).small;
  };
  const auto [value, count, odd] = most_common(all, is_odd);
  if (count < kFewest || 2 * count < odd) return std::nullopt;
  // What is lost is lost wherever the signal is; a converter with a dead band returns to 0 from its edge alone.
  std::vector<double> away, lost;
  for (const double one : values) {
    if (one != value) away.push_back(std::abs(one - value));
  }
  for (std::size_t k = 0; k < all.runs.size(); ++k) {
    if (all.runs[k].value == value && is_odd(k)) lost.push_back(std::abs(all.runs[k].before));
  }
  const double edge = quantile(away, kRank);
  if (!(numeric::median(lost) > edge)) return std::nullopt;
  Stale stale{{Staleness::placeholder, 1.0, 0.0, value}, std::vector<bool>(static_cast<std::size_t>(values.size()))};
  for (Index i = 0; i < values.size(); ++i) stale.samples[static_cast<std::size_t>(i)] = values[i] == value;
  stale.updates.share = share_of(stale.samples);
  if (stale.updates.share < kShare) return std::nullopt;
  return stale;
}

// ---- updates at a lower rate than the recording's ----

/// The largest number of samples of which nearly all changes are a whole multiple apart; 0: there is none.
Index period_of(const Runs& all) {
  constexpr double kNearlyAll = 0.95;
  constexpr std::size_t kLongest = 4000, kCommon = 3;
  std::vector<Index> counts(kLongest + 1);
  for (const Run& run : all.runs) ++counts[std::min<std::size_t>(kLongest, static_cast<std::size_t>(run.length))];
  std::vector<Index> common(kLongest);
  std::iota(common.begin(), common.end(), Index{1});
  std::ranges::partial_sort(common, common.begin() + kCommon, std::greater(),
                            [&](Index length) { return counts[static_cast<std::size_t>(length)]; });
  Index best = 0;
  for (std::size_t a = 0; a < kCommon; ++a) {
    for (std::size_t b = a; b < kCommon; ++b) {
      const Index period = std::gcd(common[a], common[b]);
      if (period < 2 || counts[static_cast<std::size_t>(common[b])] == 0 || period <= best) continue;
      std::vector<Index> phases(static_cast<std::size_t>(period));
      for (const Index change : all.changes) ++phases[static_cast<std::size_t>(change % period)];
      const auto most = static_cast<double>(std::ranges::max(phases));
      if (most >= kNearlyAll * static_cast<double>(all.changes.size())) best = period;
    }
  }
  return best;
}

/// The mean interval where nearly all are whole multiples of one, to within a sample or 15 %; 0: they are not.
double mean_period(const Runs& all) {
  constexpr double kShortest = 4.0, kNearlyAll = 0.95, kLoose = 0.15;
  std::vector<double> lengths;
  for (const Run& run : all.runs) lengths.push_back(static_cast<double>(run.length));
  const double median = numeric::median(lengths);
  double sum = 0.0, count = 0.0;
  for (const double length : lengths) {
    if (length < 0.5 * median || length > 1.5 * median) continue;
    sum += length;
    count += 1.0;
  }
  const double period = sum / count;
  if (!(period >= kShortest)) return 0.0;
  const auto near = std::ranges::count_if(lengths, [&](double length) {
    const double multiple = std::max(1.0, std::round(length / period));
    return std::abs(length - multiple * period) <= std::max(1.0, kLoose * period);
  });
  return static_cast<double>(near) >= kNearlyAll * static_cast<double>(lengths.size()) ? period : 0.0;
}

/// Of runs that are longer than a period, a measurement follows every period: it had the same value.
Stale held(double period, const Runs& all, Index samples) {
  Stale stale{{Staleness::held, period}, std::vector<bool>(static_cast<std::size_t>(samples), true)};
  const auto begin_at = [&](Index begin, Index length) {
    for (double at = 0.0; at <= static_cast<double>(length) - 0.5 * period || at == 0.0; at += period) {
      stale.samples[static_cast<std::size_t>(begin + std::min(length - 1, std::lround(at)))] = false;
    }
  };
  begin_at(0, all.changes.front());
  for (const Run& run : all.runs) begin_at(run.begin, run.length);
  begin_at(all.changes.back(), samples - all.changes.back());
  stale.updates.share = share_of(stale.samples);
  return stale;
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

std::optional<Stale> find_held(const Runs& all, Index samples) {
  if (has_few_values(all)) return std::nullopt;
  const auto count = static_cast<double>(all.runs.size());
  const auto part = [&](auto is) { return static_cast<double>(std::ranges::count_if(all.runs, is)) / count; };
  if (part([](const Run& run) { return run.length >= 2; }) <= 0.5) return std::nullopt;
  if (const Index period = period_of(all); period > 0) {
    const double multiples = part([&](const Run& run) { return 10 * run.length >= 17 * period; });
    if (all.varied > 0.1 || multiples > 0.05) return held(static_cast<double>(period), all, samples);
  }
  const double period = all.varied > 0.3 ? mean_period(all) : 0.0;
  if (period == 0.0) return std::nullopt;
  return held(period, all, samples);
}

// ---- repeats and freezes ----

std::vector<double> sizes_of(const Runs& all) {
  std::vector<double> sizes;
  for (const double jump : all.jumps) sizes.push_back(std::abs(jump));
  return sizes;
}

/// Finds repeats and freezes among samples that move.
class Repeats {
 public:
  Repeats(const Runs& all, Index samples) : all_(all), samples_(samples) {
    around_.resize(all.runs.size());
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
      if (all.runs[k].length >= 2 || k % kSampled == 0) around_[k] = around(all, k);
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
  static constexpr std::size_t kSampled = 16;  ///< of runs of one sample, every so many is looked at

  [[nodiscard]] double share(Index count) const { return static_cast<double>(count) / static_cast<double>(samples_); }
  [[nodiscard]] bool at_extreme(const Run& run) const { return run.value == all_.low || run.value == all_.high; }
  /// A signal in steps moves by many of them in each sample.
  [[nodiscard]] bool moves(std::size_t k) const {
    constexpr double kSteps = 4.0;
    return many_sizes_[k / kBlock] && around_[k].scale >= kSteps * all_.least && !at_extreme(all_.runs[k]);
  }
  /// At the value to which the channel returns again and again.
  [[nodiscard]] bool rests(const Run& run) const {
    constexpr Index kFewest = 5;
    constexpr double kOften = 0.3;
    return rest_.runs >= kFewest && static_cast<double>(rest_.runs) > kOften * static_cast<double>(rest_.of) &&
           run.value == rest_.value;
  }

  [[nodiscard]] std::optional<Stale> repeated() const {
    constexpr double kRepeats = 0.12, kMinShare = 0.03;
    Index moving = 0, longer = 0, short_runs = 0, in_short = 0, stale_short = 0, stale_all = 0;
    for (std::size_t k = 0; k < all_.runs.size(); ++k) {
      const Run& run = all_.runs[k];
      if (!moves(k) || rests(run)) continue;
      const Index count = run.length >= 2 ? 1 : Index{kSampled};  // single samples stand for their neighbours
      moving += count;
      longer += run.length >= 2 ? 1 : 0;
      stale_all += run.length - 1;
      if (run.length > kShortRun) continue;
      short_runs += count;
      in_short += count * run.length;
      stale_short += run.length - 1;
    }
    const bool in_passing = short_runs >= kMinChanges && share(stale_short) >= kMinShare &&
                            static_cast<double>(stale_short) > kRepeats * static_cast<double>(in_short);
    const bool mostly = moving >= kMinChanges && share(stale_all) >= kMinShare && all_.varied > 0.3 &&
                        static_cast<double>(longer) > 0.6 * static_cast<double>(moving);
    if (!in_passing && !mostly) return std::nullopt;
    Stale stale{{Staleness::repeated}, std::vector<bool>(static_cast<std::size_t>(samples_))};
    for (std::size_t k = 0; k < all_.runs.size(); ++k) {
      const Run& run = all_.runs[k];
      if (moves(k) && !rests(run) && (mostly || run.length <= kShortRun)) mark(run, 1, stale.samples);
    }
    stale.updates.share = share_of(stale.samples);
    stale.updates.interval = 1.0 / (1.0 - stale.updates.share);
    return stale;
  }

  /// The change behind a run makes up for what it missed: it is far larger than those before and behind, and as large
  /// as motion like theirs is in that time, and the channel does not rest there anyway.
  [[nodiscard]] bool catches_up(std::size_t k) const {
    constexpr Index kShortest = 10, kRest = 5;
    constexpr double kFar = 0.3, kFastest = 5.0;  // of the length of the run
    constexpr std::size_t kBeside = 3;
    const Index length = all_.runs[k].length;
    if (length < kShortest || k < kBeside || k + kBeside >= all_.runs.size()) return false;
    double beside = 0.0;
    for (std::size_t i = 1; i <= kBeside; ++i) {
      if (kRest * std::max(all_.runs[k + i].length, all_.runs[k - i].length) > length) return false;
      beside = std::max({beside, std::abs(all_.jumps[k + 1 + i]), std::abs(all_.jumps[k + 1 - i])});
    }
    const double times = std::abs(all_.jumps[k + 1]) / (static_cast<double>(length) * beside);
    return times >= kFar && times <= kFastest;
  }

  [[nodiscard]] bool freezes(std::size_t k) const {
    constexpr Index kFreeze = 5;
    constexpr int kNoisy = 3;
    const Run& run = all_.runs[k];
    const Around& here = around_[k];
    if (at_extreme(run) || rests(run)) return false;
    return (moves(k) && run.length >= kFreeze && here.turns >= kNoisy) || catches_up(k);
  }

  [[nodiscard]] std::optional<Stale> frozen() const {
    constexpr Index kFewest = 3, kAlike = 3;
    constexpr double kMinShare = 0.01, kOften = 0.3;
    const Common common = most_common(all_, [&](std::size_t k) { return freezes(k); });
    const bool one_value =
        common.runs > 1 && static_cast<double>(common.runs) > kOften * static_cast<double>(common.of);
    std::vector<double> lengths;
    for (std::size_t k = 0; k < all_.runs.size(); ++k) {
      const Run& run = all_.runs[k];
      if (freezes(k) && !(one_value && run.value == common.value)) lengths.push_back(static_cast<double>(run.length));
    }
    if (std::ssize(lengths) < kFewest) return std::nullopt;
    // A channel that freezes does so in other runs of that length, too; one that rests mostly does not freeze.
    const auto found = std::ssize(lengths);
    const double as_long = 0.5 * numeric::median(std::move(lengths));
    Stale stale{{Staleness::frozen}, std::vector<bool>(static_cast<std::size_t>(samples_))};
    Index marked = 0;
    for (std::size_t k = 0; k < all_.runs.size(); ++k) {
      const Run& run = all_.runs[k];
      if ((one_value && run.value == common.value) || at_extreme(run) || rests(run)) continue;
      if (!freezes(k) && static_cast<double>(run.length) < as_long) continue;
      ++marked;
      mark(run, 1, stale.samples);
    }
    if (marked > kAlike * found) return std::nullopt;
    stale.updates.share = share_of(stale.samples);
    if (stale.updates.share < kMinShare) return std::nullopt;
    return stale;
  }

  const Runs& all_;
  Index samples_;
  std::vector<Around> around_;
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
      repeats += change == 0.0 ? 1 : 0;
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
