#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/model/trial/energy.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// Fourier components of force and motion at the lines of a periodic perturbation, period by period.
struct LineSpectra {
  std::vector<Index> harmonics;                   ///< of the period, each one line; empty: there are none to speak of
  double period_s = 0;                            ///< [s]
  std::vector<Eigen::MatrixXcd> position, force;  ///< of each period: lines × n, x = Re(X e^(jωt))

  [[nodiscard]] Index periods() const { return static_cast<Index>(force.size()); }
  [[nodiscard]] Hertz frequency(std::size_t line) const {
    return Hertz(static_cast<double>(harmonics[line]) / period_s);
  }
};

/// Over the whole periods that the window holds, counted from its end; what the perturbation takes to grow from rest is
/// left out. The samples as recorded; no filter. The period is the shortest lag at which the reference repeats itself
/// to 1 % of its variance; lines are the harmonics that hold at least 0.5 % of the variance of an axis of it.
/// @param trials  one for each recording; several are periods of one experiment
/// @returns empty where there are no lines to speak of: no reference, pulses, a reference that does not repeat itself
/// three times, a clock with gaps, a value that is not a number, or recordings whose periods differ
[[nodiscard]] LineSpectra line_spectra(std::span<const Recording* const> recordings,
                                       std::span<const PreparedTrial> trials);

/// Energy that the limb absorbed at each line, −∫ F_h·v dt of the components at its frequency. Intervals are Student's,
/// from how the periods differ, at 95 % for all lines at once (Bonferroni).
[[nodiscard]] std::vector<EnergyLine> energy_lines(const LineSpectra& spectra);

/// Whether the model explains the force at each line: F + Z(jω) X, Z = K − ω² (M + Λ I) + jω B, is zero on average over
/// the periods. Hotelling's test of each line against its scatter between periods, Fisher's of all together. It is
/// contradicted where chance is below 10⁻⁵ and the systematic part is 4 % of the force (root mean square): the geometry
/// of an arm leaves a little at every line. Parameters that were fitted to the same periods make the test conservative.
/// @returns absent where there are no lines in the band that the fit saw, no model, or too few periods
[[nodiscard]] std::optional<AssumptionTest> test_lines(const LineSpectra& spectra,
                                                       std::span<const PreparedTrial> trials, const Identification& id);

/// Adds the test and, where it is contradicted, the warning.
void warn_of_lines(const AssumptionTest& test, Identification& identification);

}  // namespace mbk::analyse
