#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/robot/workspace.h"
#include "mbk/model/trial/bootstrap_findings.h"
#include "mbk/model/trial/chart.h"
#include "mbk/model/trial/file_contents.h"
#include "mbk/model/trial/findings.h"
#include "mbk/model/trial/force_comparison.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/summary.h"
#include "mbk/model/trial/validation_table.h"

namespace mbk::report {

/// Line width in the terminal; only single words and tables of numbers are wider.
inline constexpr std::size_t kLineColumns = 100;

/// The words of `text` on lines of at most `width` columns, as far as words are short enough.
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t width);

/// A result for the terminal: what was measured and how, the model with 95 % intervals and units, the fit, the
/// ellipses with a picture (or the ellipsoids) where there are findings, and every warning with what to try. Numbers of
/// a model that is not usable are not shown.
[[nodiscard]] std::string result_text(const Identification& identification, const std::optional<Findings>& findings,
                                      const std::optional<SpatialFindings>& spatial = {});

/// Comparison with the other method: the largest difference and, if it is significant, the other model.
[[nodiscard]] std::string alternative_text(const Identification& identification, const Identification& alternative,
                                           const Disagreement& disagreement);

/// Comparison of a computed force with that of the sensor, and the change of the model (Dyck 2013, tables 5.3–5.5 in
/// form).
[[nodiscard]] std::string by_sensor_text(const Identification& computed, const Identification& sensed,
                                         const ForceComparison& comparison);

/// Every quantity with its interval by the bootstrap and by the delta method.
[[nodiscard]] std::string bootstrap_text(const BootstrapFindings& bootstrap);

/// The complete result, as `measure` and `run` print it.
[[nodiscard]] std::string measurement_text(const Measurement& measured);

/// The mean of several results with its 95 % interval, and the omitted ones; or why there is none.
[[nodiscard]] std::string summary_text(const SeveralTrials& together);

/// The ellipse table and picture alone.
[[nodiscard]] std::string ellipses_text(const Findings& findings);

/// The principal values, directions, volumes and shapes of three axes, and the antisymmetric parts. A matrix that is
/// not positive beyond its interval has neither volume nor shape.
[[nodiscard]] std::string ellipsoids_text(const SpatialFindings& findings);

/// Contents and problems of a recording.
[[nodiscard]] std::string info_text(const Recording& recording, const Inspection& inspection);

/// The trials of a file with several.   @param trials  name and description of each
[[nodiscard]] std::string trials_text(const std::string& file,
                                      const std::vector<std::pair<std::string, std::string>>& trials);

/// Contents of a file that is not recognised as a recording, why, and what to do.
[[nodiscard]] std::string contents_text(const FileContents& contents, const Error& unrecognised);

/// Workspace of the hand, drawn with the links at `posture` if given [mm]. The outline is that of fig. A.2.
[[nodiscard]] Chart workspace_chart(const robot::Workspace& workspace, const std::optional<robot::Posture>& posture);

/// The same in words and Braille: links, limits, extents and area, and what holds at the one place.
[[nodiscard]] std::string workspace_text(const robot::Workspace& workspace,
                                         const std::optional<robot::Posture>& posture);

/// A study against known truth: rows with their expected ranges, then its charts.
[[nodiscard]] std::string validation_text(const ValidationTable& table);

}  // namespace mbk::report
