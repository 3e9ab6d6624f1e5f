#include "mbk/validate/coverage.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/simulate/laboratory/prescribed_motion.h"
#include "mbk/validate/each_run.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"

namespace mbk::validation {
namespace {

/// Whether an interval of one run holds the truth, by name; where a study asks for less, its rows are not there.
using Held = std::vector<std::pair<std::string, bool>>;

bool holds(const Interval& interval, double truth) {
  return interval.first <= truth && truth <= interval.second;
}

laboratory::PrescribedMotionOptions laboratory_of(const CoverageOptions& options, int run) {
  laboratory::PrescribedMotionOptions lab;
  lab.seed = options.seed * 1'000'003u + static_cast<std::uint64_t>(run);
  lab.sensors.coloured_force_noise = options.remnant_force;
  return lab;
}

Result<Measurement> measured_of(const laboratory::PrescribedMotionOptions& lab, const measurement::Options& options) {
  const auto recording = MBK_TRY(laboratory::record_prescribed_motion(lab, Hertz(1000.0)));
  return measurement::measure({&recording, 1}, options);
}

void add_ellipses(const Findings& findings, const impedance::Model& truth, Held& held) {
  const std::array<const Matrix*, 3> matrices = {&truth.M, &truth.B, &truth.K};
  for (std::size_t k = 0; k < matrices.size(); ++k) {
    const EllipseFinding& finding = findings.ellipses[k];
    const impedance::Ellipse true_ellipse = impedance::ellipse(*matrices[k]);
    const double turns = std::round((finding.ellipse.orientation - true_ellipse.orientation) / std::numbers::pi);
    const std::string name = kMatrixNames[k];
    held.emplace_back(name + " area", holds(finding.area95, true_ellipse.area));
    held.emplace_back(name + " shape", holds(finding.shape95, true_ellipse.shape));
    held.emplace_back(name + " orientation",
                      holds(finding.orientation95, true_ellipse.orientation + turns * std::numbers::pi));
  }
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
    held.emplace_back(
        std::string(k == 0 ? "inertia" : "stiffness") + " antisymmetry",
        holds(findings.antisymmetry[k].value95, impedance::antisymmetric_part(k == 0 ? truth.M : truth.K)));
  }
}

/// Which intervals of one run hold the truth: of M, B, K and x₀, of the ellipses, of the excess of passivity.
Result<Held> held_by(const CoverageOptions& options, int run) {
  const laboratory::PrescribedMotionOptions lab = laboratory_of(options, run);
  const auto measured = measured_of(lab, {});
  if (!measured) return tl::unexpected(measured.error());
  const Identification& id = measured->identification;
  const Vector error = impedance::stacked(id.model) - impedance::stacked(lab.limb);
  const Vector reach = numeric::kNormal95 * impedance::stacked(id.standard_error);
  Held held;
  for (Index k = 0; k < error.size(); ++k) {
    held.emplace_back(id.parameters[static_cast<std::size_t>(k)], std::abs(error[k]) <= reach[k]);
  }
  if (measured->findings) add_ellipses(*measured->findings, lab.limb, held);
  const auto truth = impedance::excess_of_passivity(lab.limb);
  const ModelPassivity& passivity = measured->passivity->models.front();
  held.emplace_back("excess of passivity",
                    truth && passivity.excess && holds(passivity.excess->corrected95, truth->value));
  return held;
}

/// The band in which the arms below are judged: from the second line of the perturbation to the last. At the first, 0.1
/// Hz, one trial with this noise cannot tell any arm passive, and what is never said is never wrong.
std::pair<Hertz, Hertz> judged_band() {
  return {Hertz(0.4), Hertz(2.9)};
}

constexpr double kBarelyActive = 1.0001, kWellPassive = 0.25;

/// An arm whose stiffness, inertia or both are antisymmetric, with opposite signs, so that |ω m_a − k_a/ω| is `share`
/// of √det B at one end of the band, and less elsewhere.
impedance::Model antisymmetric_arm(impedance::Model arm, int kind, double share) {
  const double low = 2.0 * std::numbers::pi * judged_band().first.value;
  const double high = 2.0 * std::numbers::pi * judged_band().second.value;
  const double edge = share * std::sqrt(numeric::determinant(impedance::symmetric_part(arm.B)));
  double k_a = edge * low, m_a = 0.0;
  if (kind == 1) std::tie(k_a, m_a) = std::pair{0.0, edge / high};
  if (kind == 2) {  // opposite signs add up at the low end: low·m_a − k_a/low = −edge
    m_a = -0.5 * edge / high;
    k_a = low * (edge + low * m_a);
  }
  if (kind == 3) {  // and at the high one
    k_a = -0.5 * edge * low;
    m_a = (edge + k_a / high) / high;
  }
  const auto antisymmetric = [](const Matrix& Z, double part) {
    Matrix turned = impedance::symmetric_part(Z);
    turned(0, 1) += part;
    turned(1, 0) -= part;
    return turned;
  };
  arm.K = antisymmetric(arm.K, k_a);
  arm.M = antisymmetric(arm.M, m_a);
  return arm;
}

constexpr std::array kKinds = {"stiffness", "inertia", "both, low end", "both, high end"};

constexpr int kKindCount = static_cast<int>(kKinds.size());

/// An arm with that much antisymmetry, and whether it was called passive.
struct Called {
  int kind;
  bool active;  ///< in truth
  bool passive;
};

Result<Called> called(const CoverageOptions& options, int run, int kind, bool active) {
  laboratory::PrescribedMotionOptions lab = laboratory_of(options, run);
  lab.limb = antisymmetric_arm(lab.limb, kind, active ? kBarelyActive : kWellPassive);
  measurement::Options how;
  how.band = judged_band();
  const auto measured = MBK_TRY(measured_of(lab, how));
  return Called{kind, active, measured.passivity->prediction.verdict == Verdict::passive};
}

/// Two kinds of active arms in each run, a passive one in every other.
Result<std::vector<Called>> called_in(const CoverageOptions& options, int run) {
  std::vector<Called> all;
  for (const auto& [kind, active] : {std::pair{run % kKindCount, true},
                                     {(run + kKindCount / 2) % kKindCount, true},
                                     {run / 2 % kKindCount, false}}) {
    if (!active && run % 2 == 1) continue;
    const auto one = MBK_TRY(called(options, run, kind, active));
    all.push_back(one);
  }
  return all;
}

/// How often arms of one kind were called passive; no row where there was none.
void add_called(const std::vector<std::vector<Called>>& runs, int kind, bool active, ValidationTable& table) {
  int passive = 0, trials = 0;
  for (const auto& run : runs) {
    for (const Called& one : run) {
      if (one.kind != kind || one.active != active) continue;
      ++trials;
      passive += one.passive ? 1 : 0;
    }
  }
  if (trials == 0) return;
  table.rows.push_back(share_row(
      fmt::format("{} arm called passive: {}", active ? "active" : "passive", kKinds[static_cast<std::size_t>(kind)]),
      passive, trials, active ? std::optional(kHardlyEver) : std::nullopt));
}

}  // namespace

Result<ValidationTable> coverage(const CoverageOptions& options) {
  if (options.runs < 1) return no_runs(options.runs);
  const auto ran =
      MBK_TRY(each_run(options, options.runs, [&](int run) -> Result<std::pair<Held, std::vector<Called>>> {
        auto one = MBK_TRY(held_by(options, run));
        auto arms = MBK_TRY(called_in(options, run));
        return std::pair(std::move(one), std::move(arms));
      }));
  std::vector<Held> held;
  std::vector<std::vector<Called>> called;
  for (const auto& [one, arms] : ran) {
    held.push_back(one);
    called.push_back(arms);
  }

  ValidationTable table{
      "coverage",
      fmt::format(
          "how often do the 95 % intervals contain the true values, with coloured force noise of {:g} N in one trial?",
          options.remnant_force),
      "%", options.runs, options.seed};
  for (std::size_t k = 0; k < held.front().size(); ++k) {
    int hits = 0;
    for (const Held& run : held) hits += run[k].second ? 1 : 0;
    table.rows.push_back(share_row(held.front()[k].first, hits, options.runs, kNominal));
  }
  for (int kind = 0; kind < kKindCount; ++kind) {
    for (const bool active : {true, false}) add_called(called, kind, active, table);
  }
  table.notes = {
      "An active arm is one whose antisymmetric stiffness or inertia makes the passivity index negative at 0.4 or at "
      "2.9 Hz, by so little that this is the hardest case; each run has two of the four kinds in turn. The "
      "passive arms have a quarter of that antisymmetry: how often they are recognised from one trial is informative."};
  return table;
}

}  // namespace mbk::validation
