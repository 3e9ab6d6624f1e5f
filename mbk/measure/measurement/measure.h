#pragma once

#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/preprocess/force_rotation.h"
#include "mbk/measure/preprocess/prepare.h"
#include "mbk/model/trial/diagnostics.h"
#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/plausible_ranges.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

/// Options of a measurement. With the defaults
///
///   const auto measured = mbk::measurement::measure(std::vector{recording}, {});
///
/// does what `mbk measure` does without options.
struct Options {
  /// Channels, windows, filters and derivatives. `preprocess.mode` chooses between the default and the published
  /// procedure; other settings override those of the mode.
  preprocess::Options preprocess;

  /// Method and structure of the fit, handle mass [kg], bootstrap.
  identify::Options identify;

  /// Resample to a uniform clock at this rate first, by linear interpolation. Absent: only if a session missed ticks,
  /// see `measure`.
  std::optional<Hertz> resample;

  /// Delay of the force relative to the position [s]; corrected by linear interpolation. Negative if the force is
  /// early. Shorter than the recording.
  double force_delay = 0.0;

  /// Rotation vector by which the force is rotated first [rad]: corrects a sensor mounted at an angle. Two axes: about
  /// z, from x to y.
  preprocess::RotationVector force_rotation = {};

  /// Also judge passivity: energy absorbed by the limb, and prediction of its model.
  bool passivity = true;

  /// Also give the result at the joints of the arm. The recording must contain the posture of the arm.
  bool joint_domain = false;

  /// Band in which the model is judged for passivity. Absent: the coherent band. Beyond it the model is extrapolated.
  std::optional<std::pair<Hertz, Hertz>> band;

  /// Plausible ranges that are not checked, for devices that differ much from an arm.
  std::set<PlausibleQuantity> ignored_ranges;
};

/// The whole pipeline in one call: inspect, prepare, identify, analyse.
///
/// Solves M ẍ + B ẋ + K (x − x₀) = −F for one axis or two, with F the force of the hand on the robot, in SI units and
/// radians. Several recordings are pooled into one fit; each keeps its own preparation and energy.
///
/// Unspecified options follow from the recording, so that every user gets the same result:
/// - the method, in default mode: instrumental variables if a reference is recorded that explains the motion well (the
///   limb moves the robot too, and least squares is biased) and the instruments are valid; else least squares.
///   Reference mode uses least squares;
/// - the handle mass, see identify::Options;
/// - a clock, in default mode: if a session missed ticks (gaps of at most 0.1 s, at most 5 % of the time), samples are
///   resampled to the uniform clock of the recording (`rate_hz`), with a warning.
///
/// Success does not mean that the numbers can be trusted: look at `identification.usable` and
/// `identification.warnings`. The numbers do not depend on the number of threads.
///
/// @param recordings  at least one, with the same axes and units; unchanged
/// @fails  the person has withdrawn (preprocess::check_consent); a channel is missing; time repeats, runs backwards or
/// has a gap inside the window; a value there is not finite; a window is shorter than the filters need; recordings
/// differ in axes, units or rate; the same file is pooled twice; an option contradicts the recording or is outside its
/// range; the joint domain is requested but no posture is known, or postures differ. A message names the file if the
/// recording has one.
[[nodiscard]] Result<Measurement> measure(std::span<const Recording> recordings, const Options& options);

/// A result with diagnostics: predicted force, autocorrelation of the residual, spectra, filters.
struct Examined {
  Measurement measured;

  /// One for each recording, in their order; if they were pooled, against the common model.
  std::vector<Diagnostics> diagnostics;
};

/// `measure` with the diagnostics, from the same prepared trials. Where a recording holds an accelerometer, it is
/// prepared a second time, with ẍ from the source that was not used; an accelerometer that cannot be (values that are
/// not finite) is omitted.
/// @fails as measure and analyse::diagnose
[[nodiscard]] Result<Examined> examine(std::span<const Recording> recordings, const Options& options);

}  // namespace mbk::measurement
