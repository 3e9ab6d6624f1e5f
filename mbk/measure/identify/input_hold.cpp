#include "mbk/measure/identify/input_hold.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace mbk::identify {
namespace {

constexpr double kAsLarge = 0.5;  // a jump over the standard deviation of the input

struct Jumps {
  std::vector<Index> at;  ///< samples
  double share = 0;       ///< of Σ(Δu)²
  double rms = 0, least = std::numeric_limits<double>::infinity(), greatest = 0;
};

/// Changes that are ten times as large as both of their neighbours.
Jumps jumps_between_rests(const Vector& change) {
  constexpr double kAlone = 10.0;
  Jumps jumps;
  double squares = 0.0;
  for (Index i = 1; i + 1 < change.size(); ++i) {
    const double size = std::abs(change[i]);
    if (size == 0.0 || size < kAlone * std::max(std::abs(change[i - 1]), std::abs(change[i + 1]))) continue;
    jumps.at.push_back(i);
    jumps.least = std::min(jumps.least, size);
    jumps.greatest = std::max(jumps.greatest, size);
    squares += size * size;
  }
  jumps.share = squares / change.squaredNorm();
  jumps.rms = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(jumps.at.size(), 1)));
  return jumps;
}

/// Whether there are enough jumps to tell, all a multiple of two or more samples apart, and not all of one size.
bool have_a_clock(const Jumps& jumps) {
  constexpr std::size_t kEnough = 10;
  constexpr double kOneSize = 1.01;
  if (jumps.at.size() < kEnough || jumps.greatest <= kOneSize * jumps.least) return false;
  Index period = 0;
  for (std::size_t k = 1; k < jumps.at.size(); ++k) period = std::gcd(period, jumps.at[k] - jumps.at[k - 1]);
  return period >= 2;
}

/// Whether the input takes few values, and jumps by as much as it varies where it changes.
bool switches(const Vector& input, const Vector& change, double deviation) {
  constexpr std::size_t kFew = 8;
  std::set<double> values;
  for (const double u : input) {
    values.insert(u);
    if (values.size() > kFew) return false;
  }
  const auto changes = static_cast<double>((change.array() != 0.0).count());
  return std::sqrt(change.squaredNorm() / std::max(changes, 1.0)) >= kAsLarge * deviation;
}

bool is_held(const Vector& input) {
  const Index n = input.size();
  if (n < 3) return false;
  const Vector change = input.tail(n - 1) - input.head(n - 1);
  const double deviation = std::sqrt((input.array() - input.mean()).square().mean());
  if (!(deviation > 0.0)) return false;
  if (switches(input, change, deviation)) return true;
  constexpr double kMax = 0.9;
  const Jumps jumps = jumps_between_rests(change);
  return jumps.share >= kMax && (jumps.rms >= kAsLarge * deviation || have_a_clock(jumps));
}

}  // namespace

InputHold input_hold(const std::vector<SignalPair>& experiments) {
  InputHold hold = InputHold::first;
  for (const SignalPair& pair : experiments) {
    if (pair.input.size() == 0 || pair.input.minCoeff() == pair.input.maxCoeff()) continue;
    if (!is_held(pair.input)) return InputHold::first;
    hold = InputHold::zero;
  }
  return hold;
}

}  // namespace mbk::identify
