#include <fmt/format.h>

#include <string>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/model/trial/identification.h"
#include "mbk/present/report/exploration_parts_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace after_onset_lines {

/// Entries row by row, and with several axes the eigenvalues of the symmetric part; of what is not identifiable how far
/// its interval reaches.
void add(const char* name, const MatrixEstimate& one, const char* unit, std::vector<std::vector<std::string>>& rows) {
  if (!one.identifiable) {
    rows.push_back(
        {name, fmt::format("not identifiable: the 95 % interval of its largest eigenvalue is {:.3g} ± {:.2g} {}",
                           one.eigenvalue[one.eigenvalue.size() - 1],
                           one.eigenvalue_half_width[one.eigenvalue.size() - 1], unit)});
    return;
  }
  std::string cell;
  for (Index i = 0; i < one.value.rows(); ++i) {
    for (Index j = 0; j < one.value.cols(); ++j) {
      cell += (cell.empty() ? "" : ", ") + with_interval(one.value(i, j), one.half_width(i, j));
    }
  }
  rows.push_back({name, cell + " " + unit});
  if (one.value.rows() == 1) return;
  cell.clear();
  for (Index k = 0; k < one.eigenvalue.size(); ++k) {
    cell += (cell.empty() ? "" : ", ") + with_interval(one.eigenvalue[k], one.eigenvalue_half_width[k]);
  }
  rows.push_back({"", "eigenvalues " + cell + " " + unit});
}

}  // namespace after_onset_lines

std::string after_onset_text(const AfterOnsetEstimate& found, Motion motion) {
  using namespace after_onset_lines;
  const Units units = units_of(motion);
  std::string text = fmt::format("the first {:.0f} ms after onset\n", kMilliseconds * found.window_s);
  std::vector<std::vector<std::string>> rows;
  std::string onsets = fmt::format("{}, minus the mean of the {:.0f} ms before each; displacement {:.2g} {}",
                                   found.onsets, kMilliseconds * found.baseline_s, found.displacement, units.position);
  if (found.omitted > 0) {
    onsets += fmt::format("; {} omitted, because the limb did not rest before {} or the recording is too short",
                          found.omitted, found.omitted == 1 ? "it" : "them");
  }
  rows.push_back({"onsets", onsets});
  add("M", found.M, units.inertia, rows);
  add("B", found.B, units.damping, rows);
  add("K", found.K, units.stiffness, rows);
  if (found.handle_mass > 0.0) {
    rows.push_back({"handle", fmt::format("{:g} kg from the recording subtracted from M", found.handle_mass)});
  }
  std::string vaf;
  for (const ExplainedForce& one : found.explained) vaf += fmt::format("{}{:.2f} %", vaf.empty() ? "" : ", ", one.vaf);
  rows.push_back({"VAF", vaf + " (in sample, of the increments)"});
  return text + table(rows);
}

}  // namespace mbk::report
