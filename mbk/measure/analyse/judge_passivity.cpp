#include "mbk/measure/analyse/judge_passivity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "mbk/base/dsp/cross_spectrum.h"
#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/analyse/decimation.h"
#include "mbk/model/impedance/passivity_index.h"

namespace mbk::analyse {
namespace {

constexpr double kCoherent = 0.8;          ///< above it the band holds
constexpr double kExplained = 50.0;        ///< [%] of the force: below it no model describes the limb
constexpr double kCoherentResidual = 0.2;  ///< share of the residual: above it the model is not all that there is
constexpr double kOneSided95 = 1.6448536269514722;
constexpr double kOneSidedOfSeven = 2.4499976606;  ///< Φ⁻¹(1 − 0.05/7)
constexpr Index kCurvePoints = 200;
constexpr double kSegmentsAcross = 4.0;  ///< of the coherence, end to end; seven with the overlap

double omega_of(Hertz frequency) {
  return 2.0 * std::numbers::pi * frequency.value;
}

PassivityCondition condition(std::string name, std::string source, std::string unit,
                             const impedance::Sensitive& quantity, const Matrix& covariance) {
  PassivityCondition c;
  c.name = std::move(name);
  c.source = std::move(source);
  c.unit = std::move(unit);
  c.value = quantity.value;
  c.standard_error = impedance::standard_error(quantity, covariance);
  c.lower95 = c.value - kOneSided95 * c.standard_error;
  c.upper = c.value + kOneSidedOfSeven * c.standard_error;
  c.verdict = c.lower95 > 0.0 ? Verdict::passive : (c.upper < 0.0 ? Verdict::active : Verdict::undecided);
  return c;
}

/// Passive where all are, active where any is.
template <class Range>
Verdict common_verdict(const Range& conditions) {
  bool all = true;
  for (const PassivityCondition& c : conditions) {
    if (c.verdict == Verdict::active) return Verdict::active;
    all = all && c.verdict == Verdict::passive;
  }
  return all ? Verdict::passive : Verdict::undecided;
}

PassivityIndexCurve curve_of(const Identification& id, const PassivityBand& band) {
  PassivityIndexCurve curve{Vector(kCurvePoints), Vector(kCurvePoints), Vector(kCurvePoints), Vector(kCurvePoints)};
  for (Index k = 0; k < kCurvePoints; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(kCurvePoints - 1);
    const Hertz frequency(band.low.value * std::pow(band.high.value / band.low.value, share));
    const impedance::Sensitive index = impedance::passivity_index(id.model, omega_of(frequency));
    const auto [low, high] = numeric::interval95(index.value, impedance::standard_error(index, id.covariance));
    curve.frequency[k] = frequency.value;
    curve.index[k] = index.value;
    curve.lower95[k] = low;
    curve.upper95[k] = high;
  }
  return curve;
}

std::optional<ExcessOfPassivity> excess_of(const Identification& id) {
  const auto corrected = impedance::excess_of_passivity(id.model);
  if (!corrected) return std::nullopt;
  const auto published = impedance::published_excess_of_passivity(id.model);
  return ExcessOfPassivity{
      corrected->value, numeric::interval95(corrected->value, impedance::standard_error(*corrected, id.covariance)),
      published.value, numeric::interval95(published.value, impedance::standard_error(published, id.covariance))};
}

/// Smallest multiple coherence of position and force with the reference, line by line; empty where it cannot be had.
struct Coherence {
  Vector frequency, value;
};

Coherence reference_coherence(const std::vector<PreparedTrial>& trials) {
  std::vector<Matrix> pieces;
  Index total = 0, longest = 0;
  double lowest = std::numeric_limits<double>::infinity();
  for (const PreparedTrial& trial : trials) {
    const Index n = trial.axes;
    if (trial.reference_motion.size() == 0) return {};
    lowest = std::min(lowest, trial.preparation.band_low.value);
    for (const Rows& rows : rows_of(trial)) {
      Matrix piece(rows.size(), 3 * n);
      piece << trial.reference_motion.middleRows(rows.begin, rows.size()).rightCols(n),
          trial.position.middleRows(rows.begin, rows.size()),
          trial.force_hand_on_robot.middleRows(rows.begin, rows.size());
      total += rows.size();
      longest = std::max(longest, rows.size());
      pieces.push_back(std::move(piece));
    }
  }
  const Hertz rate(1.0 / trials.front().sample_time);
  const double finest = kSegmentsAcross * rate.value / static_cast<double>(std::max<Index>(total, 1));
  if (longest < 8) return {};
  const Index segment = dsp::segment_length(rate, Hertz(std::max(finest, lowest)), longest);
  const auto spectra = dsp::cross_spectra(pieces, rate, segment);
  if (!spectra) return {};
  const Matrix coherence = dsp::multiple_coherence(*spectra, trials.front().axes);
  Coherence result{spectra->frequency, Vector(coherence.rows())};
  for (Index k = 0; k < coherence.rows(); ++k) {
    result.value[k] = coherence.row(k).allFinite() ? coherence.row(k).minCoeff() : 0.0;
  }
  return result;
}

}  // namespace

PassivityBand passivity_band(const std::vector<PreparedTrial>& trials) {
  PassivityBand band{trials.front().preparation.band_low, trials.front().preparation.band_high, {}};
  for (const PreparedTrial& trial : trials) {
    band.low = Hertz(std::max(band.low.value, trial.preparation.band_low.value));
    band.high = Hertz(std::min(band.high.value, trial.preparation.band_high.value));
  }
  // Below one period in the longest stretch nothing is seen.
  double longest = 0.0;
  for (const PreparedTrial& trial : trials) {
    for (const Rows& rows : rows_of(trial)) {
      longest = std::max(longest, static_cast<double>(rows.size()) * trial.sample_time);
    }
  }
  if (longest > 0.0) band.low = Hertz(std::clamp(1.0 / longest, band.low.value, band.high.value));
  band.rule = "the excited band";
  const Coherence coherence = reference_coherence(trials);
  if (coherence.frequency.size() < 2) return band;
  const double spacing = coherence.frequency[1];
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (Index k = 1; k < coherence.frequency.size(); ++k) {
    const double f = coherence.frequency[k];
    if (f < band.low.value - spacing / 2.0 || f > band.high.value + spacing / 2.0) continue;
    if (!(coherence.value[k] > kCoherent)) continue;
    low = std::min(low, f);
    high = std::max(high, f);
  }
  if (!(low < high)) {
    band.rule = "the excited band; nowhere in it does the perturbation explain 0.8 of position and force";
    return band;
  }
  band.low = Hertz(std::max(low, band.low.value));
  band.high = Hertz(std::min(high, band.high.value));
  band.rule = "the part of the excited band in which the perturbation explains 0.8 of position and force";
  return band;
}

Result<ModelPassivity> model_passivity(const Identification& id, const PassivityBand& band) {
  if (id.model.M.size() == 0 || !id.model.M.allFinite() || !id.model.B.allFinite() || !id.model.K.allFinite()) {
    return bad_data("there is no model whose passivity could be judged", "see the warnings of mbk measure");
  }
  if (!(band.low.value > 0.0 && band.high.value >= band.low.value && std::isfinite(band.high.value))) {
    return bad_usage(fmt::format("a band from {:g} to {:g} Hz is none", band.low.value, band.high.value),
                     "a verdict needs frequencies above 0: --band LOW:HIGH");
  }
  const Units units = units_of(id.motion);
  ModelPassivity result;
  result.method = id.method;
  result.band = band;
  const auto add = [&](std::string name, std::string source, const char* unit, const impedance::Sensitive& quantity) {
    result.conditions.push_back(condition(std::move(name), std::move(source), unit, quantity, id.covariance));
  };
  const char* const smallest = id.axes == 1 ? "" : "smallest eigenvalue of ";
  add(fmt::format("{}M", smallest), "(3.22), (3.23)", units.inertia, impedance::smallest_eigenvalue(id.model, 0));
  add(fmt::format("{}B", smallest), "(3.24), (3.25)", units.damping, impedance::smallest_eigenvalue(id.model, 1));
  add(fmt::format("{}K", smallest), "(3.19), (3.20)", units.stiffness, impedance::smallest_eigenvalue(id.model, 2));
  result.symmetric_verdict = common_verdict(result.conditions);
  if (id.instrument) {
    for (const double share : id.instrument->coherent_residual)
      result.coherent_residual = std::max(result.coherent_residual, share);
  }
  result.published_rule =
      std::ranges::all_of(result.conditions, [](const PassivityCondition& c) { return c.value >= 0.0; });
  if (id.axes == 2) {
    for (const Hertz end : {band.low, band.high}) {
      for (const int sign : {1, -1}) {
        add(fmt::format("√det B {} (ω m_a − k_a/ω) at {:.3g} Hz", sign > 0 ? "−" : "+", end.value), "(3.18), (3.21)",
            units.damping, impedance::antisymmetry_margin(id.model, omega_of(end), sign));
      }
    }
  }
  result.verdict = common_verdict(result.conditions);
  result.curve = curve_of(id, band);
  const bool at_low = result.curve.index[0] <= result.curve.index[kCurvePoints - 1];
  const Index at = at_low ? 0 : kCurvePoints - 1;
  result.smallest_at = at_low ? band.low : band.high;
  result.smallest_index = result.curve.index[at];
  result.smallest_index95 = {result.curve.lower95[at], result.curve.upper95[at]};
  result.nonpassive_below_hz = impedance::nonpassive_below(id.model);
  result.excess = excess_of(id);
  return result;
}

bool instruments_speak(const Identification& instrumental, const std::optional<Disagreement>& disagreement) {
  return instrumental.usable && instrumental.instrument && instrumental.instrument->strong() && disagreement &&
         disagreement->significant;
}

Passivity decide(std::vector<ModelPassivity> models, double explained, std::optional<EnergyAccount> energy) {
  Passivity result;
  result.models = std::move(models);
  result.explained = explained;
  result.energy = std::move(energy);
  const ModelPassivity* model = result.models.empty() ? nullptr : &result.models.front();
  const bool speaks = model != nullptr && explained >= kExplained;
  if (!speaks && result.energy) {
    result.verdict = result.energy->verdict;
    result.reason =
        model == nullptr
            ? "there is no model; what the limb absorbed decides"
            : fmt::format(
                  "no inertia, damping and stiffness explains more than {:.0f} % of the force, so that no model "
                  "describes the limb; what it absorbed decides",
                  std::max(0.0, explained));
    if (model != nullptr && model->verdict != result.verdict && model->verdict != Verdict::undecided) {
      result.reason += fmt::format(
          ". The model would say {}: it fits what answers the perturbation as if it were "
          "mechanics",
          word_of(model->verdict));
    }
    return result;
  }
  if (model == nullptr) {
    result.reason = "there is neither a model nor an account of the energy";
    return result;
  }
  result.by_model = true;
  result.verdict = speaks ? model->verdict : Verdict::undecided;
  if (result.verdict == Verdict::active && model->symmetric_verdict != Verdict::active &&
      model->coherent_residual > kCoherentResidual) {
    result.verdict = Verdict::undecided;
    result.reason = fmt::format(
        "the antisymmetric part would make it active, but {:.0f} % of what inertia, damping and stiffness leave of the "
        "force answers the perturbation too: a voluntary or reflex response is part of this model, and its intervals "
        "know noise only",
        100.0 * model->coherent_residual);
    return result;
  }
  if (!speaks) {
    result.reason =
        fmt::format("the model explains only {:.0f} % of the force, and there is no account of the energy", explained);
    return result;
  }
  for (const PassivityCondition& c : model->conditions) {
    if (c.verdict != model->verdict || model->verdict == Verdict::passive) continue;
    result.reason += (result.reason.empty() ? "" : "; ") +
                     fmt::format("{} is {:.3g} ± {:.2g} {}", c.name, c.value, kOneSided95 * c.standard_error, c.unit);
  }
  if (model->verdict == Verdict::passive) {
    result.reason = "every condition is positive with 95 % confidence";
  } else if (model->verdict == Verdict::active) {
    result.reason = "negative beyond chance: " + result.reason;
  } else {
    result.reason = "not known well enough: " + result.reason;
  }
  return result;
}

}  // namespace mbk::analyse
