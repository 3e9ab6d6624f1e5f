#include "mbk/measure/analyse/absorbed_energy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/dsp/savitzky_golay.h"
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
  Vector time;                 ///< [s] from the first sample
  Matrix position;             ///< N×n
  Matrix force;                ///< N×n, F_h
  Matrix reference;            ///< N×n, or empty
  std::vector<bool> unbroken;  ///< intervals without a break
  Vector absorbed;             ///< in each interval; 0 across a break
  Matrix velocity;             ///< N×n; NaN where the smoothing does not reach
  Range window;

  /// Whether energy and velocity are both known throughout an interval.
  [[nodiscard]] bool is_known(Index i) const {
    return unbroken[static_cast<std::size_t>(i)] && velocity.row(i).allFinite() && velocity.row(i + 1).allFinite();
  }
  [[nodiscard]] double step(Index i) const { return time[i + 1] - time[i]; }
  [[nodiscard]] double squared_velocity(Index i) const {
    return 0.5 * step(i) * (velocity.row(i).squaredNorm() + velocity.row(i + 1).squaredNorm());
  }
  [[nodiscard]] double path(Index i) const {
    return 0.5 * step(i) * (velocity.row(i).norm() + velocity.row(i + 1).norm());
  }
};

Index last_sample(const Segment& segment, Index every) {
  return segment.first_sample + (segment.size() - 1) * every;
}

/// The window of the trial, as samples of the recording that it says it was made from.
Result<Range> window_of(const PreparedTrial& trial, const Vector& time) {
  if (trial.segments.empty()) return bad_data("the trial has no row that counts");
  const Segment &first = trial.segments.front(), &last = trial.segments.back();
  const Range range{first.first_sample, last_sample(last, trial.preparation.every)};
  const auto is_row = [&](Index sample, Index row) {
    return sample >= 0 && sample < time.size() && row >= 0 && row < trial.time.size() &&
           std::abs(time[sample] - trial.time[row]) * trial.recording_rate < 0.5;
  };
  if (!is_row(range.first, first.begin) || !is_row(range.last, last.end - 1)) {
    return bad_data("the recording is not the one that the trial was prepared from");
  }
  if (range.last <= range.first) return bad_data("fewer than two samples count", "widen the window");
  return range;
}

/// First derivative by the preparation's own smoothing; never across a break.
Result<Matrix> smoothed_velocity(const Exchange& exchange, const Preparation& how, Hertz rate) {
  const dsp::SavitzkyGolay filter{how.smoothing_order, how.smoothing_window};
  const Index samples = exchange.position.rows();
  Matrix velocity = Matrix::Constant(samples, exchange.position.cols(), kNaN);
  for (Index begin = 0; begin < samples;) {
    Index end = begin + 1;
    while (end < samples && exchange.unbroken[static_cast<std::size_t>(end - 1)]) ++end;
    if (end - begin >= filter.window) {
      auto piece = dsp::savitzky_golay(filter, 1, exchange.position.middleRows(begin, end - begin), rate);
      if (!piece) return tl::unexpected(piece.error());
      velocity.middleRows(begin + filter.half_window(), piece->rows()) = *piece;
    }
    begin = end;
  }
  return velocity;
}

Result<Exchange> exchange_of(const Recording& recording, const PreparedTrial& trial) {
  const Index samples = recording.samples();
  if (samples < 2) {
    return bad_data(fmt::format("{} sample{} cannot show an exchange of energy", samples, samples == 1 ? "" : "s"),
                    "record longer");
  }
  Exchange exchange;
  exchange.position = recorded(recording, kPositionChannels, trial.axes);
  exchange.force = recorded(recording, kForceChannels, trial.axes);
  if (exchange.position.size() == 0) return bad_data("no position was recorded", "say where it is: --channels");
  if (exchange.force.size() == 0) {
    return bad_data("no force was recorded, without which there is no energy", "say where it is: --channels");
  }
  exchange.reference = recorded(recording, kReferenceChannels, trial.axes);
  exchange.time = recording.time.array() - recording.time[0];
  auto window = window_of(trial, exchange.time);
  if (!window) return tl::unexpected(window.error());
  exchange.window = *window;

  exchange.unbroken.resize(static_cast<std::size_t>(samples - 1));
  exchange.absorbed = Vector::Zero(samples - 1);
  const double longest = 1.5 / trial.recording_rate;
  for (Index i = 0; i + 1 < samples; ++i) {
    const double step = exchange.step(i);
    const double work = -0.5 * (exchange.force.row(i) + exchange.force.row(i + 1))
                                   .dot(exchange.position.row(i + 1) - exchange.position.row(i));
    const bool unbroken = step > 0.0 && step <= longest && std::isfinite(work);
    exchange.unbroken[static_cast<std::size_t>(i)] = unbroken;
    if (unbroken) exchange.absorbed[i] = work;
  }
  auto velocity = smoothed_velocity(exchange, trial.preparation, Hertz(trial.recording_rate));
  if (!velocity) return tl::unexpected(velocity.error());
  exchange.velocity = std::move(*velocity);
  return exchange;
}

/// Where a perturbation begins and ends by its steps in the reference, of which the filters took a part. What they took
/// is known, so that the search ends there.
Range perturbation_of(const Exchange& exchange, const Preparation& how, const Segment& segment) {
  Range range{segment.first_sample, last_sample(segment, how.every)};
  const Index half = how.cut_before_filter ? (how.smoothing_window - 1) / 2 : 0, reach = half + how.every - 1;
  if (exchange.reference.size() == 0) return range;
  const auto same = [&](Index a, Index b) { return exchange.reference.row(a) == exchange.reference.row(b); };
  const Index earliest = std::max<Index>(0, range.first - reach),
              latest = std::min(exchange.time.size() - 1, range.last + reach);
  while (range.first > earliest && same(range.first - 1, range.first)) --range.first;
  while (range.last < latest && same(range.last, range.last + 1)) ++range.last;
  return range;
}

/// The window divided equally.
std::vector<Range> equal_ranges(const Exchange& exchange, double block_s) {
  const auto& [first, last] = exchange.window;
  const double duration = exchange.time[last] - exchange.time[first];
  const Index count = std::clamp<Index>(static_cast<Index>(std::llround(duration / block_s)), 1, last - first);
  std::vector<Range> ranges;
  for (Index k = 0; k < count; ++k) {
    ranges.push_back({first + k * (last - first) / count, first + (k + 1) * (last - first) / count});
  }
  return ranges;
}

EnergyPart part_of(const Exchange& exchange, const Range& range) {
  EnergyPart part;
  part.from_s = exchange.time[range.first];
  part.to_s = exchange.time[range.last];
  for (Index i = range.first; i < range.last; ++i) {
    const double distance = (exchange.position.row(i + 1) - exchange.position.row(range.first)).norm();
    if (distance > part.largest_displacement) part.largest_displacement = distance;
    if (!exchange.is_known(i)) continue;
    part.absorbed += exchange.absorbed[i];
    part.path_length += exchange.path(i);
    part.squared_velocity += exchange.squared_velocity(i);
  }
  part.shortage = part.squared_velocity > 0.0 ? -part.absorbed / part.squared_velocity : kNaN;
  return part;
}

/// A block for the bootstrap, unless nothing in it is known.
void add_block(const Exchange& exchange, const Range& range, std::vector<EnergyBlock>& blocks) {
  double duration = 0.0;
  EnergySums sum;
  std::vector<EnergySums> sums;
  for (Index i = range.first; i < range.last; ++i) {
    if (!exchange.is_known(i)) continue;
    duration += exchange.step(i);
    sum.squared_velocity += exchange.squared_velocity(i);
    sum.absorbed += exchange.absorbed[i];
    sums.push_back(sum);
  }
  if (!sums.empty()) blocks.push_back(energy_block(duration, std::move(sums)));
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

/// Blocks that divide the window: from one onset to the next, or the parts themselves.
std::vector<EnergyBlock> blocks_of(const Exchange& exchange, std::vector<Range> parts, bool perturbations) {
  if (perturbations) {
    for (std::size_t k = 0; k + 1 < parts.size(); ++k) parts[k].last = parts[k + 1].first;
    parts.front().first = exchange.window.first;
    parts.back().last = exchange.window.last;
  }
  std::vector<EnergyBlock> blocks;
  for (const Range& range : parts) add_block(exchange, range, blocks);
  return blocks;
}

Result<void> check_motion(const std::vector<EnergyBlock>& blocks) {
  double moved = 0.0;
  for (const EnergyBlock& block : blocks) moved += block.sums.back().squared_velocity;
  if (moved > 0.0) return {};
  return bad_data("the limb never moves in the window, ∫ v·v dt = 0, so that no energy is exchanged",
                  "choose a window with motion");
}

/// When λ is largest, by the same rule as largest_shortage.
double largest_at(const Exchange& exchange, double squared_velocity, double first_share) {
  double s = 0.0, e = 0.0, largest = kNaN, at = kNaN;
  for (Index i = exchange.window.first; i < exchange.window.last; ++i) {
    if (!exchange.is_known(i)) continue;
    s += exchange.squared_velocity(i);
    e += exchange.absorbed[i];
    if (!(s > 0.0 && s >= first_share * squared_velocity) || -e / s <= largest) continue;
    largest = -e / s;
    at = exchange.time[i + 1];
  }
  return at;
}

/// W = ∫ (K_a (x − x₀))·dx with K_a = k_a [0, 1; −1, 0], that is W = −k_a ∫ ((x − x₀) dy − (y − y₀) dx), in each
/// interval; exact along straight lines.
Vector curl_of(const Exchange& exchange, double k_a, const Vector& about) {
  Vector work = Vector::Zero(exchange.absorbed.size());
  for (Index i = 0; i < work.size(); ++i) {
    if (!exchange.unbroken[static_cast<std::size_t>(i)]) continue;
    const Vector a = exchange.position.row(i).transpose() - about, b = exchange.position.row(i + 1).transpose() - about;
    work[i] = -k_a * (a[0] * b[1] - a[1] * b[0]);
  }
  return work;
}

/// ∫ Ḟ·v dt over the window, by increments of the force.
double added_per_delay(const Exchange& exchange) {
  double sum = 0.0;
  for (Index i = exchange.window.first; i < exchange.window.last; ++i) {
    if (!exchange.is_known(i)) continue;
    sum += 0.5 * (exchange.velocity.row(i) + exchange.velocity.row(i + 1))
                     .dot(exchange.force.row(i + 1) - exchange.force.row(i));
  }
  return sum;
}

Vector running_sum(const Vector& increments) {
  Vector sum(increments.size() + 1);
  sum[0] = 0.0;
  for (Index i = 0; i < increments.size(); ++i) sum[i + 1] = sum[i] + increments[i];
  return sum;
}

EnergyCurve curve_of(const Exchange& exchange, const Vector& curl) {
  Matrix sums(exchange.time.size(), curl.size() > 0 ? 2 : 1);
  sums.col(0) = running_sum(exchange.absorbed);
  if (curl.size() > 0) sums.col(1) = running_sum(curl);
  Series shown = decimated(exchange.time, sums, pieces_between_gaps(exchange.time), Decimation::extremes);
  EnergyCurve curve;
  curve.time = std::move(shown.time);
  curve.absorbed = shown.values.col(0);
  if (curl.size() > 0) curve.curl = shown.values.col(1);
  curve.end = sums(sums.rows() - 1, 0);
  return curve;
}

Result<void> check_options(const EnergyOptions& options) {
  if (!(options.block_s > 0.0 && std::isfinite(options.block_s))) {
    return bad_usage(fmt::format("blocks of {:g} s are not longer than 0", options.block_s));
  }
  if (!(options.first_share > 0.0 && options.first_share < 1.0)) {
    return bad_usage(fmt::format("the first share {:g} is not between 0 and 1", options.first_share));
  }
  if (options.replicates < 100) {
    return bad_usage(fmt::format("{} replicates are too few for an interval of 95 %", options.replicates),
                     "take 1000 or more");
  }
  return {};
}

/// Where the antisymmetric force vanishes: the equilibrium or, where K has none, the mean place in the window.
Vector centre_of(const impedance::Model& model, const Exchange& exchange) {
  if (model.x0.size() == exchange.position.cols() && model.x0.allFinite()) return model.x0;
  const auto& [first, last] = exchange.window;
  return exchange.position.middleRows(first, last - first + 1).colwise().mean();
}

}  // namespace

Result<Energy> absorbed_energy(const Recording& recording, const PreparedTrial& trial, const EnergyOptions& options,
                               const impedance::Model* model) {
  if (auto ok = check_options(options); !ok) return tl::unexpected(ok.error());
  const auto exchange = exchange_of(recording, trial);
  if (!exchange) return tl::unexpected(exchange.error());
  const std::vector<Range> parts = parts_of(*exchange, trial, options.block_s);
  const std::vector<EnergyBlock> blocks = blocks_of(*exchange, parts, has_perturbations(trial));
  if (auto ok = check_motion(blocks); !ok) return tl::unexpected(ok.error());

  Energy energy;
  energy.account = account_of(blocks, has_perturbations(trial), options.first_share, options.replicates, options.seed);
  energy.from_s = exchange->time[exchange->window.first];
  energy.to_s = exchange->time[exchange->window.last];
  energy.left_out_s = std::max(0.0, energy.to_s - energy.from_s - energy.account.duration);
  energy.shortage_largest_at_s = largest_at(*exchange, energy.account.squared_velocity, options.first_share);
  energy.added_per_delay = added_per_delay(*exchange);
  energy.delay_that_makes_it_up = energy.account.absorbed / energy.added_per_delay;
  energy.parts_are_perturbations = has_perturbations(trial);
  for (const Range& range : parts) energy.parts.push_back(part_of(*exchange, range));

  Vector curl;
  if (model != nullptr && trial.axes == 2 && model->K.rows() == 2 && model->K.allFinite()) {
    const double k_a = impedance::antisymmetric_part(model->K);
    curl = curl_of(*exchange, k_a, centre_of(*model, *exchange));
    energy.curl = CurlWork{k_a, 0.0, kNaN};
    for (Index i = exchange->window.first; i < exchange->window.last; ++i) {
      if (exchange->is_known(i)) energy.curl->absorbed += curl[i];
    }
    if (energy.account.absorbed != 0.0) energy.curl->share = energy.curl->absorbed / energy.account.absorbed;
  }
  energy.curve = curve_of(*exchange, curl);
  return energy;
}

Result<EnergyAccount> pooled_energy(std::span<const Recording* const> recordings, std::span<const PreparedTrial> trials,
                                    const EnergyOptions& options) {
  if (auto ok = check_options(options); !ok) return tl::unexpected(ok.error());
  if (recordings.empty() || recordings.size() != trials.size()) {
    return bad_usage(
        fmt::format("{} recordings and {} trials do not belong together", recordings.size(), trials.size()));
  }
  std::vector<EnergyBlock> blocks;
  bool perturbations = true;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    if (trials[k].axes != trials[0].axes || trials[k].motion != trials[0].motion) {
      return bad_data("its axes or units are not those of the first file, so energies cannot be pooled",
                      "take it by itself", trials[k].sources.empty() ? "" : trials[k].sources.front().path);
    }
    const auto exchange = exchange_of(*recordings[k], trials[k]);
    if (!exchange) return tl::unexpected(exchange.error());
    const bool own = has_perturbations(trials[k]);
    perturbations = perturbations && own;
    std::vector<EnergyBlock> more = blocks_of(*exchange, parts_of(*exchange, trials[k], options.block_s), own);
    std::ranges::move(more, std::back_inserter(blocks));
  }
  if (auto ok = check_motion(blocks); !ok) return tl::unexpected(ok.error());
  return account_of(blocks, perturbations, options.first_share, options.replicates, options.seed);
}

}  // namespace mbk::analyse
