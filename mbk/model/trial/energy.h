#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/units.h"
#include "mbk/model/trial/findings.h"
#include "mbk/model/trial/verdict.h"

namespace mbk {

/// The conclusion from an interval of absorbed energy; an unknown interval allows none.
[[nodiscard]] constexpr Verdict verdict_of(const Interval& absorbed95) {
  if (absorbed95.first > 0.0) return Verdict::passive;
  return absorbed95.second < 0.0 ? Verdict::active : Verdict::undecided;
}

/// Energy that the limb absorbed up to each instant of the whole recording. At a clock gap or a NaN the energy is
/// unknown and is kept constant. Decimated for display without losing extremes; a row of NaN marks a visible gap of the
/// clock.
struct EnergyCurve {
  Vector time;      ///< [s] from the recording's first sample
  Vector absorbed;  ///< E [J], 0 at the first sample; a sustained fall means that the limb generates
  Vector curl;      ///< what the antisymmetric stiffness absorbed, from the first sample [J]; empty without a model
  double end = 0;   ///< E at the last sample [J]
};

/// Energy in one part of the window: a perturbation, from its onset to its end, or a block of a sustained one.
struct EnergyPart {
  double from_s = 0, to_s = 0;      ///< [s] from the recording's first sample
  double absorbed = 0;              ///< by the limb in this part [J]
  double largest_displacement = 0;  ///< largest distance from where the part begins [m], of the recorded samples
  double path_length = 0;           ///< ∫ |v| dt [m]
  double squared_velocity = 0;      ///< ∫ v·v dt [m²/s]
  double shortage = 0;              ///< λ = −absorbed/squared_velocity [N·s/m], signed; NaN where nothing moves
};

/// Passivity of the data over a window, or over the windows of several recordings one after another.
/// The shortage of passivity is λ(t) = −E(t)/∫₀ᵗ v·v dτ [N·s/m or N·m·s/rad], negative for an excess (Dyck 2013,
/// eq. 4.3). Intervals are NaN where there are too few blocks.
struct EnergyAccount {
  double duration = 0;    ///< of the window [s], without unknown parts
  double absorbed = 0;    ///< E, energy absorbed by the limb in the window [J]
  Interval absorbed95;    ///< two-sided
  double lower95 = 0;     ///< E is above it with 95 % confidence
  double upper95 = 0;     ///< E is below it with 95 % confidence
  double mean_power = 0;  ///< E/duration [W]
  Interval mean_power95;
  double squared_velocity = 0;  ///< ∫ v·v dt over the window [m²/s]
  double shortage_at_end = 0;   ///< λ at the end of the window
  Interval shortage_at_end95;
  double shortage_largest = 0;  ///< the largest λ(t), from where ∫ v·v has reached the first share of its end
  Interval shortage_largest95;
  Index blocks = 0;  ///< number of blocks used for the intervals
  Verdict verdict = Verdict::undecided;
  std::string reason;  ///< of the verdict, in words
};

/// Energy at one line of a periodic perturbation, −∫ F_h·v dt of the parts of force and motion at its frequency, over
/// whole periods. The sum over the lines is the energy of those periods, except for noise and non-periodic parts.
struct EnergyLine {
  Hertz frequency;
  double duration = 0;  ///< of those periods [s]
  double absorbed = 0;  ///< [J]
  Interval absorbed95;  ///< 95 % for all lines jointly, from the differences between periods
};

/// Work of the antisymmetric stiffness k_a = (k_xy − k_yx)/2 along the path of the hand; absorbed energy is positive.
struct CurlWork {
  double k_a = 0;       ///< [N/m]
  double absorbed = 0;  ///< in the window [J]
  double share = 0;     ///< of E in the window; NaN where E is 0
};

/// Energy that the limb exchanged with the machine in one recording.
struct Energy {
  EnergyCurve curve;                 ///< of the whole recording
  double from_s = 0, to_s = 0;       ///< the window: first and last analysed sample
  double left_out_s = 0;             ///< of it, where the clock has gaps, or force or velocity are not known
  double shortage_largest_at_s = 0;  ///< when [s] from the recording's first sample
  EnergyAccount account;             ///< of the window
  /// ∫ Ḟ_h·v dt over the window [W]: what a force that is recorded late adds to E, for each second of delay.
  double added_per_delay = 0;
  /// E/added_per_delay [s]: a force recorded as much later than the position (earlier, where it is negative) would make
  /// up the whole of E. Judge by it whether the two were simultaneous enough; infinite where delay changes nothing.
  double delay_that_makes_it_up = 0;
  bool parts_are_perturbations = false;  ///< false: blocks of about 2.5 s
  std::vector<EnergyPart> parts;         ///< in order of time
  std::optional<CurlWork> curl;          ///< only with a model of two axes
};

}  // namespace mbk
