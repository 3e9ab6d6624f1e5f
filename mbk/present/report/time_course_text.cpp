#include <fmt/format.h>

#include <string>
#include <vector>

#include "mbk/model/trial/identification.h"
#include "mbk/present/report/exploration_parts_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace time_course_lines {

constexpr Index kLines = 9;

std::string mean(const MatrixCourse& one) {
  std::string cell;
  for (Index i = 0; i < one.mean.rows(); ++i) {
    for (Index j = 0; j < one.mean.cols(); ++j) {
      cell += (cell.empty() ? "" : ", ") + with_interval(one.mean(i, j), one.mean_half_width(i, j));
    }
  }
  return cell;
}

std::vector<std::string> heading(const std::string& variable, const Units& units, int axes) {
  if (axes == 1) {
    return {variable, fmt::format("M [{}]", units.inertia), fmt::format("B [{}]", units.damping),
            fmt::format("K [{}]", units.stiffness)};
  }
  if (axes == 3) return {variable, fmt::format("K_xx [{}]", units.stiffness), "K_yy", "K_zz"};
  return {variable, fmt::format("K_xx [{}]", units.stiffness), "K_xy", "K_yx", "K_yy"};
}

std::vector<std::string> line(const TimeCourseEstimate& found, Index k) {
  std::vector<std::string> cells = {fmt::format("{:.4g}", found.at[k])};
  const auto add = [&](const MatrixCourse& one, Index column) {
    cells.push_back(with_interval(one.value(k, column), one.half_width(k, column)));
  };
  if (found.axes == 1) {
    for (const MatrixCourse* one : {&found.M, &found.B, &found.K}) add(*one, 0);
  } else if (found.axes == 3) {
    for (const Index column : {0, 4, 8}) add(found.K, column);  // nine would not fit
  } else {
    for (const Index column : {0, 2, 1, 3}) add(found.K, column);
  }
  return cells;
}

}  // namespace time_course_lines

std::string time_course_text(const TimeCourseEstimate& found, Motion motion) {
  using namespace time_course_lines;
  const Units units = units_of(motion);
  const std::string unit = found.unit.empty() ? "" : " " + found.unit;
  std::string text = "change over time\n";
  std::string over = fmt::format("{}, {:.4g} to {:.4g}{}", found.variable, found.from, found.to, unit);
  if (found.repetitions > 1) over += fmt::format(", {} repetitions pooled", found.repetitions);
  std::vector<std::vector<std::string>> rows = {{"variable", over}};
  rows.push_back({"loop", found.instruments ? "instrumental variables, from the motion that the reference explains"
                                            : "least squares: biased if the force moves the robot"});
  if (!found.changes) {
    rows.push_back({"verdict", "constant: " + found.why});
    rows.push_back({"K", mean(found.K) + " " + units.stiffness});
    return text + table(rows);
  }
  rows.push_back(
      {"verdict",
       fmt::format("changes: {} (BIC decreases by {:.0f}, {} knots); {}", found.why, found.bic_gain, found.knots.size(),
                   found.p_value < 1e-12 ? "p < 1e-12" : fmt::format("p = {:.1g}", found.p_value))});
  rows.push_back({"size", fmt::format("M {:.0f} %, B {:.0f} %, K {:.0f} % (rms about the constant model)",
                                      100.0 * found.M.change, 100.0 * found.B.change, 100.0 * found.K.change)});
  text += table(rows);
  std::vector<std::vector<std::string>> lines = {
      heading(found.unit.empty() ? "at" : fmt::format("[{}]", found.unit), units, found.axes)};
  for (Index k = 0; k < kLines; ++k) lines.push_back(line(found, k * (found.at.size() - 1) / (kLines - 1)));
  text += table(lines);
  return found.axes < 3 ? text : text + paragraph("  ", "(diagonal elements of K; --json contains all elements)");
}

}  // namespace mbk::report
