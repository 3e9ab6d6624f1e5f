#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/chart.h"

namespace mbk {

/// What absolute stability asks of a two-port, in the order in which it is decided.
enum class StabilityCondition {
  right_poles,  ///< no pole with Re s > 0
  axis_poles,  ///< poles on the axis, ∞ included: simple, residues k₁₁ ≥ 0, k₂₂ ≥ 0, k₁₁ k₂₂ ≥ k₁₂ k₂₁
  resistance_1,  ///< r₁₁ ≥ 0
  resistance_2,  ///< r₂₂ ≥ 0
  product,       ///< 2 r₁₁ r₂₂ − Re p ≥ 0
  squares,       ///< 4 r₁₁ r₂₂ (r₁₁ r₂₂ − Re p) − (Im p)² ≥ 0
};

[[nodiscard]] constexpr auto word_table(StabilityCondition) {
  using enum StabilityCondition;
  return std::to_array<Word<StabilityCondition>>({{right_poles, "right_poles"},
                                                  {axis_poles, "axis_poles"},
                                                  {resistance_1, "r11"},
                                                  {resistance_2, "r22"},
                                                  {product, "product"},
                                                  {squares, "squares"}});
}

/// "2 r11 r22 − Re p ≥ 0"
[[nodiscard]] inline const char* text(StabilityCondition condition) {
  switch (condition) {
    case StabilityCondition::right_poles:
      return "no pole with Re s > 0";
    case StabilityCondition::axis_poles:
      return "poles at Re s = 0: simple, residues of a spring or mass";
    case StabilityCondition::resistance_1:
      return "r11 ≥ 0";
    case StabilityCondition::resistance_2:
      return "r22 ≥ 0";
    case StabilityCondition::product:
      return "2 r11 r22 − Re p ≥ 0";
    case StabilityCondition::squares:
      return "4 r11 r22 (r11 r22 − Re p) − (Im p)² ≥ 0";
  }
  return "";
}

/// Frequencies at which a condition is violated; one frequency where low = high (a pole).
struct ViolatedBand {
  RadPerSec low, high;  ///< high may be infinite
  RadPerSec worst;      ///< where the condition is furthest from holding, by search in double
  double value = 0;  ///< of the condition there: r_ii, or (2 r₁₁ r₂₂ − Re p − |p|) over the sum of the sizes
  std::string detail;  ///< which entry has the pole; empty for bands
};

struct StabilityOutcome {
  StabilityCondition condition = StabilityCondition::right_poles;
  std::vector<ViolatedBand> violated;  ///< ascending; empty: it holds
};

enum class StabilityVerdict {
  stable,    ///< every condition holds with room
  marginal,  ///< every condition holds, and one with equality at a frequency
  unstable,  ///< one is violated: not absolutely stable
};

[[nodiscard]] constexpr auto word_table(StabilityVerdict) {
  using enum StabilityVerdict;
  return std::to_array<Word<StabilityVerdict>>({{stable, "stable"}, {marginal, "marginal"}, {unstable, "unstable"}});
}

struct AbsoluteStability {
  std::string form;  ///< of the immittance matrix that was judged: "z"
  StabilityVerdict verdict = StabilityVerdict::unstable;
  std::array<StabilityOutcome, 6> conditions;  ///< in the order of StabilityCondition
  /// Where a condition holds with equality: frequencies, or everywhere.
  std::vector<RadPerSec> touches;
  bool touches_everywhere = false;

  [[nodiscard]] bool holds() const { return verdict != StabilityVerdict::unstable; }
};

/// The largest shortage a of the termination at a port that keeps the coupled system stable, between proven bounds.
struct LargestShortage {
  int port = 2;
  bool exists = false;               ///< false: none, however large the excess of passivity of the termination
  double at_least = 0, at_most = 0;  ///< [N·s/m]; an a of at_least is stable, one of at_most is not
  [[nodiscard]] double value() const { return at_least + (at_most - at_least) / 2; }
};

/// One end of an interval of a parameter.
struct AdmissibleEnd {
  double value = 0;              ///< may be infinite
  std::optional<bool> included;  ///< absent: not decided
  bool limit_of_search = false;  ///< the range that was asked for ends here
};

struct AdmissibleInterval {
  AdmissibleEnd low, high;  ///< equal for a single value
};

/// All values of one parameter with which the design is absolutely stable.
struct AdmissibleSet {
  std::string parameter, unit;
  double low = 0, high = 0;                   ///< the range that was asked for
  std::vector<AdmissibleInterval> intervals;  ///< ascending, disjoint
  std::vector<double> undecided;              ///< single values between values that fail; not decided
  std::vector<double> critical;               ///< where the answer could have changed
};

/// What is taken of the operator.
struct OperatorShortage {
  double a = 0;                                       ///< [N·s/m]; negative for an excess of passivity
  std::string rule;                                   ///< where it comes from, in words
  std::optional<std::pair<double, double>> excess95;  ///< the measured excess, low and high [N·s/m]
};

/// Where the conditions were evaluated, because a delay was taken as it is.
struct FrequencyGrid {
  RadPerSec low, high;   ///< high may be infinite if bounded
  int points = 0;        ///< evenly spaced in the logarithm; if bounded, the number of evaluations
  bool bounded = false;  ///< the conditions are bounded between the points too, see teleop/delayed.h
};

/// What an excess of passivity of the operator buys: the admissible values of a parameter against it.
struct ExcessStep {
  double excess = 0;  ///< δ = −a [N·s/m]
  AdmissibleSet set;
  /// What the hand feels with the last admissible value, at FeltAt::frequency; absent: there is none.
  struct Felt {
    double free = 0;     ///< |Z| with nothing at port 2 [N·s/m]; 0 were transparent
    double clamped = 0;  ///< |ω Z| with port 2 held fast [N/m]; infinite were transparent
  };
  std::optional<Felt> felt;
};
struct ExcessSweep {
  std::string parameter, unit;
  RadPerSec frequency;  ///< at which `felt` is taken
  std::vector<ExcessStep> steps;
  Chart chart;  ///< the least and the largest stable value over the excess, with that of the operator
};

/// Z = m s + b + k/s at a port.
struct Termination {
  double mass = 0, damping = 0, stiffness = 0;  ///< [kg], [N·s/m], [N/m]
};

/// Two terminations, each no worse than was allowed, with which the whole oscillates more and more.
struct WorstTerminations {
  RadPerSec frequency;
  double growth = 0;                   ///< σ of e^(σt) [1/s] > 0
  std::array<Termination, 2> at_port;  ///< port 1 first
};

/// How a simulated motion goes on after it was set off.
enum class MotionOutcome {
  dies_out,  ///< less than half as fast in its last quarter as in its second
  bounded,   ///< neither: something keeps it going, or it is slow to decide
  grows,     ///< more than twice as fast, or it ran away
};

[[nodiscard]] constexpr auto word_table(MotionOutcome) {
  using enum MotionOutcome;
  return std::to_array<Word<MotionOutcome>>({{dies_out, "dies_out"}, {bounded, "bounded"}, {grows, "grows"}});
}

/// One simulation of hand, master, line, slave and environment in time.
struct TeleoperationRun {
  std::string what, hand, environment;  ///< in words
  MotionOutcome outcome = MotionOutcome::bounded;
  double ratio = 0;     ///< root mean square speed of both robots, last quarter over second
  RadPerSec frequency;  ///< of the last quarter; 0: it does not swing
  double duration = 0;  ///< [s]; shorter than asked for where it ran away
  bool ran_away = false;
  double largest_position = 0;             ///< of either robot [m]
  long sent = 0, lost = 0;                 ///< packets, both directions
  std::optional<double> lowest_energy;     ///< of the passivity controller's one-port [J]
  std::optional<WorstTerminations> worst;  ///< what it was run against, where that was constructed
  Chart positions;
};

/// What `--simulate` adds to a design.
struct TeleoperationSimulation {
  double sample_time = 0;  ///< [s]
  /// Llewellyn's and the modified criterion with the controllers' sampling, on a grid up to the Nyquist frequency;
  /// absent where they cannot be judged so, which a note explains, or without an operator.
  std::optional<AbsoluteStability> sampled, sampled_with_operator;
  FrequencyGrid grid;
  std::vector<TeleoperationRun> runs;
  std::vector<std::string> notes;
};

/// A number of a design.
struct DesignParameter {
  std::string name, unit, meaning;  ///< "slave.k", "N/m", "k_s, stiffness of the slave's controller"
  double value = 0;
};

/// What `mbk teleop` says of a design.
struct TeleoperationFinding {
  std::string file, name, kind;     ///< of the architecture, or "two-port z"
  std::vector<std::string> matrix;  ///< what the architecture's matrix is, one line each
  std::vector<DesignParameter> parameters;
  AbsoluteStability stability;          ///< Llewellyn
  std::optional<FrequencyGrid> grid;    ///< where it was evaluated, with true delays
  std::optional<RadPerSec> pade_limit;  ///< above it the phase of the chosen Padé approximation is wrong
  int operator_port = 1;
  std::optional<OperatorShortage> operator_shortage;
  std::optional<AbsoluteStability> with_operator;  ///< modified Llewellyn, with that a
  std::optional<FrequencyGrid> operator_grid;      ///< where that was evaluated, with true delays
  std::vector<LargestShortage> largest_shortages;  ///< one for each port
  std::optional<AdmissibleSet> admissible;
  std::optional<ExcessSweep> excess;
  std::optional<TeleoperationSimulation> simulation;
  std::vector<Chart> charts;  ///< r₁₁, r₂₂ and the third condition over frequency
  std::vector<std::string> notes;
};

}  // namespace mbk
