#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/document/fields.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/chart.h"
#include "mbk/model/trial/energy.h"
#include "mbk/model/trial/findings.h"
#include "mbk/model/trial/force_comparison.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/passivity.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/warning.h"

/// Descriptions of values that several documents hold. For the sources of this module only.
namespace mbk {

void describe(document::Fields<Warning>& fields);
void describe(document::Fields<SourceFile>& fields);
void describe(document::Fields<Error>& fields);
void describe(document::Fields<Units>& fields);
void describe(document::Fields<Preparation>& fields);
void describe(document::Fields<Fit>& fields);
void describe(document::Fields<EllipseFinding>& fields);
void describe(document::Fields<AntisymmetryFinding>& fields);
void describe(document::Fields<EllipsoidFinding>& fields);
void describe(document::Fields<CirculationFinding>& fields);
void describe(document::Fields<ForceComparison>& fields);
void describe(document::Fields<Energy>& fields);
void describe(document::Fields<Passivity>& fields);
void describe(document::Fields<ChartReference>& fields);

namespace impedance {
void describe(document::Fields<Model>& fields);
}

namespace result {

/// A recording behind a result.
struct TimedInput {
  SourceFile source;
  double duration_s = 0, rate_hz = 0;
};
void describe(document::Fields<TimedInput>& fields);

/// Of named parameters.
struct Covariance {
  std::vector<std::string> parameters;
  Matrix matrix;
};
void describe(document::Fields<Covariance>& fields);

inline constexpr const char* kHeldOut = "held-out";

/// Adds `validated_on`, the data behind VAF and RMSE.
/// @param held_out  gives a bool
template <class T, class Get>
auto& add_validated_on(document::Fields<T>& fields, Get held_out) {
  return fields.add_choice("validated_on", held_out, kHeldOut, "in-sample", "data for VAF and RMSE");
}

/// The units of what moves; none where that is not known.
[[nodiscard]] inline std::optional<Units> known_units(Motion motion) {
  return motion == Motion::unknown ? std::nullopt : std::optional(units_of(motion));
}

}  // namespace result
}  // namespace mbk
