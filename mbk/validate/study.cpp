#include "mbk/validate/study.h"

#include <algorithm>
#include <array>

#include "mbk/validate/coverage.h"

namespace mbk::validation {

namespace {

// What shares the studies judge, with the trials of a run where they are not one.
constexpr std::array kOfCoverage = {JudgedShare{kNominal, 95.0}, JudgedShare{kHardlyEver, 2.0, 0.5}};
constexpr std::array kOfSpatial = {JudgedShare{kNominal, 95.0}, JudgedShare{kHardlyEver, 0.5},
                                   JudgedShare{kNearlyAlways, 99.0}};
constexpr std::array kOfIntervals = {JudgedShare{kNearNominal, 95.0}};
constexpr std::array kOfClosedLoop = {JudgedShare{kNearlyAlways, 100.0},
                                      JudgedShare{kNominal, 95.0, kTrialsWithoutController}};
constexpr std::array kOfPassivity = {JudgedShare{kNever, 0.0}, JudgedShare{kAlways, 100.0}};
constexpr std::array kOfMisspecification = {JudgedShare{kNearlyAlways, 99.0}, JudgedShare{kHardlyEver, 1.0}};
constexpr std::array kOfRobot = {JudgedShare{kNearNominal, 95.0}, JudgedShare{kNearlyAlways, 100.0}};
constexpr std::array kOfVirtualSensor = {JudgedShare{kNearNominal, 100.0, 5.0},  // wide: a damper is not in the model
                                         JudgedShare{kNearlyAlways, 100.0}};
constexpr std::array kOfLiveEstimate = {JudgedShare{kNearNominal, 93.0}, JudgedShare{kHardlyEver, 0.5}};
constexpr std::array kOfTransferFunction = {JudgedShare{kNominalOrMore, 95.0}, JudgedShare{kNearlyAlways, 99.0},
                                            JudgedShare{kHardlyEver, 1.0}};
constexpr std::array kOfReflex = {JudgedShare{kNominal, 95.0}, JudgedShare{kNearlyAlways, 100.0},
                                  JudgedShare{kHardlyEver, 1.0}};
constexpr std::array kOfChange = {JudgedShare{kHardlyEver, 1.0}, JudgedShare{kNearlyAlways, 100.0}};
constexpr std::array kOfFrequencyResponse = {JudgedShare{kHardlyEver, 1.0}, JudgedShare{kNearlyAlways, 100.0},
                                             JudgedShare{kNominal, 95.0, 5.0}};
constexpr std::array kOfDisplacements = {JudgedShare{kNominal, 95.0}, JudgedShare{kNearlyAlways, 100.0}};
constexpr std::array kOfEmg = {JudgedShare{kNominal, 95.0}, JudgedShare{kHardlyEver, 2.5},
                               JudgedShare{kNearlyAlways, 99.0}};
constexpr std::array kOfStretch = {JudgedShare{kNominal, 95.0}, JudgedShare{kHardlyEver, 1.0}};
constexpr std::array kOfTeleoperation = {JudgedShare{kHardlyEver, 0.0, 0.3}};  // of 4 random designs
constexpr std::array kOfParticipant = {JudgedShare{kNearlyAlways, 100.0}};
constexpr std::array kOfReliability = {JudgedShare{kNominal, 95.0}, JudgedShare{kFalsePositives, 5.0}};
constexpr std::array kOfFaultsAtAll = {JudgedShare{kNearNominal, 100.0}, JudgedShare{kHardlyEver, 0.0, 10.0}};

}  // namespace

std::span<const Study> studies() {
  static constexpr std::array kStudies = {
      Study{"coverage", "how often the 95 % intervals of M, B, K and x0 contain the truth", kOfCoverage, 2,
            coverage_study},
      Study{"spatial", "three axes: intervals, ellipsoids, turned sensors and verdicts", kOfSpatial, 2, spatial_study},
      Study{"recovery", "bias, spread and coverage for a relaxed arm in the closed loop", kOfIntervals, 2,
            recovery_study},
      Study{"closed-loop", "both methods and the energy of an arm with voluntary control", kOfClosedLoop, 2,
            closed_loop_study},
      Study{"passivity", "verdicts on passivity, for relaxed arms and arms that generate energy", kOfPassivity, 2,
            passivity_study},
      Study{"misspecification", "warnings where M, B and K are valid and where they are not", kOfMisspecification, 2,
            [](const StudyOptions& options) { return misspecification_study(options); }},
      Study{"live-estimate", "how often the 95 % intervals contain the truth during the trial", kOfLiveEstimate, 2,
            live_estimate_study},
      Study{"springs", "stiffness and mass of the thesis's rigs, identified against true", {}, 3, springs_study},
      Study{"robot", "dynamics of the robot, from its free motion", kOfRobot, 2, robot_study},
      Study{"virtual-sensor", "force, stiffness and mass without a force sensor", kOfVirtualSensor, 2,
            virtual_sensor_study},
      Study{"transfer-function", "a transfer function of four poles under noise, and its order", kOfTransferFunction, 2,
            transfer_function_study},
      Study{"frequency-response", "frequency responses without a model, and noise distinguished from distortion",
            kOfFrequencyResponse, 2, frequency_response_study},
      Study{"ramp-and-hold", "stiffness of a relaxed arm from the plateaus of ramps and holds", kOfDisplacements, 2,
            ramp_and_hold_study},
      Study{"servo-displacement", "stiffness of a reaching hand, displaced from its predicted path", kOfDisplacements,
            2, servo_displacement_study},
      Study{"stretch", "slope over speed and angle of catch of stretched elbows, with a reflex or not", kOfStretch, 2,
            stretch_study},
      Study{"one-dimensional", "no linear model describes a rigid arm along one axis", {}, 4, one_dimensional_study},
      Study{"reflex", "impulse response, intrinsic and reflex force of limbs that have them or not", kOfReflex, 2,
            reflex_study},
      Study{"change", "M, B and K over time, of arms that change and that do not", kOfChange, 2, change_study},
      Study{"after-onset", "what the first 120 ms after a pulse show of a rigid arm", kOfChange, 2, after_onset_study},
      Study{"emg", "amplitude and latency of EMG responses after a perturbation", kOfEmg, 1000, emg_study},
      Study{"reliability", "ICC, SEM, MDC and differences of groups, of studies drawn from known variances",
            kOfReliability, 2, reliability_study},
      Study{"recorded-reliability",
            "ICC and MDC of 20 people in 3 sessions, through whole recordings",
            {},
            20,
            recorded_reliability_study},
      Study{"teleoperation", "absolute stability of random teleoperators, decided and simulated", kOfTeleoperation, 1,
            teleoperation_study},
      Study{"participant", "when the simulated participant is active or passive", kOfParticipant, 2, participant_study},
      Study{"faults", "motors off in time after any single fault", kOfFaultsAtAll, 1, faults_study},
  };
  return kStudies;
}

int min_runs(const Study& study) {
  int runs = 2;
  for (const JudgedShare& judged : study.shares) runs = std::max(runs, min_runs(judged));
  return runs;
}

int default_runs(const Study& study) {
  int runs = study.usual_runs;
  for (const JudgedShare& judged : study.shares) runs = std::max(runs, default_runs(judged));
  return runs;
}

Result<ValidationTable> coverage_study(const StudyOptions& options) {
  CoverageOptions coverage_options;
  coverage_options.runs = options.runs;
  coverage_options.seed = options.seed;
  coverage_options.threads = options.threads;
  coverage_options.progress = options.progress;
  coverage_options.elsewhere = options.elsewhere;
  return coverage(coverage_options);
}

}  // namespace mbk::validation
