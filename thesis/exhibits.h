#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/trial/reproduction.h"
#include "thesis/exhibit_text.h"
#include "thesis/workbench.h"

/// What the exhibits are put together from. For the sources of this module only.
namespace mbk::thesis {

inline constexpr auto kFigure = Exhibit::Kind::figure, kTable = Exhibit::Kind::table;
inline constexpr std::array<const char*, 3> kMatrices = {"inertia", "damping", "stiffness"};

/// One exhibit: what it is, and what makes its content. `make` fills commands, tables, charts, related and the values
/// of which its text (exhibit_text.h) speaks.
struct Maker {
  Exhibit::Kind kind;
  int chapter;
  const char* id;
  Provenance provenance;
  Result<void> (*make)(Workbench& bench, Draft& exhibit);
};

// One span for each source file, in the order of the source.
[[nodiscard]] std::span<const Maker> relaxed_tables();
[[nodiscard]] std::span<const Maker> signal_figures();
[[nodiscard]] std::span<const Maker> relaxed_figures();
[[nodiscard]] std::span<const Maker> rigid_tables();
[[nodiscard]] std::span<const Maker> rigid_figures();
[[nodiscard]] std::span<const Maker> reconstructed_tables();
[[nodiscard]] std::span<const Maker> rig_exhibits();             ///< chapters 3 and 5
[[nodiscard]] std::span<const Maker> virtual_sensor_exhibits();  ///< chapter 5
[[nodiscard]] std::span<const Maker> apparatus_exhibits();       ///< appendices A and E
[[nodiscard]] std::span<const Maker> statements();
[[nodiscard]] std::span<const Maker> errata();
[[nodiscard]] std::span<const Maker> questions();
[[nodiscard]] std::span<const Maker> future_work();

inline ReproducedCell cell(double ours) {
  ReproducedCell cell;
  cell.ours = ours;
  return cell;
}

/// @param range  what the rounding of the printed numbers that it rests on leaves open
inline ReproducedCell cell(double ours, std::pair<double, double> range) {
  ReproducedCell cell = thesis::cell(ours);
  cell.range = range;
  return cell;
}

/// The mean of values and how sure or how scattered they are.
enum class Spread { standard_error, standard_deviation };
[[nodiscard]] ReproducedCell cell(const std::vector<double>& values, Spread spread);

inline ReproducedCell words(std::string text) {
  ReproducedCell cell;
  cell.words = std::move(text);
  return cell;
}

/// The same quantity of each trial.
[[nodiscard]] std::vector<double> of_trials(const TaskResult& result,
                                            const std::function<double(const TaskTrial&)>& quantity);

/// What the first participant did at a task.
/// @fails  as Workbench::results
[[nodiscard]] Result<const TaskResult*> first_of(Workbench& bench, Task task);

/// The command that makes the first trial of P1 at a task, and its report.
[[nodiscard]] std::string report_command(const Workbench& bench, Task task);

/// "P1"
[[nodiscard]] std::string person(int participant);

/// The symmetric matrix with a printed area, shape and orientation: λ_max = √(A R/π), λ_min = √(A/(π R)).
[[nodiscard]] Matrix symmetric_matrix(const PrintedEllipse& ellipse);

/// Adds a table of M, B, K, x₀, VAF and verdict of everyone who did a task, and the command of its first trial: tables
/// 3.2, 3.4, 4.1 and 4.2 in form.
/// @fails  as Workbench::results
[[nodiscard]] Result<void> add_impedances(Workbench& bench, Task task, const char* id, Draft& exhibit);

}  // namespace mbk::thesis
