#include "mbk/teleop/delayed.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "mbk/teleop/llewellyn.h"
#include "mbk/teleop/sampled.h"

namespace mbk::teleop {
namespace delayed {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// ---- Interval arithmetic: results contain every value, rounding included

struct Bounds {
  double low = 0, high = 0;
  [[nodiscard]] double size() const { return std::max(std::abs(low), std::abs(high)); }
};

Bounds widened(double low, double high) {
  constexpr double kRounding = std::numeric_limits<double>::epsilon(), kTiny = std::numeric_limits<double>::min();
  return {low - kRounding * std::abs(low) - kTiny, high + kRounding * std::abs(high) + kTiny};
}

Bounds rounded(const Rational& value) {
  const double near = lti::to_double(value);
  return value.is_zero() ? Bounds{} : widened(near, near);
}

Bounds operator+(Bounds a, Bounds b) {
  return widened(a.low + b.low, a.high + b.high);
}

Bounds operator-(Bounds a) {
  return {-a.high, -a.low};
}

Bounds operator-(Bounds a, Bounds b) {
  return a + -b;
}

Bounds operator*(Bounds a, Bounds b) {
  const auto [low, high] = std::minmax({a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
  return widened(low, high);
}

Bounds operator*(double factor, Bounds b) {
  return Bounds{factor, factor} * b;
}

Bounds square(Bounds a) {
  const Bounds squared = a * a;
  return a.low <= 0.0 && a.high >= 0.0 ? Bounds{0.0, squared.high} : squared;
}

/// f over an interval of angles, where |f′| ≤ slope and |f| ≤ 1.
template <typename Function>
Bounds by_slope(Function f, double slope, Bounds angle) {
  constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
  const double middle = 0.5 * (angle.low + angle.high), half = 0.5 * (angle.high - angle.low);
  const double away = slope * half + kRounding * (1.0 + angle.size()), value = f(middle);
  return {std::max(-1.0, value - away), std::min(1.0, value + away)};
}

double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(x) / x;
}

/// re + jω im: functions with f(−jω) = conj f(jω), whose parts are regular at 0 and even.
struct Even {
  Bounds re, im;
};

/// At one cell, X = ω².
class Algebra {
 public:
  explicit Algebra(Bounds X) : X_(X) {}
  [[nodiscard]] Even times(const Even& a, const Even& b) const {
    return {a.re * b.re - X_ * (a.im * b.im), a.re * b.im + a.im * b.re};
  }

 private:
  Bounds X_;
};

Even operator-(const Even& a, const Even& b) {
  return {a.re - b.re, a.im - b.im};
}

Even operator*(Bounds a, const Even& b) {
  return {a * b.re, a * b.im};
}

Even conjugate(const Even& a) {
  return {a.re, -a.im};
}

// ---- The network

/// k + d s + m s², an impedance times s.
struct Impedance {
  Rational k, d, m;
  Bounds rounded_k = rounded(k), rounded_d = rounded(d), rounded_m = rounded(m);

  [[nodiscard]] static Impedance minus(const Polynomial& p) {
    return {-p.coefficient(0), -p.coefficient(1), -p.coefficient(2)};
  }
  [[nodiscard]] Even at(Bounds X) const { return {rounded_k - rounded_m * X, rounded_d}; }
  /// sup of |k + d jω − m ω²|/ω for all frequencies from `omega`.
  [[nodiscard]] double largest_from(double omega) const {
    return m.is_zero() ? std::hypot(lti::to_double(d), lti::to_double(k) / omega) : kInfinite;
  }
};

Impedance combined(const Rational& f, const Impedance& x, const Rational& g, const Impedance& y) {
  return {f * x.k - g * y.k, f * x.d - g * y.d, f * x.m - g * y.m};
}

/// What the conditions ask not to be negative at a cell, and the sum of the sizes of its terms.
struct Condition {
  Bounds value;
  double size = 0;
  [[nodiscard]] bool holds() const { return value.low >= -kDelayTolerance * size - kSmallest; }
  [[nodiscard]] bool violated() const { return value.high < -kSmallest; }

 private:
  static constexpr double kSmallest = 1e-290;  // above what rounding makes of sums of zeros
};

/// [[c₆, D c₂], [c₃, c₅]] [V₁ V₂] s = [[B₁₁, D B₁₂], [B₂₁, B₂₂]] [I₁ I₂], D = D₁ D₂: port 2 is scaled by D₁, which
/// leaves z₁₁, z₂₂ and z₁₂ z₂₁ as they are.
class Network {
 public:
  Network(const Teleoperator& teleoperator, Port port, const Rational& a) : port_(port == Port::one ? 0 : 1), a_(a) {
    const PortEquations equations = teleoperator.without_delay();
    const auto p = [&](std::size_t i, std::size_t j) { return equations.rows[i][j].at(0); };
    c6_ = p(0, 0).coefficient(1);
    c2_ = p(0, 1).coefficient(1);
    c3_ = p(1, 0).coefficient(1);
    c5_ = p(1, 1).coefficient(1);
    b11_ = Impedance::minus(p(0, 2));
    b12_ = Impedance::minus(p(0, 3));
    b21_ = Impedance::minus(p(1, 2));
    b22_ = Impedance::minus(p(1, 3));
    forward_ = combined(c5_, b12_, c2_, b22_);
    back_ = combined(c6_, b21_, c3_, b11_);
    for (const char* name : {"delay.to_slave", "delay.to_master"}) {
      if (const auto found = teleoperator.values.find(name); found != teleoperator.values.end()) T_ += found->second;
    }
    Rounded& r = rounded_;
    r = {rounded(c6_), rounded(c2_), rounded(c3_), rounded(c5_), rounded(a_), rounded(T_)};
  }

  [[nodiscard]] double delay() const { return lti::to_double(T_); }

  [[nodiscard]] Condition condition(StabilityCondition which, Bounds omega) const {
    const Rounded& r = rounded_;
    const Bounds X = square(omega), angle = omega * r.T;
    const Algebra in(X);
    const Even D{by_slope([](double x) { return std::cos(x); }, 1.0, angle), -(r.T * by_slope(sinc, 0.5, angle))};
    const Even delta = Even{r.c6 * r.c5, {}} - (r.c2 * r.c3) * D, turned = conjugate(delta);
    const Bounds size = square(delta.re) + X * square(delta.im);
    const auto resistance = [&](int i) {
      const Even n = i == 0 ? r.c5 * b11_.at(X) - r.c2 * in.times(D, b21_.at(X))
                            : r.c6 * b22_.at(X) - r.c3 * in.times(D, b12_.at(X));
      const Bounds one = n.re * turned.im, two = n.im * turned.re, taken = i == port_ ? r.a * size : Bounds{};
      return Condition{one + two - taken, one.size() + two.size() + taken.size()};
    };
    const Condition r11 = resistance(0), r22 = resistance(1);
    if (which == StabilityCondition::resistance_1) return r11;
    if (which == StabilityCondition::resistance_2) return r22;
    const Even p = in.times(in.times(in.times(D, in.times(forward_.at(X), back_.at(X))), turned), turned);
    const Bounds both = r11.value * r22.value;
    if (which == StabilityCondition::product) {
      const Bounds first = 2.0 * (X * both);
      return {first + p.re, first.size() + p.re.size()};
    }
    const Bounds first = 4.0 * (both * (X * both + p.re)), second = square(p.im);
    return {first - second, 4.0 * both.size() * (X.size() * both.size() + p.re.size()) + second.size()};
  }

  /// Whether the conditions hold from this frequency on for every phase of the delay: r₁₁ r₂₂ ≥ |p|.
  [[nodiscard]] bool holds_from(double omega) const {
    const auto size = [](const Rational& x) { return std::abs(lti::to_double(x)); };
    // a term with a factor of zero is none, however the other one grows
    const auto term = [&](const Rational& factor, const Impedance& x) {
      return factor.is_zero() ? 0.0 : size(factor) * x.largest_from(omega);
    };
    const double sent = size(c2_ * c3_), local = size(c6_ * c5_);
    const double smallest = (local - sent) * (local - sent), largest = (local + sent) * (local + sent);
    const auto resistance = [&](int i, const Rational& steady, double turning) {
      const double a = i == port_ ? lti::to_double(a_) : 0.0;
      return lti::to_double(steady) - turning - a * (a > 0.0 ? largest : smallest);
    };
    const double one = resistance(0, c6_ * c5_ * c5_ * b11_.d + c2_ * c2_ * c3_ * b21_.d,
                                  term(c5_ * c2_ * c3_, b11_) + term(c6_ * c5_ * c2_, b21_));
    const double two = resistance(1, c6_ * c6_ * c5_ * b22_.d + c3_ * c3_ * c2_ * b12_.d,
                                  term(c6_ * c2_ * c3_, b22_) + term(c6_ * c5_ * c3_, b12_));
    const double f = forward_.largest_from(omega), b = back_.largest_from(omega);
    const double coupling = f == 0.0 || b == 0.0 ? 0.0 : f * b * largest;
    constexpr double kRounding = 1e-12;
    return one >= 0.0 && two >= 0.0 && one * two >= (1.0 + kRounding) * coupling;
  }

  struct Values {
    double r11 = 0, r22 = 0;
    std::complex<double> p;
    [[nodiscard]] double third() const {
      const double size = 2.0 * std::abs(r11 * r22) + std::abs(p.real()) + std::abs(p);
      return (2.0 * r11 * r22 - p.real() - std::abs(p)) / size;
    }
    [[nodiscard]] double of(StabilityCondition which) const {
      return which == StabilityCondition::resistance_1   ? r11
             : which == StabilityCondition::resistance_2 ? r22
                                                         : third();
    }
  };
  [[nodiscard]] Values at(double omega) const {
    using Complex = std::complex<double>;
    const Complex s(0.0, omega), D = std::exp(-s * delay());
    const auto number = [](const Rational& x) { return lti::to_double(x); };
    const auto z = [&](const Impedance& x) { return number(x.d) + number(x.m) * s + number(x.k) / s; };
    const Complex delta = number(c6_ * c5_) - D * number(c2_ * c3_);
    Values values;
    values.r11 = ((number(c5_) * z(b11_) - D * number(c2_) * z(b21_)) / delta).real();
    values.r22 = ((number(c6_) * z(b22_) - D * number(c3_) * z(b12_)) / delta).real();
    (port_ == 0 ? values.r11 : values.r22) -= lti::to_double(a_);
    values.p = D * z(forward_) * z(back_) / (delta * delta);
    return values;
  }

  /// The smallest and the largest of 1/T and the corner frequencies d/m, k/d and √(k/m).
  [[nodiscard]] std::pair<double, double> corners() const {
    std::pair<double, double> found{1.0 / delay(), 1.0 / delay()};
    const auto add = [&](const Rational& above, const Rational& below, bool root) {
      if (above.is_zero() || below.is_zero()) return;
      const double ratio = std::abs(lti::to_double(above / below)), omega = root ? std::sqrt(ratio) : ratio;
      found = {std::min(found.first, omega), std::max(found.second, omega)};
    };
    for (const Impedance* x : {&b11_, &b12_, &b21_, &b22_}) {
      add(x->k, x->d, false);
      add(x->d, x->m, false);
      add(x->k, x->m, true);
    }
    return found;
  }

 private:
  int port_;
  Rational a_, T_, c6_, c2_, c3_, c5_;
  Impedance b11_, b12_, b21_, b22_, forward_, back_;
  struct Rounded {
    Bounds c6, c2, c3, c5, a, T;
  } rounded_;
};

// ---- Cells

enum class State { holds, violated, unresolved };

struct Cell {
  Bounds omega;
  State state = State::unresolved;
};

struct Decided {
  std::vector<Bounds> violated;  ///< ascending, disjoint
  int evaluations = 0;
  bool complete = true;
};

/// Decides one condition in [low, high], from halved cells.
class Decision {
 public:
  Decision(const Network& network, StabilityCondition which) : network_(network), which_(which) {}

  void take(Bounds omega) {
    std::vector<Bounds> pending = {omega};
    while (!pending.empty()) {
      const Bounds cell = pending.back();
      pending.pop_back();
      const State state = state_of(cell);
      const double middle = 0.5 * (cell.low + cell.high);
      if (state != State::unresolved || cell.high - cell.low < kFinest * cell.high || evaluations_ >= kMax) {
        add({cell, state});
        continue;
      }
      pending.push_back({middle, cell.high});
      pending.push_back({cell.low, middle});
    }
  }

  /// Whether it holds in all of the cell; ends at the first part of which that cannot be shown.
  [[nodiscard]] bool holds_in(Bounds omega) {
    std::vector<Bounds> pending = {omega};
    while (!pending.empty()) {
      const Bounds cell = pending.back();
      pending.pop_back();
      const State state = state_of(cell);
      if (state == State::holds) continue;
      if (state == State::violated || cell.high - cell.low < kFinest * cell.high) return false;
      if (evaluations_ >= kMaxOfSearch) return false;
      const double middle = 0.5 * (cell.low + cell.high);
      pending.push_back({middle, cell.high});
      pending.push_back({cell.low, middle});
    }
    return true;
  }

  /// Unresolved cells beside violated ones are the ends of their bands.
  [[nodiscard]] Decided result() const {
    Decided decided;
    decided.evaluations = evaluations_;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (cells_[i].state == State::violated) decided.violated.push_back(cells_[i].omega);
      if (cells_[i].state != State::unresolved) continue;
      const bool beside = (i > 0 && cells_[i - 1].state == State::violated) ||
                          (i + 1 < cells_.size() && cells_[i + 1].state == State::violated);
      const bool narrow = cells_[i].omega.high - cells_[i].omega.low < kNarrow * cells_[i].omega.high;
      if (!beside || !narrow) decided.complete = false;
    }
    return decided;
  }

 private:
  static constexpr double kFinest = 1e-12, kNarrow = 1e-6;        // relative widths
  static constexpr int kMax = 1'000'000, kMaxOfSearch = 200'000;  // evaluations

  State state_of(Bounds omega) {
    ++evaluations_;
    const Condition found = network_.condition(which_, omega);
    return found.holds() ? State::holds : found.violated() ? State::violated : State::unresolved;
  }

  void add(const Cell& cell) {
    if (!cells_.empty() && cells_.back().state == cell.state && cells_.back().omega.high == cell.omega.low) {
      cells_.back().omega.high = cell.omega.high;
    } else {
      cells_.push_back(cell);
    }
  }

  const Network& network_;
  StabilityCondition which_;
  std::vector<Cell> cells_;
  int evaluations_ = 0;
};

constexpr std::array kOnAxis = {StabilityCondition::resistance_1, StabilityCondition::resistance_2,
                                StabilityCondition::product, StabilityCondition::squares};

/// Frequencies far above all others, with phases of the delay all round.
std::vector<double> far_frequencies(double from, double T) {
  constexpr int kPhases = 16, kPlaces = 120;
  constexpr double kRatio = 1.25;
  std::vector<double> omega;
  for (int i = 0; i < kPlaces; ++i) {
    const double turn = 2.0 * std::numbers::pi / T, start = from * std::pow(kRatio, i);
    for (int k = 0; k < kPhases; ++k) omega.push_back(start + turn * k / kPhases);
  }
  return omega;
}

/// Where f is lowest between low and high, near the lowest of some points.
std::pair<double, double> lowest(const std::function<double(double)>& f, double low, double high) {
  constexpr int kPoints = 64, kSections = 40;
  const double step = std::log(high / low) / kPoints;
  double best = low, value = kInfinite;
  const auto look = [&](double omega) {
    const double found = f(omega);
    if (found < value) std::tie(best, value) = std::pair(omega, found);
    return found;
  };
  for (int k = 0; k <= kPoints; ++k) look(low * std::exp(step * k));
  double from = std::max(low, best * std::exp(-step)), to = std::min(high, best * std::exp(step));
  for (int k = 0; k < kSections; ++k) {
    const double one = from + (to - from) / 3.0, two = to - (to - from) / 3.0;
    if (look(one) < look(two)) {
      to = two;
    } else {
      from = one;
    }
  }
  return {best, value};
}

ViolatedBand band_of(const Network& network, StabilityCondition which, Bounds band) {
  constexpr double kReach = 1e-2;  // how far below its upper end a band that begins at 0 is looked at
  const double from = band.low > 0.0 ? band.low : kReach * band.high;
  const auto [worst, value] = lowest([&](double omega) { return network.at(omega).of(which); }, from, band.high);
  return {RadPerSec(band.low), RadPerSec(band.high), RadPerSec(worst), value, ""};
}

// relative to corner frequencies and 1/T
constexpr double kBelow = 1e-6;                    // where cells begin
constexpr double kBeside = 10.0, kBeyond = 100.0;  // where they end if no phase-independent bound holds
constexpr double kFarthest = 1e4;                  // how far such a bound is looked for

/// From where all holds for every phase; 0 if it does not up to very high frequencies.
double certain_from(const Network& network, double corner) {
  for (double omega = corner; omega <= kFarthest * corner; omega *= 2.0) {
    if (network.holds_from(omega)) return omega;
  }
  return 0.0;
}

/// Calls f for each octave from low to high.
template <typename Function>
void for_octaves(double low, double high, Function f) {
  for (double from = low; from < high; from *= 2.0) f(Bounds{from, std::min(high, 2.0 * from)});
}

bool any_violated(const AbsoluteStability& stability) {
  return std::ranges::any_of(stability.conditions, [](const auto& outcome) { return !outcome.violated.empty(); });
}

/// The conditions on the axis up to `high`.   @returns  whether every cell is decided
bool decide_up_to(double high, const Network& network, DelayedStability& result) {
  const double low = kBelow * network.corners().first;
  bool complete = true, from_zero = true;
  result.grid = {RadPerSec(0.0), RadPerSec(high), 0, true};
  for (std::size_t i = 0; i < kOnAxis.size(); ++i) {
    const bool holds_at_zero = network.condition(kOnAxis[i], {0.0, low}).holds();
    from_zero = from_zero && holds_at_zero;
    Decision decision(network, kOnAxis[i]);
    for_octaves(low, high, [&](Bounds octave) { decision.take(octave); });
    const Decided decided = decision.result();
    StabilityOutcome outcome{kOnAxis[i], {}};
    for (Bounds band : decided.violated) {
      if (band.low == low && !holds_at_zero) band.low = 0.0;
      outcome.violated.push_back(band_of(network, kOnAxis[i], band));
    }
    result.stability.conditions[i + 2] = std::move(outcome);
    result.grid.points += decided.evaluations;
    complete = complete && decided.complete;
  }
  if (!from_zero) result.grid.low = RadPerSec(low);
  return complete;
}

/// Single frequencies far above.
void look_beyond(double high, const Network& network, AbsoluteStability& stability) {
  for (const double omega : far_frequencies(high, network.delay())) {
    for (std::size_t i = 0; i < kOnAxis.size(); ++i) {
      if (!network.condition(kOnAxis[i], {omega, omega}).violated()) continue;
      stability.conditions[i + 2].violated = {band_of(network, kOnAxis[i], {omega, omega})};
      return;
    }
  }
}

Result<DelayedStability> decide(const Network& network, const AbsoluteStability& poles) {
  const double corner = network.corners().second, certain = certain_from(network, corner);
  DelayedStability result;
  AbsoluteStability& stability = result.stability;
  stability.form = word_of(Form::z);
  stability.conditions[0] = poles.conditions[0];
  stability.conditions[1] = poles.conditions[1];
  bool complete = decide_up_to(certain > 0.0 ? certain : kBeside * corner, network, result);
  if (certain > 0.0) {
    result.grid.high = RadPerSec(kInfinite);
  } else if (complete && !any_violated(stability)) {
    complete = decide_up_to(kBeyond * corner, network, result);
    if (complete && !any_violated(stability)) look_beyond(kBeyond * corner, network, stability);
  }
  if (!complete && !any_violated(stability)) {
    return fail(ErrorKind::not_usable, "a condition is too close to its limit to be decided with the true delay",
                "change a damping slightly, or write pade = 2 in [delay] to decide the Padé approximation exactly");
  }
  stability.verdict = any_violated(stability) ? StabilityVerdict::unstable : StabilityVerdict::stable;
  return result;
}

/// Whether all conditions hold at every frequency.
bool holds_everywhere(const Network& network) {
  const auto [lowest_corner, corner] = network.corners();
  const double certain = certain_from(network, corner), low = kBelow * lowest_corner;
  if (certain == 0.0) return false;
  return std::ranges::all_of(kOnAxis, [&](StabilityCondition which) {
    Decision decision(network, which);
    bool holds = true;
    for_octaves(low, certain, [&](Bounds octave) { holds = holds && decision.holds_in(octave); });
    return holds;
  });
}

}  // namespace delayed

Result<DelayedStability> llewellyn_with_delay(const Teleoperator& teleoperator, Port port, const Rational& a) {
  using namespace delayed;
  MBK_TRY(check_poles(teleoperator));
  const auto at_once = MBK_TRY(teleoperator.without_delay().with_shortage(port, Polynomial{a}).at(0));
  return decide(Network(teleoperator, port, a), llewellyn(at_once));
}

Result<LargestShortage> largest_shortage_with_delay(const Teleoperator& teleoperator, Port port) {
  using namespace delayed;
  MBK_TRY(check_poles(teleoperator));
  LargestShortage result;
  result.port = static_cast<int>(port);
  const TwoPort at_once = MBK_TRY(teleoperator.without_delay().at(0));
  if (!has_passive_poles(at_once.matrix)) return result;
  const Network network(teleoperator, port, 0);
  const auto [lowest_corner, highest_corner] = network.corners();
  const auto largest_at = [&](double omega) {
    const Network::Values z = network.at(omega);
    const double own = port == Port::one ? z.r11 : z.r22, other = port == Port::one ? z.r22 : z.r11;
    const double excess = z.p.real() + std::abs(z.p);
    if (other < 0.0 || (other == 0.0 && excess > 0.0)) return -kInfinite;
    return excess > 0.0 ? own - excess / (2.0 * other) : own;
  };
  double most = kInfinite;
  constexpr double kStep = 1.2;
  const double high = kBeyond * highest_corner;
  for (double omega = kBelow * lowest_corner; omega < high; omega *= kStep) {
    most = std::min(most, lowest(largest_at, omega, kStep * omega).second);
  }
  for (const double omega : far_frequencies(high, network.delay())) most = std::min(most, largest_at(omega));
  if (!std::isfinite(most)) return result;

  const auto holds = [&](double a) {
    const auto exact = lti::exact(a);
    return exact && holds_everywhere(Network(teleoperator, port, *exact));
  };
  constexpr double kFinest = 1e-6;
  constexpr int kSteps = 20, kHalvings = 8;
  double step = kFinest * std::max(1.0, std::abs(most)), low = most - step, above = most;
  for (int k = 0; !holds(low); ++k) {
    if (k == kSteps) return result;
    above = low;
    step *= 4.0;
    low = most - step;
  }
  for (int k = 0; k < kHalvings && above < most; ++k) {
    const double middle = 0.5 * (low + above);
    (holds(middle) ? low : above) = middle;
  }
  result.exists = true;
  result.at_least = low;
  result.at_most = most;
  return result;
}

}  // namespace mbk::teleop
