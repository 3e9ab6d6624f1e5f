#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/model/trial/movement.h"

namespace mbk::analyse {

/// Spectral arc length of a speed profile (Balasubramanian, Melendez-Calderon, Roby-Brami & Burdet 2015),
///   SPARC = −Σ_k √( (Δf_k/(f_last − f_first))² + (ΔV_k)² )
/// with V = |DFT of v|/max, of v continued by zeros to 2^(⌈log₂ n⌉ + 4), at the lines up to 10 Hz between the first and
/// the last at which V ≥ 0.05.
/// @param speed ≥ 0, n samples
/// @fails  fewer than three samples; a rate below 20 Hz; a value is not finite; a speed that never changes
[[nodiscard]] Result<double> spectral_arc_length(const Vector& speed, Hertz rate);

/// Log dimensionless jerk of a speed profile (Balasubramanian et al. 2015; Hogan & Sternad 2009),
///   LDLJ = −ln( D³/v_max² Σ_i (Δ²v_i/T²)² T ),   D = n T
/// @fails  as spectral_arc_length, but any rate; a speed that changes at one rate has no jerk
[[nodiscard]] Result<double> log_dimensionless_jerk(const Vector& speed, Hertz rate);

/// Maxima between which the speed falls by at least `share` of its largest value.
[[nodiscard]] int count_peaks(const Vector& speed, double share = 0.05);

struct MovementOptions {
  double cutoff_hz = 20.0;    ///< −3 dB of the Savitzky–Golay filter behind the speed > 0
  double rest_share = 0.05;   ///< of the recording's largest speed: below it the hand rests; in (0, 1)
  double peak_share = 0.2;    ///< of the same, which a reach exceeds; in (rest_share, 1)
  double min_pause_s = 0.1;   ///< a shorter rest is part of the reach
  double min_reach_s = 0.15;  ///< a shorter motion is none
};

/// Rows of the reaches, from rest to rest: stretches of speed above `rest_share` of its largest value, joined over
/// pauses shorter than `min_pause_s`, that are long and fast enough. One that the recording cuts off at its begin or
/// end is none.
[[nodiscard]] std::vector<numeric::RowRange> find_reaches(const Vector& speed, Hertz rate,
                                                          const MovementOptions& options);

/// Reaches of a hand and the measures of Dyck 2013, §2.4, of each: smoothness, path, speed, endpoint, work of the
/// robot, angle of the force. Speed is |ẋ| by a Savitzky–Golay filter of order 4.
/// @param position N×n    @param force_hand_on_robot N×n, or empty    @param target N×n, a position, or empty
/// @fails  usage: an option out of its range. data: too few samples for the filter; a value is not finite; a hand that
/// never moves; no reach in the recording
[[nodiscard]] Result<MovementQuality> movement_quality(const Matrix& position, const Matrix& force_hand_on_robot,
                                                       const Matrix& target, Hertz rate,
                                                       const MovementOptions& options = {});

}  // namespace mbk::analyse
