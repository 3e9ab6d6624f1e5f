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

/// What `measure` found for one recording, or for several pooled.
struct Measurement {
  Identification identification;
  std::optional<Findings> findings;  ///< absent where they were not asked for, or with one axis
  /// The other method on the same rows; absent where no reference was recorded.
  std::optional<Identification> alternative;
  std::optional<Disagreement> disagreement;
  std::optional<BootstrapFindings> bootstrap;  ///< where it was asked for
  std::optional<ConsistentFit> consistent;     ///< nearest to the model that describes the limb
  std::optional<Passivity> passivity;
  std::optional<JointDomain> joints;  ///< where it was asked for
  /// Where the force was computed and a sensor recorded it too: how both agree, and the model by the sensor.
  std::optional<ForceComparison> force_comparison;
  std::optional<Identification> by_sensor;
  std::vector<Energy> energies;  ///< one for each recording, beside the passivity
};

}  // namespace mbk
