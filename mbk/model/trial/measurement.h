#pragma once

#include <optional>
#include <vector>

#include "mbk/model/trial/bootstrap_findings.h"
#include "mbk/model/trial/consistent_fit.h"
#include "mbk/model/trial/energy.h"
#include "mbk/model/trial/findings.h"
#include "mbk/model/trial/force_comparison.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/joint_domain.h"
#include "mbk/model/trial/passivity.h"

namespace mbk {

/// Result of `measure` for one recording, or for several pooled ones. Only `identification` is always present; an
/// optional part is absent if it was not requested or cannot be determined from the recording.
struct Measurement {
  /// M, B, K and x₀ with their covariance, fit and warnings, and whether they may be used.
  Identification identification;

  /// Ellipses of M, B and K with intervals. Only with two axes.
  std::optional<Findings> findings;

  /// Ellipsoids of M, B and K with intervals. Only with three axes.
  std::optional<SpatialFindings> spatial;

  /// The other method on the same rows: least squares if the result uses instrumental variables, or the reverse. Absent
  /// if no reference was recorded.
  std::optional<Identification> alternative;

  /// The parameter in which the two methods differ most clearly, and whether that is significant (99 %).
  std::optional<Disagreement> disagreement;

  /// Bootstrap intervals. Absent unless `identify.bootstrap` is above 0.
  std::optional<BootstrapFindings> bootstrap;

  /// The closest model realisable with masses, dampers and springs: symmetric M and K, and M, B and K without a
  /// negative direction. For simulation; the identification remains the estimate.
  std::optional<ConsistentFit> consistent;

  /// Two statements: whether the hand delivered energy in this trial, and at which frequencies the model can. Absent if
  /// `passivity` was false. Neither guarantees that a robot coupled to this person is stable.
  std::optional<Passivity> passivity;

  /// The same at shoulder and elbow. Absent unless `joint_domain` was set.
  std::optional<JointDomain> joints;

  /// If the force was computed from motor torques and a sensor recorded it too: their agreement, and the model from the
  /// sensor.
  std::optional<ForceComparison> force_comparison;
  std::optional<Identification> by_sensor;

  /// Energy that the limb absorbed, one for each recording, in their order. Empty if `passivity` was false.
  std::vector<Energy> energies;
};

}  // namespace mbk
