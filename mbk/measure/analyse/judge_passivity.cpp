#include "mbk/measure/analyse/judge_passivity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "mbk/base/dsp/cross_spectrum.h"
#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/analyse/decimation.h"
#include "mbk/model/impedance/passivity_index.h"

namespace mbk::analyse {
namespace {

constexpr double kCoherent = 0.8;                  ///< above it a line belongs to the coherent band
constexpr double kCoherentResidual = 0.2;          ///< share of the residual: above it the model is incomplete
constexpr double kAsPrinted = 0.01;                ///< a band, relative
constexpr double kOneSidedOfSeven = 2.6901095272;  ///< Φ⁻¹(1 − 0.025/7)
constexpr std::size_t kSymmetricConditions = 3;    ///< M_s, B_s, K_s; then come the antisymmetric ones
constexpr Index kCurvePoints = 200;
constexpr double kSegmentsOfCoherence = 4.0;  ///< of the coherence, end to end; seven with the overlap

/// With these warnings force or motion is not what its channel says, so the energy is meaningless.
constexpr std::array kImplausible = {WarningCode::force_sign_reversed,     WarningCode::torque_unit,
                                     WarningCode::implausible_scale,       WarningCode::axes_mismatched,
                                     WarningCode::axes_scaled_differently, WarningCode::same_column};
/// With these warnings the model explains too little of the force for a prediction.
constexpr std::array kPoorFit = {WarningCode::fit_poor,
                                 WarningCode::held_out_fit_poor,
                                 WarningCode::missing_dynamics,
                                 WarningCode::nonlinear_stiffness,
                                 WarningCode::dry_friction,
                                 WarningCode::stiffness_changes,
                                 WarningCode::inertia_not_symmetric,
                                 WarningCode::damping_changes,
                                 WarningCode::memory,
                                 WarningCode::even_nonlinearity,
                                 WarningCode::lack_of_fit};

template <std::size_t Size>
bool warns_of(const Identification& id, const std::array<WarningCode, Size>& codes) {
  return std::ranges::any_of(id.warnings, [&](const Warning& one) { return std::ranges::count(codes, one.code) > 0; });
}

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
  c.lower = c.value - numeric::kNormal95 * c.standard_error;
  c.upper = c.value + kOneSidedOfSeven * c.standard_error;
  c.verdict = c.lower > 0.0 ? Verdict::passive : (c.upper < 0.0 ? Verdict::active : Verdict::undecided);
  return c;
}

/// Passive where all are, active where any is.
Verdict common_verdict(std::span<const PassivityCondition> conditions) {
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

/// [Hz]
std::optional<Interval> circular_band(const impedance::Model& model) {
  const auto range = impedance::absorbing_in_circles(model);
  if (!range) return std::nullopt;
  return Interval{range->first / (2.0 * std::numbers::pi), range->second / (2.0 * std::numbers::pi)};
}

std::optional<ExcessOfPassivity> excess_of(const Identification& id) {
  const auto corrected = impedance::excess_of_passivity(id.model);
  if (!corrected) return std::nullopt;
  const auto published = impedance::published_excess_of_passivity(id.model);
  return ExcessOfPassivity{
      corrected->value, numeric::interval95(corrected->value, impedance::standard_error(*corrected, id.covariance)),
      published.value, numeric::interval95(published.value, impedance::standard_error(published, id.covariance))};
}

/// Smallest multiple coherence of all outputs, line by line; empty if there are too few data.
struct Coherence {
  Vector frequency, value;
};

/// Of position and force with the reference; of the force with the position, where no reference was recorded.
/// @param highest  lines beyond the one above it are omitted
Coherence smallest_coherence(const std::vector<PreparedTrial>& trials, Hertz highest) {
  const Index n = trials.front().axes;
  const bool known =
      std::ranges::all_of(trials, [](const PreparedTrial& one) { return one.reference_motion.size() > 0; });
  std::vector<Matrix> pieces;
  Index total = 0, longest = 0;
  double lowest = std::numeric_limits<double>::infinity();
  for (const PreparedTrial& trial : trials) {
    lowest = std::min(lowest, trial.preparation.band_low.value);
    for (const Rows& rows : rows_of(trial)) {
      Matrix piece(rows.size(), known ? 3 * n : 2 * n);
      piece.rightCols(2 * n) << trial.position.middleRows(rows.begin, rows.size()),
          trial.force_hand_on_robot.middleRows(rows.begin, rows.size());
      if (known) piece.leftCols(n) = trial.reference_motion.middleRows(rows.begin, rows.size()).rightCols(n);
      total += rows.size();
      longest = std::max(longest, rows.size());
      pieces.push_back(std::move(piece));
    }
  }
  const Hertz rate(1.0 / trials.front().sample_time);
  const double finest = kSegmentsOfCoherence * rate.value / static_cast<double>(std::max<Index>(total, 1));
  if (longest < 8) return {};
  const Index segment = dsp::segment_length(rate, Hertz(std::max(finest, lowest)), longest);
  const Hertz spacing(rate.value / static_cast<double>(segment));
  const auto spectra = dsp::cross_spectra(pieces, rate, segment, Hertz(highest.value + 2.0 * spacing.value));
  if (!spectra) return {};
  const Matrix coherence = dsp::multiple_coherence(*spectra, n);
  Coherence result{spectra->frequency, Vector(coherence.rows())};
  for (Index k = 0; k < coherence.rows(); ++k) {
    result.value[k] = coherence.row(k).allFinite() ? coherence.row(k).minCoeff() : 0.0;
  }
  return result;
}

std::string words(const PassivityBand& band) {
  return fmt::format("from {:.3g} to {:.3g} Hz", band.low.value, band.high.value);
}

/// "the model (least squares, VAF 97 and 98 %)"
std::string words(const ModelPassivity& model) {
  std::string text = fmt::format("the model ({}", method_name(model.method));
  for (Index axis = 0; axis < model.vaf.size(); ++axis) {
    const char* const between = axis == 0 ? ", VAF " : (axis + 1 == model.vaf.size() ? " and " : ", ");
    text += fmt::format("{}{:.0f}", between, model.vaf[axis]);
  }
  return text + (model.vaf.size() > 0 ? " %)" : ")");
}

/// The conditions with that verdict, with 95 % intervals.
std::string conditions_with(const ModelPassivity& model, Verdict verdict) {
  std::string text;
  for (const PassivityCondition& c : model.conditions) {
    if (c.verdict != verdict) continue;
    text += fmt::format("{}{} is {:.3g} {}", text.empty() ? "" : "; ", c.name, c.value, c.unit);
    const auto [low, high] = numeric::interval95(c.value, c.standard_error);
    if (!std::isfinite(low)) continue;
    const bool stricter = verdict == Verdict::undecided && high < 0.0;
    text += fmt::format(" (95 %: {:.3g} to {:.3g}{})", low, high,
                        stricter ? fmt::format("; for all conditions at once up to {:.3g}", c.upper) : "");
  }
  return text;
}

/// "below 0.16 Hz", "above 2.1 Hz", both or "at any frequency": the ends that lie within the band.
std::string where_circles_generate(const ModelPassivity& model) {
  if (!model.circular_hz) return "at any frequency";
  const auto [low, high] = *model.circular_hz;
  std::string text = low > model.band.low.value ? fmt::format("below {:.2g} Hz", low) : "";
  if (high < model.band.high.value) text += fmt::format("{}above {:.2g} Hz", text.empty() ? "" : " and ", high);
  return text.empty() ? "at any frequency" : text;
}

/// "1.75 Hz (95 %: -0.116 to -0.025 J)": the lines within the band at which the limb surely delivered energy.
std::string delivering_lines(const std::vector<EnergyLine>& lines, const PassivityBand& band) {
  std::string text;
  for (const EnergyLine& line : lines) {
    const double f = line.frequency.value;
    if (!(line.absorbed95.second < 0.0) || f < (1.0 - kAsPrinted) * band.low.value ||
        f > (1.0 + kAsPrinted) * band.high.value) {
      continue;
    }
    text += fmt::format("{}{:.3g} Hz (95 %: {:.3g} to {:.3g} J)", text.empty() ? "" : ", ", f, line.absorbed95.first,
                        line.absorbed95.second);
  }
  return text;
}

std::string in_straight_motion(Verdict verdict) {
  switch (verdict) {
    case Verdict::passive:
      return "absorbs energy in straight motion";
    case Verdict::active:
      return "can generate energy in straight motion";
    case Verdict::undecided:
      break;
  }
  return "is too uncertain in straight motion";
}

/// The prediction of a model in its band.
std::string predicted(const ModelPassivity& model, const PassivityPrediction& prediction) {
  const std::string band = words(model.band), subject = words(model);
  switch (*prediction.verdict) {
    case Verdict::passive:
      return fmt::format("{} {} absorbs energy{}", band, subject,
                         model.antisymmetric ? " in straight and in circular motion" : "");
    case Verdict::active:
      if (prediction.antisymmetric != Verdict::active) {
        return fmt::format("{} {} can generate energy: {}", band, subject, conditions_with(model, Verdict::active));
      }
      return fmt::format("{} {} can generate energy in circular motion {}; it {}", band, subject,
                         where_circles_generate(model), in_straight_motion(model.symmetric));
    case Verdict::undecided:
      break;
  }
  if (model.antisymmetric == Verdict::active) {
    return fmt::format(
        "{} {} {}; its antisymmetric part would generate energy in circular motion, but {:.0f} % of the residual is "
        "coherent with the perturbation: the model includes part of a voluntary or reflex response, and its intervals "
        "account for noise only",
        band, subject, in_straight_motion(model.symmetric), 100.0 * model.coherent_residual);
  }
  const std::string uncertain = conditions_with(model, Verdict::undecided);
  if (model.symmetric == Verdict::passive && uncertain.empty()) {
    return fmt::format(
        "{} {} absorbs energy in straight motion; circular motion is not tested, because the structure imposes "
        "symmetric M and K",
        band, subject);
  }
  return fmt::format("{} {} {}: {}", band, subject,
                     model.symmetric == Verdict::passive
                         ? "absorbs energy in straight motion; in circular motion it is too uncertain"
                         : "is too uncertain",
                     uncertain);
}

}  // namespace

PassivityBand excited_band(const std::vector<PreparedTrial>& trials) {
  PassivityBand band{
      trials.front().preparation.band_low, trials.front().preparation.band_high,
      "the excited band, in which the coherence of position and force with the perturbation nowhere exceeds 0.8", true};
  for (const PreparedTrial& trial : trials) {
    band.low = Hertz(std::max(band.low.value, trial.preparation.band_low.value));
    band.high = Hertz(std::min(band.high.value, trial.preparation.band_high.value));
  }
  // Frequencies with less than one period in the longest segment are not observable.
  double longest = 0.0;
  for (const PreparedTrial& trial : trials) {
    for (const Rows& rows : rows_of(trial)) {
      longest = std::max(longest, static_cast<double>(rows.size()) * trial.sample_time);
    }
  }
  if (longest > 0.0) band.low = Hertz(std::clamp(1.0 / longest, band.low.value, band.high.value));
  return band;
}

std::optional<PassivityBand> coherent_band(const std::vector<PreparedTrial>& trials) {
  const PassivityBand excited = excited_band(trials);
  const Coherence coherence = smallest_coherence(trials, excited.high);
  if (coherence.frequency.size() < 2) return std::nullopt;
  const double spacing = coherence.frequency[1];
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (Index k = 1; k < coherence.frequency.size(); ++k) {
    const double f = coherence.frequency[k];
    if (f < excited.low.value - spacing / 2.0 || f > excited.high.value + spacing / 2.0) continue;
    if (!(coherence.value[k] > kCoherent)) continue;
    low = std::min(low, f);
    high = std::max(high, f);
  }
  if (!(low < high)) return std::nullopt;
  const bool known = trials.front().reference_motion.size() > 0;
  return PassivityBand{Hertz(std::max(low, excited.low.value)), Hertz(std::min(high, excited.high.value)),
                       known ? "the part of the excited band in which the coherence of position and force with the "
                               "perturbation exceeds 0.8"
                             : "the part of the excited band in which the coherence of force with motion exceeds 0.8; "
                               "no reference was recorded",
                       false};
}

PassivityBand asked_band(Hertz low, Hertz high, const std::optional<PassivityBand>& coherent) {
  const bool within = coherent && low.value >= (1.0 - kAsPrinted) * coherent->low.value &&
                      high.value <= (1.0 + kAsPrinted) * coherent->high.value;
  return {low, high, "as asked", !within};
}

Result<ModelPassivity> model_passivity(const Identification& id, const PassivityBand& band) {
  if (id.model.M.size() == 0 || !id.model.M.allFinite() || !id.model.B.allFinite() || !id.model.K.allFinite()) {
    return bad_data("there is no model to judge for passivity", "see the warnings of mbk measure");
  }
  if (!(band.low.value > 0.0 && band.high.value >= band.low.value && std::isfinite(band.high.value))) {
    return bad_usage(
        fmt::format("the band from {:g} to {:g} Hz is empty or not above 0", band.low.value, band.high.value),
        "choose 0 < LOW <= HIGH with --band LOW:HIGH");
  }
  const Units units = units_of(id.motion);
  ModelPassivity result;
  result.method = id.method;
  result.vaf = id.fit.vaf;
  result.usable = id.usable;
  result.judged = !warns_of(id, std::array{WarningCode::no_reference});
  result.fits = !warns_of(id, kPoorFit);
  result.band = band;
  const auto add = [&](std::string name, std::string source, const char* unit, const impedance::Sensitive& quantity) {
    result.conditions.push_back(condition(std::move(name), std::move(source), unit, quantity, id.covariance));
  };
  const char* const smallest = id.axes == 1 ? "" : "smallest eigenvalue of ";
  add(fmt::format("{}M", smallest), "(3.22), (3.23)", units.inertia, impedance::smallest_eigenvalue(id.model, 0));
  add(fmt::format("{}B", smallest), "(3.24), (3.25)", units.damping, impedance::smallest_eigenvalue(id.model, 1));
  add(fmt::format("{}K", smallest), "(3.19), (3.20)", units.stiffness, impedance::smallest_eigenvalue(id.model, 2));
  result.symmetric = common_verdict(std::span(result.conditions));
  if (id.instrument) result.coherent_residual = largest_share(id.instrument->coherent_residual);
  result.published_rule =
      std::ranges::all_of(result.conditions, [](const PassivityCondition& c) { return c.value >= 0.0; });
  if (id.axes == 3) {
    for (const Hertz end : {band.low, band.high}) {
      add(fmt::format("√(det B/uᵀB u) − |ω m_a − k_a/ω| at {:.3g} Hz", end.value), "theory, passivity in three axes",
          units.damping, impedance::antisymmetry_margin(id.model, omega_of(end), 1));
    }
  } else if (id.axes == 2) {
    for (const Hertz end : {band.low, band.high}) {
      for (const int sign : {1, -1}) {
        add(fmt::format("√det B {} (ω m_a − k_a/ω) at {:.3g} Hz", sign > 0 ? "−" : "+", end.value), "(3.18), (3.21)",
            units.damping, impedance::antisymmetry_margin(id.model, omega_of(end), sign));
      }
    }
  }
  if (id.axes > 1) {
    result.antisymmetric = common_verdict(std::span(result.conditions).subspan(kSymmetricConditions));
    // Circular motion is not tested if symmetry was imposed.
    if (id.structure == Structure::symmetric && result.antisymmetric == Verdict::passive) {
      result.antisymmetric = Verdict::undecided;
    }
    result.circular_hz = circular_band(id.model);
  }
  result.curve = curve_of(id, band);
  const bool at_low = result.curve.index[0] <= result.curve.index[kCurvePoints - 1];
  const Index at = at_low ? 0 : kCurvePoints - 1;
  result.smallest_at = at_low ? band.low : band.high;
  result.smallest_index = result.curve.index[at];
  result.smallest_index95 = {result.curve.lower95.minCoeff<Eigen::PropagateNaN>(),
                             result.curve.upper95.minCoeff<Eigen::PropagateNaN>()};
  result.excess = excess_of(id);
  return result;
}

Result<std::vector<ModelPassivity>> model_passivities(std::initializer_list<const Identification*> models,
                                                      const PassivityBand& band) {
  std::vector<ModelPassivity> passivities;
  for (const Identification* id : models) {
    if (id == nullptr || !id->model.M.allFinite() || id->structure == Structure::mass_spring) continue;
    auto model = MBK_TRY(model_passivity(*id, band));
    passivities.push_back(std::move(model));
  }
  return passivities;
}

bool prefer_instruments(const Identification& instrumental, const std::optional<Disagreement>& disagreement) {
  return instrumental.usable && instrumental.instrument && instrumental.instrument->strong() && disagreement &&
         disagreement->significant;
}

std::optional<TrialPassivity> trial_passivity(const Identification& result, EnergyAccount energy,
                                              std::vector<EnergyLine> lines) {
  if (warns_of(result, kImplausible) || !std::isfinite(energy.absorbed)) return std::nullopt;
  const bool delivered = energy.absorbed < 0.0;
  const double sign = delivered ? -1.0 : 1.0;
  std::string text =
      fmt::format("in {} the {} {} {:.3g} J",
                  result.sources.size() > 1 ? fmt::format("these {} trials", result.sources.size()) : "this trial",
                  result.axes == 1 ? "limb" : "hand", delivered ? "delivered" : "absorbed", sign * energy.absorbed);
  const bool bounded = std::isfinite(energy.absorbed95.first) && std::isfinite(energy.absorbed95.second);
  if (bounded) {
    const auto [low, high] = std::minmax({sign * energy.absorbed95.first, sign * energy.absorbed95.second});
    text += fmt::format(" (95 %: {:.3g} to {:.3g} J)", low, high);
  }
  std::string delivering;
  for (const EnergyLine& line : lines) {
    if (line.absorbed95.second < 0.0)
      delivering += fmt::format("{}{:.3g}", delivering.empty() ? "" : ", ", line.frequency.value);
  }
  if (!delivering.empty())
    text += fmt::format("; among the lines of the perturbation, it delivered energy at {} Hz", delivering);
  if (energy.verdict == Verdict::undecided) {
    text += bounded ? "; the interval includes zero" : "; without an interval, the sign of this energy is uncertain";
  }
  return TrialPassivity{std::move(energy), std::move(lines), std::move(text)};
}

PassivityPrediction predict_passivity(const std::vector<ModelPassivity>& models, bool usable,
                                      const std::optional<PassivityBand>& coherent,
                                      const std::vector<EnergyLine>& lines) {
  PassivityPrediction prediction;
  if (models.empty()) {
    prediction.statement = "there is no model";
    return prediction;
  }
  const ModelPassivity& model = models.front();
  prediction.extrapolated = model.band.extrapolated;
  if (!usable || !model.usable) {
    prediction.statement = "the model is not usable";
    return prediction;
  }
  if (!model.fits || !model.judged || !coherent) {
    prediction.verdict = prediction.symmetric = Verdict::undecided;
    if (model.antisymmetric) prediction.antisymmetric = Verdict::undecided;
    prediction.statement =
        !model.judged
            ? "no reference was recorded, so the model cannot be checked; rely on the measured energy of the trial"
        : model.fits ? "the coherence of all axes exceeds 0.8 at fewer than two frequencies"
                     : fmt::format("{} does not describe the limb well enough; see the warnings", words(model));
    return prediction;
  }
  prediction.symmetric = model.symmetric;
  prediction.antisymmetric = model.antisymmetric;
  if (model.antisymmetric == Verdict::active && model.coherent_residual > kCoherentResidual)
    prediction.antisymmetric = Verdict::undecided;
  prediction.verdict = verdict_of(model.symmetric, prediction.antisymmetric);
  prediction.statement = predicted(model, prediction);
  if (const std::string contrary = delivering_lines(lines, model.band);
      !contrary.empty() && prediction.symmetric != Verdict::active && prediction.verdict != Verdict::active) {
    for (auto* verdict : {&prediction.verdict, &prediction.symmetric, &prediction.antisymmetric}) {
      if (*verdict) *verdict = Verdict::undecided;
    }
    prediction.statement = fmt::format("{}, but the limb delivered energy at {}, so the prediction is undecided",
                                       prediction.statement, contrary);
  }
  if (prediction.extrapolated) {
    prediction.statement = fmt::format("extrapolated beyond the coherent band, {:.3g} to {:.3g} Hz: {}",
                                       coherent->low.value, coherent->high.value, prediction.statement);
  }
  return prediction;
}

}  // namespace mbk::analyse
