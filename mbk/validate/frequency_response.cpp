#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/measure/explore/local_polynomial.h"
#include "mbk/measure/explore/periodic_response.h"
#include "mbk/model/perturbation/multisine.h"
#include "mbk/model/perturbation/odd_grid.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kExploredStep = 0.005, kExploredPeriod = 5.0;
constexpr int kRealisationPairs = 4, kExploredPeriods = 3;

/// An arm at a robot that follows a reference r with a spring and a damper,
///   (M + M_r) ẍ = K_r (r − x) − B_r ẋ − B ẋ − K x − κ |x|² x + w,   −F_h = M ẍ + B ẋ + K x + κ |x|² x − w
/// with the participant's noise w: what the robot yields, noise moves, and what moves the hand comes back as force.
struct ArmAtRobot {
  Matrix2d M, B, K;
  double cubic = 0.0;                                                   ///< κ [N/m³]
  double robot_mass = 1.0, robot_damping = 0.0, robot_stiffness = 0.0;  ///< M_r, B_r, K_r of each axis
  double noise = 0.0;  ///< of w, standard deviation at 1.5 Hz bandwidth [N]
};

ArmAtRobot relaxed_arm(bool stiff) {
  ArmAtRobot arm;
  arm.M << 1.33, -0.93, -0.93, 1.88;
  arm.B << 5.76, -2.14, -2.14, 10.56;
  arm.K << 42.4, -20.9, -36.3, 125.3;
  arm.robot_stiffness = stiff ? 4000.0 : 200.0;
  arm.robot_damping = stiff ? 120.0 : 15.0;
  arm.noise = 0.3;
  return arm;
}

Eigen::Matrix2cd dynamic_stiffness(const ArmAtRobot& arm, double hertz) {
  const double omega = 2.0 * std::numbers::pi * hertz;
  return arm.K.cast<std::complex<double>>() + std::complex<double>(0.0, omega) * arm.B - omega * omega * arm.M;
}

/// Its trial: the reference given at half steps, the state integrated by Runge & Kutta (4th order), noise held over a
/// step.   @param skip  samples in which it settles, that are not recorded
ExplorationTrial simulated_trial(const ArmAtRobot& arm, const std::vector<Vector2d>& reference, Index skip,
                                 std::uint64_t seed) {
  const auto samples = static_cast<Index>((reference.size() - 1) / 2);
  const Matrix2d inverse = (arm.M + arm.robot_mass * Matrix2d::Identity()).inverse();
  numeric::Random random(seed, 3);
  const double pole = std::exp(-2.0 * std::numbers::pi * 1.5 * kExploredStep);
  Vector2d x = Vector2d::Zero(), v = Vector2d::Zero(), w = Vector2d::Zero();
  const auto acceleration = [&](const Vector2d& place, const Vector2d& speed, const Vector2d& target) -> Vector2d {
    return inverse * (arm.robot_stiffness * (target - place) - arm.robot_damping * speed - arm.B * speed -
                      arm.K * place - arm.cubic * place.squaredNorm() * place + w);
  };
  ExplorationTrial trial;
  trial.sample_time = kExploredStep;
  const Index kept = samples - skip;
  trial.input.resize(kept, 2);
  trial.output.resize(kept, 2);
  trial.reference.resize(kept, 2);
  for (const char* const axis : {"x", "y"}) {
    trial.input_labels.push_back({axis, "m"});
    trial.output_labels.push_back({std::string("F") + axis, "N"});
  }
  const double h = kExploredStep;
  for (Index i = 0; i < samples; ++i) {
    for (double& value : w) value = pole * value + std::sqrt(1.0 - pole * pole) * arm.noise * random.normal();
    const Vector2d &r0 = reference[static_cast<std::size_t>(2 * i)],
                   &r1 = reference[static_cast<std::size_t>(2 * i + 1)],
                   &r2 = reference[static_cast<std::size_t>(2 * i + 2)];
    const Vector2d a0 = acceleration(x, v, r0);
    if (i >= skip) {
      trial.input.row(i - skip) = x.transpose();
      trial.reference.row(i - skip) = r0.transpose();
      trial.output.row(i - skip) =
          (arm.M * a0 + arm.B * v + arm.K * x + arm.cubic * x.squaredNorm() * x - w).transpose();
    }
    const Vector2d v1 = v + 0.5 * h * a0, a1 = acceleration(x + 0.5 * h * v, v1, r1);
    const Vector2d v2 = v + 0.5 * h * a1, a2 = acceleration(x + 0.5 * h * v1, v2, r1);
    const Vector2d v3 = v + h * a2, a3 = acceleration(x + h * v2, v3, r2);
    x += h / 6.0 * (v + 2.0 * v1 + 2.0 * v2 + v3);
    v += h / 6.0 * (a0 + 2.0 * a1 + 2.0 * a2 + a3);
  }
  return trial;
}

/// Pairs of trials with orthogonal references of odd lines up to 5 Hz, 8 mm (rms) in each axis, after a period to
/// settle.
Result<std::vector<ExplorationTrial>> pairs_of_trials(const ArmAtRobot& arm, int pairs, std::uint64_t seed) {
  const auto lines = MBK_TRY(perturbation::odd_grid(25, 4, 1));
  const std::vector<double> amplitudes(lines.size(), 1.0);
  std::vector<ExplorationTrial> trials;
  for (int pair = 0; pair < pairs; ++pair) {
    std::vector<perturbation::Multisine> axes;
    for (std::uint32_t axis = 0; axis < 2; ++axis) {
      auto sines = MBK_TRY(perturbation::Multisine::with_random_phases(
          kExploredPeriod, lines, amplitudes, seed, 100U + 2U * static_cast<std::uint32_t>(pair) + axis));
      axes.push_back(sines.scaled(0.008 / sines.root_mean_square()));
    }
    constexpr int kHalfSteps = static_cast<int>(2.0 * kExploredPeriod / kExploredStep + 0.5);
    std::vector<Vector2d> period;
    for (int i = 0; i < kHalfSteps; ++i) {
      const double t = 0.5 * kExploredStep * i;
      period.emplace_back(axes[0].at(t).value, axes[1].at(t).value);
    }
    for (const double sign : {1.0, -1.0}) {
      std::vector<Vector2d> reference;
      for (int i = 0; i <= (kExploredPeriods + 1) * kHalfSteps; ++i) {
        const Vector2d& r = period[static_cast<std::size_t>(i % kHalfSteps)];
        reference.emplace_back(r[0], sign * r[1]);
      }
      trials.push_back(simulated_trial(arm, reference, kHalfSteps / 2, seed * 1000 + trials.size()));
    }
  }
  return trials;
}

/// One trial of a minute whose reference is drawn anew every 0.1 s, behind three low-passes of 6 Hz: what is sampled
/// has nothing above half the sample rate.
ExplorationTrial random_trial(const ArmAtRobot& arm, std::uint64_t seed) {
  constexpr Index kSamples = 12'000;
  constexpr int kHold = 40;  // half steps
  numeric::Random random(seed, 5);
  std::vector<Vector2d> reference;
  const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * 6.0 * 0.5 * kExploredStep);
  Vector2d drawn = Vector2d::Zero();
  std::array<Vector2d, 3> passed = {drawn, drawn, drawn};
  for (Index i = 0; i <= 2 * (kSamples + 400); ++i) {
    if (i % kHold == 0) drawn = Vector2d(0.008 * random.normal(), 0.008 * random.normal());
    for (std::size_t k = 0; k < passed.size(); ++k) passed[k] += share * ((k == 0 ? drawn : passed[k - 1]) - passed[k]);
    reference.push_back(passed.back());
  }
  return simulated_trial(arm, reference, 400, seed);
}

struct Covered {
  int inside = 0, magnitude_inside = 0, all = 0;
};

/// Of each line one entry in turn, since those of one line share their noise.
void count_covered(const FrequencyResponseEstimate& found, const ArmAtRobot& arm, double to_hz, std::uint64_t seed,
                   Index every, Covered& covered) {
  for (Index k = 0; k < found.size(); k += every) {
    if (found.frequency[k] > to_hz) break;
    const Index entry = (k / every + static_cast<Index>(seed % 4)) % 4;
    const std::complex<double> truth = dynamic_stiffness(arm, found.frequency[k]).reshaped()[entry];
    const std::complex<double> estimate = found.response[static_cast<std::size_t>(k)].reshaped()[entry];
    covered.inside += std::abs(estimate - truth) <= found.radius95(k, entry) ? 1 : 0;
    const bool within =
        std::abs(truth) >= found.magnitude_low(k, entry) && std::abs(truth) <= found.magnitude_high(k, entry);
    covered.magnitude_inside += within ? 1 : 0;
    ++covered.all;
  }
}

struct ExploredArm {
  Covered robust, fast, local;
  double total = 0, noise = 0;  ///< variances of the response, summed over lines and entries
  bool called_nonlinear = false, even_said = false, odd_said = false, hardening_said = false;
};

struct ExploredRun {
  std::array<ExploredArm, 2> arms;  ///< at a stiff robot, and at one that yields
};

Result<ExploredArm> explored_arm(bool stiff, std::uint64_t seed) {
  const ArmAtRobot arm = relaxed_arm(stiff);
  ExploredArm run;
  constexpr double kTo = 5.0;
  const auto trials = MBK_TRY(pairs_of_trials(arm, kRealisationPairs, seed));
  const auto robust = MBK_TRY(explore::periodic_response(trials, {.max_frequency_hz = kTo}));
  count_covered(robust, arm, kTo, seed, 1, run.robust);
  for (std::size_t k = 0; k < robust.covariance.size(); ++k) {
    run.total += robust.covariance[k].trace().real();
    run.noise += robust.noise_covariance[k].trace().real();
  }
  run.called_nonlinear = robust.periodic->total_over_noise_p < 0.01;
  const auto fast = MBK_TRY(explore::periodic_response({trials.data(), 2}, {.max_frequency_hz = kTo}));
  count_covered(fast, arm, kTo, seed, 1, run.fast);
  run.even_said = fast.periodic->even && fast.periodic->even->detected();
  run.odd_said = fast.periodic->odd_lines && fast.periodic->odd_lines->detected();
  ArmAtRobot hardening = arm;
  hardening.cubic = 2e5;
  const auto hard = MBK_TRY(pairs_of_trials(hardening, kRealisationPairs, seed));
  const auto distorted = MBK_TRY(explore::periodic_response(hard, {.max_frequency_hz = kTo}));
  run.hardening_said = distorted.periodic->total_over_noise_p < 0.01;
  const ExplorationTrial one = random_trial(arm, seed);
  const auto local = MBK_TRY(explore::local_polynomial_response({&one, 1}, {0.5, kTo}));
  count_covered(local, arm, kTo, seed, 2, run.local);  // neighbours share half of their lines
  return run;
}

Result<ExploredRun> explored_run(std::uint64_t seed) {
  ExploredRun run;
  for (const std::size_t k : {0U, 1U}) {
    run.arms[k] = MBK_TRY(explored_arm(k == 0, seed));
  }
  return run;
}

}  // namespace

Result<ValidationTable> frequency_response_study(const StudyOptions& options) {
  const auto ran = MBK_TRY(seeded_runs(options, explored_run));
  ValidationTable table{"frequency-response",
                        "how often do the 95 % bands of a frequency response contain the truth, and is distortion "
                        "distinguished from noise?",
                        "share", options.runs, options.seed};
  constexpr std::array kLoops = {"stiff robot", "yielding robot"};
  for (std::size_t k = 0; k < kLoops.size(); ++k) {
    const std::string loop = kLoops[k];
    const auto covered_rows = [&](Covered ExploredArm::*of, const std::string& method, Range expected) {
      Covered sum;
      for (const ExploredRun& run : ran) {
        const Covered& one = run.arms[k].*of;
        sum.inside += one.inside;
        sum.magnitude_inside += one.magnitude_inside;
        sum.all += one.all;
      }
      table.rows.push_back(
          share_row(loop + ", " + method + ": 95 % region holds the response", sum.inside, sum.all, expected));
      table.rows.push_back(share_row(loop + ", " + method + ": 95 % interval holds the magnitude", sum.magnitude_inside,
                                     sum.all, expected));
    };
    covered_rows(&ExploredArm::robust, "robust", kNominal);
    covered_rows(&ExploredArm::fast, "fast", kNominalOrMore);  // odd distortion is added where it is not below 0
    covered_rows(&ExploredArm::local, "local polynomial", kNominal);
    Vector ratio(options.runs);
    double noise = 0.0;
    for (const ExploredRun& run : ran) noise += run.arms[k].noise / static_cast<double>(options.runs);
    for (Index i = 0; i < ratio.size(); ++i) ratio[i] = ran[static_cast<std::size_t>(i)].arms[k].total / noise;
    table.rows.push_back(mean_row(loop + ": variance over realisations, over that of noise", ratio,
                                  k == 0 ? std::optional(Range{0.9, 1.1}) : std::nullopt, ""));
    const auto said = [&](bool ExploredArm::*what) {
      return [k, what](const ExploredRun& run) { return run.arms[k].*what; };
    };
    table.rows.push_back(share_row(loop + ": linear arm called nonlinear by realisations", ran,
                                   said(&ExploredArm::called_nonlinear), kHardlyEver));
    table.rows.push_back(
        share_row(loop + ": linear arm, even distortion said", ran, said(&ExploredArm::even_said), kHardlyEver));
    table.rows.push_back(
        share_row(loop + ": linear arm, odd distortion said", ran, said(&ExploredArm::odd_said), kHardlyEver));
    if (k > 0) continue;  // at a robot that yields the hand moves too little for the distortion to stand out
    table.rows.push_back(
        share_row(loop + ": hardening arm called nonlinear", ran, said(&ExploredArm::hardening_said), kNearlyAlways));
  }
  return table;
}

}  // namespace mbk::validation
