#include "mbk/study/validation/study.h"

#include <array>

#include "mbk/study/validation/coverage.h"

namespace mbk::validation {

std::span<const Study> studies() {
  static constexpr std::array kStudies = {
      Study{"coverage", "how often the 95 % intervals of M, B, K and x0 hold the truth", 400, coverage_study},
      Study{"recovery", "bias, spread and coverage for a relaxed arm in the closed loop", 20, recovery_study},
      Study{"closed-loop", "least squares, instrumental variables and energy of an arm that acts back", 20,
            closed_loop_study},
      Study{"live-estimate", "how often the 95 % intervals hold the truth while the trial still runs", 200,
            live_estimate_study},
      Study{"springs", "stiffness and mass of the thesis's rigs, identified against true", 3, springs_study},
      Study{"robot", "dynamics of the robot, from its free motion", 50, robot_study},
      Study{"virtual-sensor", "force, stiffness and mass without a force sensor", 4, virtual_sensor_study},
      Study{"transfer-function", "a transfer function of four poles under noise, and its order", 50,
            transfer_function_study},
      Study{"one-dimensional", "no linear model holds for a rigid arm along one axis", 2, one_dimensional_study},
      Study{"teleoperation", "absolute stability of random teleoperators, as decided and as simulated", 25,
            teleoperation_study},
      Study{"participant", "when the simulated participant is active or passive", 10, participant_study},
      Study{"faults", "motors off in time, whatever breaks at 1 kHz", 20, faults_study},
  };
  return kStudies;
}

Result<ValidationTable> coverage_study(const StudyOptions& options) {
  CoverageOptions coverage_options;
  coverage_options.runs = options.runs;
  coverage_options.seed = options.seed;
  coverage_options.threads = options.threads;
  if (options.progress) {
    coverage_options.progress = [&options](int done) { options.progress(done, options.runs); };
  }
  return coverage(coverage_options);
}

}  // namespace mbk::validation
