#pragma once

#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/preprocess/prepare.h"
#include "mbk/model/trial/diagnostics.h"
#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/plausible_ranges.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

/// Everything that may be chosen on the way from a recording to a result. With the defaults
///
///   const auto measured = mbk::measurement::measure(std::vector{recording}, {});
///
/// does what `mbk measure` does without options.
struct Options {
  /// Channels, windows, filters and derivatives. `preprocess.mode` chooses between the default and the published
  /// procedure; whatever else is set there replaces what the mode would choose.
  preprocess::Options preprocess;

  /// Method and structure of the fit, handle mass [kg], bootstrap.
  identify::Options identify;

  /// Put all samples on an even clock at this rate first, by straight lines between them. Absent: only if a session
  /// missed ticks, as `measure` says.
  std::optional<Hertz> resample;

  /// How late the force was read against the position [s]; it is moved back by as much, by straight lines between
  /// samples. Negative if it was read early. Shorter than the recording.
  double force_delay = 0.0;

  /// Angle by which the force is turned first, from x to y [rad]: undoes a sensor that is mounted at an angle. Two axes
  /// only.
  double force_rotation = 0.0;

  /// Judge passivity too: what energy the limb absorbed, and what its model predicts.
  bool passivity = true;

  /// Give the result at the joints of the arm too. Needs the posture of the arm, which the recording has to say.
  bool joint_domain = false;

  /// Frequencies between which the model is judged for passivity. Absent: those at which the data show how the limb
  /// answers. A model says nothing outside of them.
  std::optional<std::pair<Hertz, Hertz>> band;

  /// Plausible ranges that are not checked: a warning less for a device that is far from an arm.
  std::set<PlausibleQuantity> ignored_ranges;
};

/// The whole pipeline in one call: inspect, prepare, identify, analyse.
///
/// Solves M ẍ + B ẋ + K (x − x₀) = −F for one axis or two, with F the force of the hand on the robot, in SI units and
/// radians. Several recordings are pooled into one fit; each keeps its own preparation and energy.
///
/// What is not asked for follows from the recording, so that whoever measures it gets one answer:
/// - the method, in default mode: instrumental variables if a reference is recorded that explains the motion well (the
///   limb moves the robot too, and least squares is biased) and the instruments are valid; else least squares.
///   Reference mode uses least squares;
/// - the handle mass, as identify::Options says;
/// - a clock, in default mode: if a session missed ticks (gaps of at most 0.1 s, at most 5 % of the time), samples are
///   put on the even clock that the recording names (`rate_hz`), and the result warns of it.
///
/// Success does not mean that the numbers can be trusted: look at `identification.usable` and
/// `identification.warnings`. The numbers do not depend on the number of threads.
///
/// @param recordings  at least one, with the same axes and units; unchanged
/// @fails  the person has withdrawn (preprocess::check_consent); a channel is missing; time repeats, runs backwards or
/// has a gap inside the window; a value there is not finite; a window is shorter than the filters need; recordings
/// differ in axes, units or rate; the same file is pooled twice; an option contradicts the recording or is outside its
/// range; the joint domain is asked for and no posture is known, or postures differ. A message names the file if the
/// recording has one.
[[nodiscard]] Result<Measurement> measure(std::span<const Recording> recordings, const Options& options);

/// A result, and what shows how good it is: predicted force, autocorrelation of the residual, spectra, filters.
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
