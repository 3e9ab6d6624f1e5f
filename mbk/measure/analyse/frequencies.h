#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/analyse/decimation.h"
#include "mbk/model/trial/diagnostics.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::analyse {

/// Power spectra and multiple coherence of the recorded position and force, and the power spectrum of the residual, at
/// the same lines: a segment of the recording lasts exactly as long as one of the trial's rows. Segments are a sixth of
/// the data long, so that eleven overlap by half, or shorter where 96 lines fit into the excited band nevertheless; no
/// segment reaches across a break. The lines go up to five times the excited band or twice the cutoff.
/// @param position, force N×n, as recorded    @param residual rows of the trial×n, or empty    @param rows that count
/// @returns nothing in any of its fields where no piece has nine rows
[[nodiscard]] Result<Spectra> trial_spectra(const Matrix& position, const Matrix& force, const PreparedTrial& trial,
                                            const Matrix& residual, const std::vector<Rows>& rows);

/// Gains of the trial's Savitzky–Golay filters times that of its low-pass, forward and backward, on frequencies that
/// are evenly spaced on a logarithmic axis, from a tenth of the excited band's lower end (and 1e-4 of the sample rate)
/// to 0.45 of the rate.
[[nodiscard]] Result<FilterResponse> filter_response(const PreparedTrial& trial);

}  // namespace mbk::analyse
