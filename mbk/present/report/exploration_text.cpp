#include "mbk/present/report/exploration_text.h"

#include <fmt/format.h>

#include <vector>

#include "mbk/present/report/exploration_parts_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {

std::string exploration_text(const Exploration& found) {
  std::string text;
  std::vector<std::vector<std::string>> rows;
  for (const ExploredRecording& one : found.recordings) {
    rows.push_back({one.source.label().empty() ? "recording" : one.source.label(),
                    fmt::format("{:.6g} s at {:.6g} Hz; analysed: {}", one.duration_s, one.rate_hz, one.window_rule)});
  }
  text += table(rows);
  if (found.frequency_response) text += "\n" + frequency_response_text(*found.frequency_response);
  if (found.impulse_response) text += "\n" + impulse_response_text(*found.impulse_response, found.motion);
  if (found.parallel_cascade) text += "\n" + parallel_cascade_text(*found.parallel_cascade, found.motion);
  if (found.plateau_stiffness) text += "\n" + plateau_stiffness_text(*found.plateau_stiffness, found.motion);
  if (found.reach_stiffness) text += "\n" + reach_stiffness_text(*found.reach_stiffness, found.motion);
  if (found.time_course) text += "\n" + time_course_text(*found.time_course, found.motion);
  if (found.after_onset) text += "\n" + after_onset_text(*found.after_onset, found.motion);
  if (found.emg) text += "\n" + emg_text(*found.emg, found.motion);
  if (found.stretch) text += "\n" + stretch_text(*found.stretch, found.motion);
  for (const std::string& note : found.notes) text += paragraph("  ", note);
  if (!found.warnings.empty()) text += "\n" + warnings_text(found.warnings);
  return text;
}

}  // namespace mbk::report
