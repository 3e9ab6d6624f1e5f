#include "mbk/experiment/conduct/trial_measurement.h"

#include <utility>

#include "mbk/files/recording/read.h"
#include "mbk/measure/preprocess/perturbation_only.h"

namespace mbk::conduct {

Result<Measurement> measure_recording(const Recording& recording) {
  return measurement::measure({&recording, 1}, {});
}

Result<Measurement> measure_trial(const std::filesystem::path& file, const Measure& measure) {
  recording::ReadOptions options;
  options.own_samples = true;
  auto recording = MBK_TRY(recording::read(file, options));
  return measure(preprocess::perturbation_only(std::move(recording)));
}

bool poor(const Identification& identification) {
  return !identification.usable || identification.fit.vaf.minCoeff() < kPoor;
}

}  // namespace mbk::conduct
