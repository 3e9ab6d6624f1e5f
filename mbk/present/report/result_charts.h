#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/model/trial/chart.h"
#include "mbk/model/trial/diagnostics.h"
#include "mbk/model/trial/exploration.h"
#include "mbk/model/trial/measurement.h"

namespace mbk::report {

/// A chart with the word that its file is called by: "stiffness-ellipse".
struct NamedChart {
  std::string name;
  Chart chart;
  std::vector<Chart> beside = {};  ///< in the same figure, to its right
};

/// What a measurement can be drawn as: the ellipses, each alone and side by side, where the result is usable and has
/// findings; with three axes the projections of each closed ellipsoid onto the planes xy, xz and yz; from the
/// diagnostics measured and predicted force, the residual's autocorrelation, coherence and power spectra of the force.
[[nodiscard]] std::vector<NamedChart> measurement_charts(const Measurement& measured,
                                                         const std::optional<Diagnostics>& diagnostics);

/// Magnitude, phase and coherence of the frequency response, the impulse response, and the stiffness over time where it
/// changes; those that the exploration has, with 95 % intervals.
[[nodiscard]] std::vector<NamedChart> exploration_charts(const Exploration& found);

}  // namespace mbk::report
