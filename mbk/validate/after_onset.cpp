#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "mbk/measure/measurement/explore.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace after_onset_detail {

using laboratory::Scenario;

constexpr double kWindow = 0.12;                                  ///< [s]
constexpr double kInertiaWithin = 0.25, kStiffnessWithin = 0.45;  ///< of the norm

/// So many trials of a ready scenario, pooled.
struct Pool {
  const char* name;
  const char* scenario;
  int trials;
  bool moved_enough;  ///< for the inertia to be told
};

// Forty trials hold the ten first ones of the same seed.
constexpr std::array kPools = {Pool{"1 trial of 8 N", "rigid_underdamped_8N", 1, true},
                               Pool{"10 trials of 8 N", "rigid_underdamped_8N", 10, true},
                               Pool{"40 trials of 8 N", "rigid_underdamped_8N", 40, true},
                               Pool{"10 trials of 2 N", "rigid_underdamped_2N", 10, false}};

struct MatrixFound {
  bool identifiable = false;
  double off = 0;   ///< ‖estimate − truth‖/‖truth‖
  double held = 0;  ///< share of the entries that their intervals hold
};

struct PoolRun {
  MatrixFound M, B, K;
};

MatrixFound compared(const MatrixEstimate& found, const Matrix& truth) {
  const Matrix away = found.value - truth;
  const auto held = (away.array().abs() <= found.half_width.array()).count();
  return {found.identifiable, away.norm() / truth.norm(),
          static_cast<double>(held) / static_cast<double>(truth.size())};
}

/// The trials of a run have seeds of their own: no two runs share one.
Result<std::vector<laboratory::Performance>> performed(const char* scenario, int trials, std::uint64_t run) {
  constexpr std::uint64_t kTrialsOfARun = 1000;
  auto scenarios = MBK_TRY(ready(scenario));
  std::vector<laboratory::Performance> performances;
  for (int k = 0; k < trials; ++k) {
    Scenario one = scenarios.front();
    one.seed = run * kTrialsOfARun + static_cast<std::uint64_t>(k);
    auto performance = MBK_TRY(laboratory::simulate(one));
    performances.push_back(std::move(performance));
  }
  return performances;
}

Result<PoolRun> found_in(std::span<const Recording> recordings, const impedance::Model& truth) {
  measurement::ExploreOptions options;
  options.after_onset_s = kWindow;
  const auto found = MBK_TRY(measurement::after_onset(recordings, options));
  return PoolRun{compared(found.M, truth.M), compared(found.B, truth.B), compared(found.K, truth.K)};
}

Result<std::vector<PoolRun>> run_of(std::uint64_t seed) {
  std::vector<PoolRun> runs;
  std::vector<Recording> recordings;
  impedance::Model truth;
  std::string scenario;
  for (const Pool& pool : kPools) {
    if (scenario != pool.scenario || static_cast<int>(recordings.size()) < pool.trials) {
      const auto largest = std::ranges::max_element(kPools, {}, [&](const Pool& other) {
        return std::string_view(other.scenario) == pool.scenario ? other.trials : 0;
      });
      auto performances = MBK_TRY(performed(pool.scenario, largest->trials, seed));
      truth = performances.front().truth;
      recordings.clear();
      for (laboratory::Performance& one : performances) recordings.push_back(std::move(one.recording));
      scenario = pool.scenario;
    }
    const auto found = found_in(std::span(recordings).first(static_cast<std::size_t>(pool.trials)), truth);
    if (!found) return tl::unexpected(found.error().in(pool.name));
    runs.push_back(*found);
  }
  return runs;
}

/// The rows of one matrix of one pool.
void add_rows(ValidationTable& table, const std::string& name, const std::vector<MatrixFound>& found, double within,
              bool judged) {
  Vector off(static_cast<Index>(found.size()));
  double held = 0.0;
  for (std::size_t run = 0; run < found.size(); ++run) {
    off[static_cast<Index>(run)] = 100.0 * found[run].off;
    held += found[run].held;
  }
  const auto runs = static_cast<int>(found.size());
  table.rows.push_back(share_row(
      name + " called identifiable, and off by more", found,
      [&](const MatrixFound& one) { return one.identifiable && one.off > within; }, kHardlyEver));
  table.rows.push_back(share_row(
      name + " called identifiable", found, [](const MatrixFound& one) { return one.identifiable; },
      judged ? std::optional(kNearlyAlways) : std::nullopt));
  table.rows.push_back(median_row(name + " off by", off, {}, "%"));
  table.rows.push_back(
      share_row(name + ": entries inside their intervals", static_cast<int>(std::lround(held)), runs, {}));
}

}  // namespace after_onset_detail

Result<ValidationTable> after_onset_study(const StudyOptions& options) {
  using namespace after_onset_detail;
  const auto runs = MBK_TRY(seeded_runs(options, run_of));
  ValidationTable table{
      "after-onset",
      "what do the first 120 ms after a pulse show of a rigid arm, and is it correctly called identifiable?",
      "% of the runs", options.runs, options.seed};
  for (std::size_t p = 0; p < kPools.size(); ++p) {
    const auto of = [&](MatrixFound PoolRun::*matrix) {
      std::vector<MatrixFound> found;
      for (const auto& run : runs) found.push_back(run[p].*matrix);
      return found;
    };
    const std::string name = kPools[p].name;
    add_rows(table, name + ": M", of(&PoolRun::M), kInertiaWithin, kPools[p].moved_enough && kPools[p].trials > 1);
    add_rows(table, name + ": K", of(&PoolRun::K), kStiffnessWithin, false);
  }
  table.notes = {
      "Rigid arm of participant P1 (Dyck 2013), 16 pulses a trial. 'Off by more' is more than 25 % of the norm of M "
      "and "
      "45 % of that of K.",
      "'Inside' is the share of the four entries over all runs."};
  return table;
}

}  // namespace mbk::validation
