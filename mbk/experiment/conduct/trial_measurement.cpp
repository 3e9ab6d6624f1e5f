#include "mbk/experiment/conduct/trial_measurement.h"

#include <utility>

#include "mbk/experiment/control/trial_control.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/preprocess/perturbation_only.h"

namespace mbk::conduct {

measurement::Options measurement_options(const protocol::Trial& trial) {
  measurement::Options options;
  options.identify.handle_mass = trial.handle_mass;
  if (!std::holds_alternative<control::PositionMode>(trial.control)) {
    options.identify.method = Method::instrumental_variables;
  }
  return options;
}

measurement::Options across_missed_ticks(const Recording& recording, Hertz rate, measurement::Options options) {
  if (!options.resample && !recording::inspect(recording).gaps.empty()) options.resample = rate;
  return options;
}

Result<Measurement> measure_recording(const Recording& recording, const measurement::Options& options) {
  return measurement::measure({&recording, 1}, options);
}

Result<Measurement> measure_trial(const std::filesystem::path& file, const protocol::Trial& trial,
                                  const Measure& measure) {
  auto recording = recording::read(file, {});
  if (!recording) return tl::unexpected(recording.error());
  const Recording perturbed = preprocess::perturbation_only(std::move(*recording));
  return measure(perturbed, across_missed_ticks(perturbed, trial.rate, measurement_options(trial)));
}

bool poor(const Identification& identification) {
  return !identification.usable || identification.fit.vaf.minCoeff() < kPoor;
}

}  // namespace mbk::conduct
