#pragma once

#include <functional>
#include <optional>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/teleop/design.h"

namespace mbk::teleop {

/// Optional results besides the verdict.
struct Question {
  /// a of the operator, instead of that of the design.
  std::optional<OperatorShortage> operator_shortage;
  /// The values of a parameter for which the design is absolutely stable, with that operator, if there is one.
  struct Sweep {
    std::string parameter;
    Rational low, high;
  };
  std::optional<Sweep> sweep;
  /// The same for a series of excesses of passivity of the operator, δ = −a, evenly spaced from low to high [N·s/m].
  struct Excess {
    Rational low, high;
    int steps = 11;  ///< ≥ 2
  };
  std::optional<Excess> excess;
  std::function<void(double share)> sweep_progress = {};  ///< of the sweep: approximate completed fraction, 0 to 1
  std::function<void(int done, int of)> progress = {};    ///< of the excesses
};

/// "slave.k=50:500"
/// @fails  usage: not of that form; LOW ≥ HIGH.
[[nodiscard]] Result<Question::Sweep> parse_sweep(std::string_view text);

/// "0:10" or "0:10:21", the last the number of steps, 2 to 201
/// @fails  usage: not of that form; LOW ≥ HIGH.
[[nodiscard]] Result<Question::Excess> parse_excess(std::string_view text);

/// The complete result for a design.
/// @fails  usage: the design has no such parameter, or an exact delay and a sweep; excesses without a sweep; a of the
/// operator is given twice.
/// not usable: as llewellyn_on_grid(), admissible_set() and PortEquations::at().
[[nodiscard]] Result<TeleoperationFinding> judge(const Design& design, const Question& question);

}  // namespace mbk::teleop
