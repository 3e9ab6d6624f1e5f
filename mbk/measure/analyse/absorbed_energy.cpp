#include "mbk/measure/analyse/absorbed_energy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <future>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/files/contents/disk_pages.h"
#include "mbk/measure/analyse/decimation.h"
#include "mbk/measure/analyse/energy_blocks.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::analyse {
namespace {

/// Samples [first, last] of a recording, both included.
struct Range {
  Index first = 0, last = 0;
};

/// One recording and its window, sample by sample. Interval i lies between samples i and i + 1.
struct Exchange {
  const Vector* clock = nullptr;
  Columns position;            ///< N×n
  Columns force;               ///< N×n, F_h
  Columns reference;           ///< N×n, or empty
  std::vector<bool> unbroken;  ///< intervals without a break
  std::vector<Index> breaks;   ///< the others
  dsp::SavitzkyGolay smoothing;
  Hertz rate;
  Range window;

  [[nodiscard]] Index samples() const { return clock->size(); }
  [[nodiscard]] double time(Index i) const { return (*clock)[i] - (*clock)[0]; }  ///< [s] from the first sample
  [[nodiscard]] double step(Index i) const { return time(i + 1) - time(i); }
  /// −∫ F_h·dx, whether or not there is a break.
  [[nodiscard]] double work(Index i) const {
    double sum = 0.0;
    for (Index k = 0; k < position.cols(); ++k) {
      sum += -0.5 * (force(i, k) + force(i + 1, k)) * (position(i + 1, k) - position(i, k));
    }
    return sum;
  }
  /// 0 across a break.
  [[nodiscard]] double absorbed(Index i) const { return unbroken[static_cast<std::size_t>(i)] ? work(i) : 0.0; }
};

/// What the intervals bring, and the first derivative of the position by the preparation's own smoothing, never across
/// a break; made block by block, for whoever walks along the samples in their order.
class Intervals {
 public:
  static constexpr Index kBlock = 1 << 18;
  /// @param at_once  samples of a block
  explicit Intervals(const Exchange& exchange, Index at_once = kBlock) : exchange_(exchange), at_once_(at_once) {}

  /// Interval i, of which the values below speak from now on; false where its energy or velocity is not known
  /// throughout.
  [[nodiscard]] bool reach(Index i) {
    if (i < begin_ || i + 1 >= begin_ + velocity_.rows()) load(i + 1);
    at_ = i - begin_;
    return std::isfinite(squared_[at_]);
  }
  [[nodiscard]] double absorbed() const { return absorbed_[at_]; }
  [[nodiscard]] double squared() const { return squared_[at_]; }  ///< ∫ v·v dt
  [[nodiscard]] double path() const { return path_[at_]; }        ///< ∫ |v| dt
  /// The sum of the velocities at both ends, along an axis.
  [[nodiscard]] double velocities(Index axis) const { return velocity_(at_, axis) + velocity_(at_ + 1, axis); }

 private:
  /// Rows from a little before sample i on, so that a few steps back need no other block; all of a short recording.
  void load(Index i) {
    const Index samples = exchange_.samples();
    begin_ = samples <= at_once_ ? 0 : std::max<Index>(0, i - std::max<Index>(1, at_once_ / 8));
    const Index end = std::min(samples, begin_ + at_once_);
    differentiate(end);
    integrate(end);
  }

  /// N×n; NaN where the smoothing does not reach.
  void differentiate(Index end) {
    const Index half = exchange_.smoothing.half_window();
    velocity_.setConstant(end - begin_, exchange_.position.cols(), kNaN);
    auto broken = std::ranges::lower_bound(exchange_.breaks, begin_);
    Index first = broken == exchange_.breaks.begin() ? 0 : *std::prev(broken) + 1;  // of the samples without a break
    while (first < end) {
      const Index last = broken == exchange_.breaks.end() ? exchange_.samples() : *broken + 1;
      const Index from = std::max(begin_, first + half), to = std::min(end, last - half);
      if (last - first >= exchange_.smoothing.window && from < to) {
        const auto piece = dsp::savitzky_golay(
            exchange_.smoothing, 1, exchange_.position.middle_rows(from - half, to - from + 2 * half), exchange_.rate);
        if (piece) velocity_.middleRows(from - begin_, to - from) = *piece;  // such filters were tried
      }
      first = last;
      if (broken != exchange_.breaks.end()) ++broken;
    }
  }

  void integrate(Index end) {
    const Index count = std::max<Index>(0, end - begin_ - 1);
    const auto time = exchange_.clock->segment(begin_, end - begin_).array() - (*exchange_.clock)[0];
    const Eigen::ArrayXd half_step = 0.5 * (time.tail(count) - time.head(count));
    squared_ = velocity_.rowwise().squaredNorm();  // at the samples, to begin with
    path_ = squared_.sqrt();
    squared_.head(count) = half_step * (squared_.head(count) + squared_.tail(count));
    path_.head(count) = half_step * (path_.head(count) + path_.tail(count));
    absorbed_.setZero(count);
    for (Index k = 0; k < exchange_.position.cols(); ++k) {
      const auto place = exchange_.position.col(k).segment(begin_, end - begin_).array();
      const auto force = exchange_.force.col(k).segment(begin_, end - begin_).array();
      absorbed_ -= 0.5 * (force.head(count) + force.tail(count)) * (place.tail(count) - place.head(count));
    }
    const auto from = std::ranges::lower_bound(exchange_.breaks, begin_),
               to = std::ranges::lower_bound(exchange_.breaks, begin_ + count);
    for (auto broken = from; broken != to; ++broken) squared_[*broken - begin_] = kNaN;
  }

  const Exchange& exchange_;
  Index at_once_, begin_ = 0, at_ = 0;
  Matrix velocity_;
  Eigen::ArrayXd squared_;  ///< NaN where the interval is not known
  Eigen::ArrayXd path_, absorbed_;
};

Index last_sample(const Segment& segment, Index every) {
  return segment.first_sample + (segment.size() - 1) * every;
}

/// The window of the trial, as samples of the recording that it says it was made from.
Result<Range> window_of(const PreparedTrial& trial, const Exchange& exchange) {
  if (trial.segments.empty()) return bad_data("the trial has no rows in the analysed interval");
  const Segment &first = trial.segments.front(), &last = trial.segments.back();
  const Range range{first.first_sample, last_sample(last, trial.preparation.every)};
  const auto is_row = [&](Index sample, Index row) {
    return sample >= 0 && sample < exchange.samples() && row >= 0 && row < trial.time.size() &&
           std::abs(exchange.time(sample) - trial.time[row]) * trial.recording_rate < 0.5;
  };
  if (!is_row(range.first, first.begin) || !is_row(range.last, last.end - 1)) {
    return bad_data("the trial was prepared from another recording");
  }
  if (range.last <= range.first) return bad_data("the window contains fewer than two samples", "widen the window");
  return range;
}

Result<Exchange> exchange_of(const Recording& recording, const PreparedTrial& trial) {
  const Index samples = recording.samples();
  if (samples < 2) {
    return bad_data(fmt::format("{} sample{} cannot show an exchange of energy", samples, samples == 1 ? "" : "s"),
                    "record longer");
  }
  Exchange exchange;
  exchange.position = channels_of(recording, kPositionChannels, trial.axes);
  exchange.force = channels_of(recording, kForceChannels, trial.axes);
  if (exchange.position.size() == 0) return bad_data("no position was recorded", "name its column with --channels");
  if (exchange.force.size() == 0) {
    return bad_data("no force was recorded, so the energy cannot be computed", "name its column with --channels");
  }
  exchange.reference = channels_of(recording, kReferenceChannels, trial.axes);
  exchange.clock = &recording.time;
  auto window = MBK_TRY(window_of(trial, exchange));
  exchange.window = window;

  exchange.unbroken.resize(static_cast<std::size_t>(samples - 1));
  const double longest = 1.5 / trial.recording_rate;
  for (Index i = 0; i + 1 < samples; ++i) {
    const double step = exchange.step(i);
    const bool unbroken = step > 0.0 && step <= longest && std::isfinite(exchange.work(i));
    exchange.unbroken[static_cast<std::size_t>(i)] = unbroken;
    if (!unbroken) exchange.breaks.push_back(i);
  }
  exchange.smoothing = {trial.preparation.smoothing_order, trial.preparation.smoothing_window};
  exchange.rate = Hertz(trial.recording_rate);
  MBK_TRY(dsp::savitzky_golay_weights(exchange.smoothing, 1));
  return exchange;
}

/// Where a perturbation begins and ends by its steps in the reference, of which the filters took a part. What they took
/// is known, so that the search ends there.
Range perturbation_of(const Exchange& exchange, const Preparation& how, const Segment& segment) {
  Range range{segment.first_sample, last_sample(segment, how.every)};
  const Index half = how.cut_before_filter ? (how.smoothing_window - 1) / 2 : 0, reach = half + how.every - 1;
  if (exchange.reference.size() == 0) return range;
  const auto same = [&](Index a, Index b) {
    for (Index k = 0; k < exchange.reference.cols(); ++k) {
      if (exchange.reference(a, k) != exchange.reference(b, k)) return false;
    }
    return true;
  };
  const Index earliest = std::max<Index>(0, range.first - reach),
              latest = std::min(exchange.samples() - 1, range.last + reach);
  while (range.first > earliest && same(range.first - 1, range.first)) --range.first;
  while (range.last < latest && same(range.last, range.last + 1)) ++range.last;
  return range;
}

/// The window divided equally.
std::vector<Range> equal_ranges(const Exchange& exchange, double block_s) {
  const auto& [first, last] = exchange.window;
  const double duration = exchange.time(last) - exchange.time(first);
  const Index count = std::clamp<Index>(static_cast<Index>(std::llround(duration / block_s)), 1, last - first);
  std::vector<Range> ranges;
  for (Index k = 0; k < count; ++k) {
    ranges.push_back({first + k * (last - first) / count, first + (k + 1) * (last - first) / count});
  }
  return ranges;
}

EnergyPart part_of(const Exchange& exchange, Intervals& intervals, const Range& range) {
  EnergyPart part;
  part.from_s = exchange.time(range.first);
  part.to_s = exchange.time(range.last);
  double farthest = 0.0;  // squared
  for (Index i = range.first; i < range.last; ++i) {
    double distance = 0.0;
    for (Index k = 0; k < exchange.position.cols(); ++k) {
      const double away = exchange.position(i + 1, k) - exchange.position(range.first, k);
      distance += away * away;
    }
    if (distance > farthest) farthest = distance;
    if (!intervals.reach(i)) continue;
    part.absorbed += intervals.absorbed();
    part.path_length += intervals.path();
    part.squared_velocity += intervals.squared();
  }
  part.largest_displacement = std::sqrt(farthest);
  part.shortage = part.squared_velocity > 0.0 ? -part.absorbed / part.squared_velocity : kNaN;
  return part;
}

/// The sums of a range after each of its intervals that are known, and how long those are [s].
std::pair<std::vector<EnergySums>, double> sums_of(const Exchange& exchange, Intervals& intervals, const Range& range) {
  double duration = 0.0;
  EnergySums sum;
  std::vector<EnergySums> sums;
  sums.reserve(static_cast<std::size_t>(range.last - range.first));
  for (Index i = range.first; i < range.last; ++i) {
    if (!intervals.reach(i)) continue;
    duration += exchange.step(i);
    sum.squared_velocity += intervals.squared();
    sum.absorbed += intervals.absorbed();
    sums.push_back(sum);
  }
  return {std::move(sums), duration};
}

bool has_perturbations(const PreparedTrial& trial) {
  return trial.preparation.protocol == Protocol::underdamped;
}

/// Parts that are shown: perturbations, or equal blocks.
std::vector<Range> parts_of(const Exchange& exchange, const PreparedTrial& trial, double block_s) {
  if (!has_perturbations(trial)) return equal_ranges(exchange, block_s);
  std::vector<Range> parts;
  for (const Segment& segment : trial.segments) {
    parts.push_back(perturbation_of(exchange, trial.preparation, segment));
  }
  return parts;
}

/// The parts that are shown, and the blocks for the bootstrap, of each range in which something is known: the parts
/// themselves or, with perturbations, from one onset to the next, so that they divide the window.
struct Division {
  std::vector<EnergyPart> parts;
  std::vector<EnergyBlock> blocks;
};

/// The first blocks are kept as they are; of what is beyond, in a long recording, only the outline: the bootstrap looks
/// into few of them.
Division divide(const std::shared_ptr<const Exchange>& exchange, Intervals& intervals, const PreparedTrial& trial,
                double block_s) {
  constexpr std::size_t kKept = std::size_t{1} << 20;  // sums
  std::vector<Range> ranges = parts_of(*exchange, trial, block_s);
  Division division;
  if (has_perturbations(trial)) {
    for (const Range& range : ranges) division.parts.push_back(part_of(*exchange, intervals, range));
    for (std::size_t k = 0; k + 1 < ranges.size(); ++k) ranges[k].last = ranges[k + 1].first;
    ranges.front().first = exchange->window.first;
    ranges.back().last = exchange->window.last;
  }
  std::size_t kept = 0;
  for (const Range& range : ranges) {
    if (!has_perturbations(trial)) division.parts.push_back(part_of(*exchange, intervals, range));
    auto [sums, duration] = sums_of(*exchange, intervals, range);
    if (sums.empty()) continue;
    kept += sums.size();
    EnergyBlock block = energy_block(duration, std::move(sums));
    if (kept > kKept) {
      block = outline(std::move(block), [exchange, range] {
        Intervals here(*exchange, 2 * (range.last - range.first + 2));
        auto inside = sums_of(*exchange, here, range).first;
        return inside;
      });
    }
    division.blocks.push_back(std::move(block));
  }
  return division;
}

Result<void> check_motion(const std::vector<EnergyBlock>& blocks) {
  double moved = 0.0;
  for (const EnergyBlock& block : blocks) moved += block.total.squared_velocity;
  if (moved > 0.0) return {};
  return bad_data("the limb does not move in the window (∫ v·v dt = 0), so no energy is exchanged",
                  "choose a window with motion");
}

/// W = ∫ (K_a (x − x₀))·dx with K_a = k_a [0, 1; −1, 0], that is W = −k_a ∫ ((x − x₀) dy − (y − y₀) dx), in each
/// interval; exact along straight lines.
struct Curl {
  double k_a = 0;  ///< [N/m]
  Vector about;    ///< x₀

  /// 0 across a break.
  [[nodiscard]] double work(const Exchange& exchange, Index i) const {
    if (!exchange.unbroken[static_cast<std::size_t>(i)]) return 0.0;
    const auto from = [&](Index sample, Index axis) { return exchange.position(sample, axis) - about[axis]; };
    return -k_a * (from(i, 0) * from(i + 1, 1) - from(i, 1) * from(i + 1, 0));
  }
};

/// What a second walk along the window finds.
struct Afterwards {
  double largest_at = kNaN;      ///< when λ is largest, by the same rule as largest_shortage
  double added_per_delay = 0.0;  ///< ∫ Ḟ·v dt, by increments of the force
  double curl = 0.0;             ///< work of the antisymmetric stiffness
};

/// @param first  ∫ v·v dt from which on λ counts
Afterwards walk_again(const Exchange& exchange, Intervals& intervals, double first, const std::optional<Curl>& curl) {
  Afterwards found;
  double s = 0.0, e = 0.0, largest = kNaN;
  for (Index i = exchange.window.first; i < exchange.window.last; ++i) {
    if (!intervals.reach(i)) continue;
    s += intervals.squared();
    e += intervals.absorbed();
    double product = 0.0;
    for (Index k = 0; k < exchange.force.cols(); ++k) {
      product += intervals.velocities(k) * (exchange.force(i + 1, k) - exchange.force(i, k));
    }
    found.added_per_delay += 0.5 * product;
    if (curl) found.curl += curl->work(exchange, i);
    if (!(s > 0.0 && s >= first) || -e / s <= largest) continue;
    largest = -e / s;
    found.largest_at = exchange.time(i + 1);
  }
  return found;
}

EnergyCurve curve_of(const Exchange& exchange, const std::optional<Curl>& curl) {
  EnergyCurve curve;
  double absorbed = 0.0, of_curl = 0.0;
  const auto running = [&](Index begin, Eigen::Ref<Matrix> sums) {
    for (Index row = 0; row < sums.rows(); ++row) {
      if (begin + row > 0) {
        absorbed += exchange.absorbed(begin + row - 1);
        if (curl) of_curl += curl->work(exchange, begin + row - 1);
      }
      sums(row, 0) = absorbed;
      if (curl) sums(row, 1) = of_curl;
    }
  };
  const std::vector<Rows> pieces = pieces_between_gaps(*exchange.clock);
  Series shown = decimated_in_passing(*exchange.clock, curl ? 2 : 1, running, pieces, Decimation::extremes);
  curve.time = shown.time.array() - (*exchange.clock)[0];
  curve.absorbed = shown.values.col(0);
  if (curl) curve.curl = shown.values.col(1);
  curve.end = absorbed;
  return curve;
}

Result<void> check_options(const EnergyOptions& options) {
  if (!(options.block_s > 0.0 && std::isfinite(options.block_s))) {
    return bad_usage(fmt::format("the block length of {:g} s is not above 0", options.block_s));
  }
  if (!(options.first_share > 0.0 && options.first_share < 1.0)) {
    return bad_usage(fmt::format("the first share, {:g}, is not between 0 and 1", options.first_share));
  }
  if (options.replicates < 100) {
    return bad_usage(fmt::format("{} replicates are too few for a 95 % interval", options.replicates),
                     "use 1000 or more");
  }
  return {};
}

/// Where the antisymmetric force vanishes: the equilibrium or, where K has none, the mean place in the window.
Vector centre_of(const impedance::Model& model, const Exchange& exchange) {
  if (model.x0.size() == exchange.position.cols() && model.x0.allFinite()) return model.x0;
  const auto& [first, last] = exchange.window;
  Vector mean(exchange.position.cols());
  for (Index k = 0; k < mean.size(); ++k) {
    mean[k] = exchange.position.col(k).segment(first, last - first + 1).mean();
  }
  return mean;
}

}  // namespace

Result<Energy> absorbed_energy(const Recording& recording, const PreparedTrial& trial, const EnergyOptions& options,
                               const impedance::Model* model) {
  MBK_TRY(check_options(options));
  auto made = MBK_TRY(exchange_of(recording, trial));
  const auto exchange = std::make_shared<const Exchange>(std::move(made));
  std::optional<Curl> curl;
  if (model != nullptr && trial.axes == 2 && model->K.rows() == 2 && model->K.allFinite()) {
    curl = Curl{impedance::antisymmetric_part(model->K), centre_of(*model, *exchange)};
  }
  // Of a long recording by a thread of its own, where the system has one left.
  const auto when =
      exchange->samples() > recording::kLong ? std::launch::async | std::launch::deferred : std::launch::deferred;
  auto curve = std::async(when, [&exchange, &curl] { return curve_of(*exchange, curl); });
  Intervals intervals(*exchange);
  const auto [parts, blocks] = divide(exchange, intervals, trial, options.block_s);
  MBK_TRY(check_motion(blocks));

  Energy energy;
  energy.account = account_of(blocks, has_perturbations(trial), options.first_share, options.replicates, options.seed);
  const Afterwards found =
      walk_again(*exchange, intervals, options.first_share * energy.account.squared_velocity, curl);
  energy.from_s = exchange->time(exchange->window.first);
  energy.to_s = exchange->time(exchange->window.last);
  energy.left_out_s = std::max(0.0, energy.to_s - energy.from_s - energy.account.duration);
  energy.shortage_largest_at_s = found.largest_at;
  energy.added_per_delay = found.added_per_delay;
  energy.delay_that_makes_it_up = energy.account.absorbed / energy.added_per_delay;
  energy.parts_are_perturbations = has_perturbations(trial);
  energy.parts = parts;
  if (curl) {
    energy.curl = CurlWork{curl->k_a, found.curl, kNaN};
    if (energy.account.absorbed != 0.0) energy.curl->share = energy.curl->absorbed / energy.account.absorbed;
  }
  energy.curve = curve.get();
  return energy;
}

Result<EnergyAccount> pooled_energy(std::span<const Recording* const> recordings, std::span<const PreparedTrial> trials,
                                    const EnergyOptions& options) {
  MBK_TRY(check_options(options));
  if (recordings.empty() || recordings.size() != trials.size()) {
    return bad_usage(
        fmt::format("{} recordings and {} trials do not belong together", recordings.size(), trials.size()));
  }
  std::vector<EnergyBlock> blocks;
  bool perturbations = true;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    if (trials[k].axes != trials[0].axes || trials[k].motion != trials[0].motion) {
      return bad_data("its axes or units differ from those of the first file, so the energies cannot be pooled",
                      "analyse it separately", trials[k].sources.empty() ? "" : trials[k].sources.front().label());
    }
    auto made = MBK_TRY(exchange_of(*recordings[k], trials[k]));
    const auto exchange = std::make_shared<const Exchange>(std::move(made));
    Intervals intervals(*exchange);
    const bool own = has_perturbations(trials[k]);
    perturbations = perturbations && own;
    std::vector<EnergyBlock> more = divide(exchange, intervals, trials[k], options.block_s).blocks;
    std::ranges::move(more, std::back_inserter(blocks));
  }
  MBK_TRY(check_motion(blocks));
  return account_of(blocks, perturbations, options.first_share, options.replicates, options.seed);
}

}  // namespace mbk::analyse
