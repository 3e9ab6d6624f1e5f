#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mbk/core/units.h"
#include "mbk/trial/chart.h"

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

/// "2 r11 r22 − Re p ≥ 0"
[[nodiscard]] inline const char* text(StabilityCondition condition) {
  switch (condition) {
    case StabilityCondition::right_poles:
      return "no pole with Re s > 0";
    case StabilityCondition::axis_poles:
      return "poles on the axis: simple, residues of a spring or mass";
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

/// The word of the JSON.
[[nodiscard]] inline const char* text(StabilityVerdict verdict) {
  switch (verdict) {
    case StabilityVerdict::stable:
      return "stable";
    case StabilityVerdict::marginal:
      return "marginal";
    case StabilityVerdict::unstable:
      break;
  }
  return "unstable";
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
  double a = 0;      ///< [N·s/m]; negative for an excess of passivity
  std::string rule;  ///< where it comes from, in words
};

/// Where the conditions were looked at on a grid, because a delay was taken as it is.
struct FrequencyGrid {
  RadPerSec low, high;
  int points = 0;  ///< evenly spaced in the logarithm
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
  AbsoluteStability stability;        ///< Llewellyn
  std::optional<FrequencyGrid> grid;  ///< where it was judged on a grid only
  int operator_port = 1;
  std::optional<OperatorShortage> operator_shortage;
  std::optional<AbsoluteStability> with_operator;  ///< modified Llewellyn, with that a
  std::vector<LargestShortage> largest_shortages;  ///< one for each port
  std::optional<AdmissibleSet> admissible;
  std::vector<Chart> charts;  ///< r₁₁, r₂₂ and the third condition over frequency
  std::vector<std::string> notes;
};

}  // namespace mbk
