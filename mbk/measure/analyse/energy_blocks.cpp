#include "mbk/measure/analyse/energy_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::analyse {
namespace {

constexpr std::size_t kEnoughBlocks = 6;  ///< that they agree in sign by chance: 2⁻⁶ = 1.6 % < 2.5 %

/// b does not stand above the line from a to c, as points (S, −E); where a and b have the same S, not above a.
bool below_line(const EnergySums& a, const EnergySums& b, const EnergySums& c) {
  if (a.squared_velocity == b.squared_velocity) return b.absorbed >= a.absorbed;
  const double ab_s = b.squared_velocity - a.squared_velocity, ab_e = a.absorbed - b.absorbed,
               ac_s = c.squared_velocity - a.squared_velocity, ac_e = a.absorbed - c.absorbed;
  return ab_e * ac_s <= ac_e * ab_s;
}

/// For each point the next vertex of the upper hull of the points from it on; its own number where there is none.
std::vector<std::size_t> next_vertices(const std::vector<EnergySums>& points) {
  std::vector<std::size_t> next(points.size());
  std::iota(next.begin(), next.end(), 0U);
  for (std::size_t i = points.size() - 1; i-- > 0;) {
    std::size_t vertex = i + 1;
    while (next[vertex] != vertex && below_line(points[i], points[vertex], points[next[vertex]])) vertex = next[vertex];
    next[i] = vertex;
  }
  return next;
}

/// Vertices of the upper hull of the samples from one on.
std::vector<EnergySums> hull_from(const EnergyBlock& block, std::size_t vertex) {
  std::vector<EnergySums> hull = {block.sums[vertex]};
  for (; block.next[vertex] != vertex; vertex = block.next[vertex]) {
    hull.push_back(block.sums[block.next[vertex]]);
  }
  return hull;
}

/// Raises the largest λ, or NaN, to that in a block with S from `first` on, which it reaches in it. The sums before the
/// block are those.
/// @param cut  whether the block holds samples at which S has not reached `first`
void look_into(const EnergyBlock& block, const EnergySums& before, double first, bool cut, double& largest) {
  // Along the hull the slope rises to the vertex that the steepest line touches, and falls from there on.
  double highest = -std::numeric_limits<double>::infinity();
  const auto rises = [&](const EnergySums& sum) {
    const double shortage = -(before.absorbed + sum.absorbed) / (before.squared_velocity + sum.squared_velocity);
    if (shortage < highest) return false;
    highest = shortage;
    return true;
  };
  if (cut) {
    const auto too_early = [&](const EnergySums& sum) {
      return before.squared_velocity + sum.squared_velocity < first;
    };
    auto vertex = static_cast<std::size_t>(std::ranges::partition_point(block.sums, too_early) - block.sums.begin());
    while (rises(block.sums[vertex]) && block.next[vertex] != vertex) vertex = block.next[vertex];
  } else {
    std::ranges::find_if_not(block.hull, rises);
  }
  if (!(highest <= largest)) largest = highest;
}

/// What a bootstrap is about.
struct Totals {
  double duration = 0, squared_velocity = 0, absorbed = 0, shortage_largest = kNaN;
  [[nodiscard]] double mean_power() const { return absorbed / duration; }
  [[nodiscard]] double shortage_at_end() const { return -absorbed / squared_velocity; }
};

/// Puts the same blocks together in many orders.
class Assembly {
 public:
  Assembly(const std::vector<EnergyBlock>& blocks, double first_share) : blocks_(blocks), first_share_(first_share) {
    EnergySums all;
    for (const EnergyBlock& block : blocks) {
      all.squared_velocity += block.total.squared_velocity;
      all.absorbed += block.total.absorbed;
    }
    usual_ = all.squared_velocity > 0.0 ? -all.absorbed / all.squared_velocity : 0.0;
    for (const EnergyBlock& block : blocks) {
      double above = -std::numeric_limits<double>::infinity();
      for (const EnergySums& sum : block.hull) {
        above = std::max(above, -sum.absorbed - usual_ * sum.squared_velocity);
      }
      bounds_.push_back({block.duration, block.total, block.hull.front().squared_velocity, above});
    }
  }

  /// @param order  as of largest_shortage
  [[nodiscard]] Totals totals(const std::vector<std::size_t>& order) const {
    Totals totals;
    for (const std::size_t k : order) {
      const Bounds& block = bounds_[k];
      totals.duration += block.duration;
      totals.squared_velocity += block.total.squared_velocity;
      totals.absorbed += block.total.absorbed;
    }
    totals.shortage_largest = largest(order, totals.squared_velocity);
    return totals;
  }

 private:
  /// Of a block, all that most orders ask for.
  struct Bounds {
    double duration;  ///< [s]
    EnergySums total;
    double first_squared_velocity;  ///< S at the first sample
    double above;                   ///< the largest −E − usual_·S
  };

  /// As largest_shortage.
  /// @param end  S of all that are in the order
  [[nodiscard]] double largest(const std::vector<std::size_t>& order, double end) const {
    if (!(end > 0.0)) return kNaN;
    const double first = first_share_ * end;
    double largest = kNaN;
    std::optional<std::size_t> cut;  // the block in which S reaches `first`, where not at its first sample
    EnergySums before, before_cut;
    for (const std::size_t k : order) {
      const Bounds& block = bounds_[k];
      const EnergySums after = {before.squared_velocity + block.total.squared_velocity,
                                before.absorbed + block.total.absorbed};
      if (after.squared_velocity >= first) {
        if (before.squared_velocity + block.first_squared_velocity < first) {
          cut = k;
          before_cut = before;
        } else if (!stays_below(block, before, largest)) {
          look_into(blocks_[k], before, first, false, largest);
        }
      }
      before = after;
    }
    // It is looked into last, for that takes longest, and then it matters least often.
    if (cut && !stays_below(bounds_[*cut], before_cut, largest)) {
      const EnergyBlock& block = blocks_[*cut];
      if (block.sums.empty()) {
        look_into(energy_block(block.duration, block.again()), before_cut, first, true, largest);
      } else {
        look_into(block, before_cut, first, true, largest);
      }
    }
    return largest;
  }

  /// No λ in a block is above `slope`: no point of it stands above the line of that slope through (−S₀, E₀). How far
  /// points stand above a line of another slope is known, and within the block both lines part by little.
  [[nodiscard]] bool stays_below(const Bounds& block, const EnergySums& before, double slope) const {
    const double parted = usual_ - slope;
    const double farthest = parted > 0.0 ? block.total.squared_velocity : block.first_squared_velocity;
    return block.above + parted * farthest <= before.absorbed + slope * before.squared_velocity;
  }

  const std::vector<EnergyBlock>& blocks_;
  double first_share_;
  double usual_;  ///< λ of all blocks at their end
  std::vector<Bounds> bounds_;
};

/// Puts the first and the last sixteenth in order, where all percentiles below stand, and what is between them between.
void sort_ends(std::vector<double>& values) {
  const std::ptrdiff_t end = std::ssize(values) / 16 + 2;
  if (2 * end >= std::ssize(values)) {
    std::ranges::sort(values);
    return;
  }
  std::ranges::nth_element(values, values.begin() + end);
  std::ranges::nth_element(values.begin() + end, values.end() - end, values.end());
  std::sort(values.begin(), values.begin() + end);
  std::sort(values.end() - end, values.end());
}

/// Percentiles of the bootstrap, widened for few blocks: of n blocks it finds a variance that is (n − 1)/n of the true
/// one on average, and normal quantiles in place of Student's (Hesterberg 2015, "expanded percentile interval").
class Percentiles {
 public:
  explicit Percentiles(std::size_t blocks) : blocks_(static_cast<double>(blocks)) {}

  [[nodiscard]] double at(const Vector& sorted, double p) const {
    const double widened = std::sqrt(blocks_ / (blocks_ - 1.0)) * numeric::student_quantile(p, degrees_of_freedom());
    return numeric::quantile(sorted, numeric::normal_probability(widened));
  }
  [[nodiscard]] Interval interval95(const Vector& sorted) const { return {at(sorted, 0.025), at(sorted, 0.975)}; }

 private:
  [[nodiscard]] int degrees_of_freedom() const { return static_cast<int>(blocks_) - 1; }
  double blocks_;
};

void add_intervals(std::size_t blocks, const Assembly& assembly, int replicates, std::uint64_t seed,
                   EnergyAccount& account) {
  numeric::Random random(seed);
  Matrix drawn(replicates, 4);
  std::vector<std::size_t> order(blocks);
  for (Index i = 0; i < replicates; ++i) {
    for (std::size_t& k : order) k = static_cast<std::size_t>(random.below(blocks));
    const Totals totals = assembly.totals(order);
    drawn.row(i) << totals.absorbed, totals.mean_power(), totals.shortage_at_end(), totals.shortage_largest;
  }
  std::array<Vector, 4> sorted;
  for (Index column = 0; column < 4; ++column) {
    // A draw of blocks in which nothing moves has no shortage.
    std::vector<double> known;
    for (const double value : drawn.col(column)) {
      if (std::isfinite(value)) known.push_back(value);
    }
    sort_ends(known);
    sorted[static_cast<std::size_t>(column)] = Eigen::Map<const Vector>(known.data(), static_cast<Index>(known.size()));
  }
  const Percentiles percentiles(blocks);
  account.absorbed95 = percentiles.interval95(sorted[0]);
  account.lower95 = percentiles.at(sorted[0], 0.05);
  account.upper95 = percentiles.at(sorted[0], 0.95);
  account.mean_power95 = percentiles.interval95(sorted[1]);
  account.shortage_at_end95 = percentiles.interval95(sorted[2]);
  account.shortage_largest95 = percentiles.interval95(sorted[3]);
}

void decide(bool perturbations, EnergyAccount& account) {
  const char* const what = perturbations ? "perturbation" : "block";
  if (account.blocks < static_cast<Index>(kEnoughBlocks)) {
    account.reason = fmt::format("only {} {}{}; at least {} are needed to show how the energy varies", account.blocks,
                                 what, account.blocks == 1 ? "" : "s", kEnoughBlocks);
    return;
  }
  account.verdict = verdict_of(account.absorbed95);
  account.reason = fmt::format("the 95 % interval over {} {}s {}", account.blocks, what,
                               account.verdict == Verdict::passive  ? "is above zero"
                               : account.verdict == Verdict::active ? "is below zero"
                                                                    : "includes zero");
}

}  // namespace

EnergyBlock energy_block(double duration, std::vector<EnergySums> sums) {
  EnergyBlock block;
  block.duration = duration;
  block.total = sums.back();
  block.next = next_vertices(sums);
  block.sums = std::move(sums);
  block.hull = hull_from(block, 0);
  return block;
}

EnergyBlock outline(EnergyBlock block, std::function<std::vector<EnergySums>()> again) {
  block.again = std::move(again);
  block.sums = std::vector<EnergySums>();  // which gives the memory back, where "= {}" keeps it
  block.next = std::vector<std::size_t>();
  return block;
}

double largest_shortage(const std::vector<EnergyBlock>& blocks, const std::vector<std::size_t>& order,
                        double first_share) {
  return Assembly(blocks, first_share).totals(order).shortage_largest;
}

EnergyAccount account_of(const std::vector<EnergyBlock>& blocks, bool perturbations, double first_share, int replicates,
                         std::uint64_t seed) {
  std::vector<std::size_t> in_order(blocks.size());
  std::iota(in_order.begin(), in_order.end(), 0U);
  const Assembly assembly(blocks, first_share);
  const Totals totals = assembly.totals(in_order);
  EnergyAccount account;
  account.duration = totals.duration;
  account.absorbed = totals.absorbed;
  account.mean_power = totals.mean_power();
  account.squared_velocity = totals.squared_velocity;
  account.shortage_at_end = totals.shortage_at_end();
  account.shortage_largest = totals.shortage_largest;
  account.blocks = static_cast<Index>(blocks.size());
  account.absorbed95 = account.mean_power95 = account.shortage_at_end95 = account.shortage_largest95 = {kNaN, kNaN};
  account.lower95 = account.upper95 = kNaN;
  if (blocks.size() >= kEnoughBlocks) add_intervals(blocks.size(), assembly, replicates, seed, account);
  decide(perturbations, account);
  return account;
}

}  // namespace mbk::analyse
