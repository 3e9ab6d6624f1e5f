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

/// Everything that may be chosen on the way from a recording to a result.
struct Options {
  preprocess::Options preprocess;
  identify::Options identify;
  std::optional<Hertz> resample;  ///< put the samples on an even clock first
  double force_delay = 0.0;       ///< by which the force was read late, undone first [s]
  double force_rotation = 0.0;    ///< by which the force is turned from x to y first [rad]
  bool passivity = true;          ///< judge it too
  bool joint_domain = false;      ///< the result at the joints too
  /// Frequencies for which a model is asked; absent: those at which the data show how the limb answers.
  std::optional<std::pair<Hertz, Hertz>> band;
  std::set<PlausibleQuantity> ignored_ranges;  ///< plausible ranges that are not checked
};

/// The pipeline as one call: inspect, prepare, identify, analyse. Several recordings are pooled into one fit.
///
/// What is not asked for follows from the recording, so that whoever measures it gets one answer:
/// - the method, in default mode: instrumental variables where a reference is recorded that explains the motion well
///   (the limb moves the robot too, and least squares is biased) and they hold, else least squares; least squares in
///   reference mode;
/// - the handle's mass, as identify::Options says;
/// - a clock: where a session missed ticks (gaps of at most 0.1 s, at most 5 % of the time), the samples are put on the
///   even clock that the recording names (`rate_hz`), in default mode; the result warns of it.
/// @fails as its steps and preprocess::check_consent; where the same file is pooled twice;
/// where the joint domain is asked for and pooled recordings were made in different postures;
/// where a recording has a source, the message names its file.
[[nodiscard]] Result<Measurement> measure(std::span<const Recording> recordings, const Options& options);

/// A result, and what shows how good it is.
struct Examined {
  Measurement measured;
  std::vector<Diagnostics> diagnostics;  ///< one for each recording; where they were pooled, against the common model
};

/// `measure` with the diagnostics, from the same prepared trials. Where a recording holds an accelerometer, it is
/// prepared a second time, with ẍ from the source that was not used; an accelerometer that cannot be (values that are
/// not finite) is omitted.
/// @fails as measure and analyse::diagnose
[[nodiscard]] Result<Examined> examine(std::span<const Recording> recordings, const Options& options);

}  // namespace mbk::measurement
