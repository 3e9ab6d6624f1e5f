#include "mbk/trial/warning.h"

namespace mbk {

std::string_view text(WarningCode code) {
  switch (code) {
    case WarningCode::inertia_not_positive:
      return "inertia-not-positive";
    case WarningCode::damping_not_positive:
      return "damping-not-positive";
    case WarningCode::stiffness_not_positive:
      return "stiffness-not-positive";
    case WarningCode::band_too_narrow:
      return "band-too-narrow";
    case WarningCode::motion_on_one_line:
      return "motion-on-one-line";
    case WarningCode::motion_too_small:
      return "motion-too-small";
    case WarningCode::poorly_conditioned:
      return "poorly-conditioned";
    case WarningCode::held_back_fit_poor:
      return "held-back-fit-poor";
    case WarningCode::fit_poor:
      return "fit-poor";
    case WarningCode::no_held_back_data:
      return "no-held-back-data";
    case WarningCode::clock_jitter:
      return "clock-jitter";
    case WarningCode::resampled:
      return "resampled";
    case WarningCode::clipping:
      return "clipping";
    case WarningCode::too_little_data:
      return "too-little-data";
    case WarningCode::decimation_changes_model:
      return "decimation-changes-model";
  }
  return "unknown";
}

}  // namespace mbk
