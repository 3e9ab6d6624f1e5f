#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/units.h"
#include "mbk/model/trial/energy.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/verdict.h"

namespace mbk {

/// One condition of passivity, which must be positive, and its decision by the data.
struct PassivityCondition {
  std::string name;    ///< "smallest eigenvalue of B"
  std::string source;  ///< the corresponding published condition
  std::string unit;
  double value = 0, standard_error = 0;
  double lower = 0;  ///< lower bound with 97.5 % confidence: satisfied if positive
  double upper = 0;  ///< upper bound with 97.5 % joint confidence: violated if negative
  Verdict verdict = Verdict::undecided;
};

/// Frequency band of a prediction.
struct PassivityBand {
  Hertz low, high;
  std::string rule;           ///< how it was chosen, in words
  bool extrapolated = false;  ///< it extends beyond the frequencies at which the data show the response of the limb
};

/// ½ λ_min(Z + Zᴴ) at frequencies of the band, with pointwise 95 % intervals.
struct PassivityIndexCurve {
  Vector frequency;                ///< [Hz]
  Vector index, lower95, upper95;  ///< [N·s/m]
};

/// Excess of passivity of the symmetric part; negative: a shortage.
struct ExcessOfPassivity {
  double corrected = 0;  ///< λ_min(B_s)
  Interval corrected95;
  double published = 0;  ///< λ_max(B_s)/2, as in table 3.6 of Dyck (2013)
  Interval published95;
};

/// Combines both parts of a model: active if either is, passive if both are.
[[nodiscard]] constexpr Verdict verdict_of(Verdict symmetric, std::optional<Verdict> antisymmetric) {
  const Verdict other = antisymmetric.value_or(symmetric);
  if (symmetric == Verdict::active || other == Verdict::active) return Verdict::active;
  return symmetric == other ? symmetric : Verdict::undecided;
}

/// Prediction of the model of one method in a band. A part is passive if each of its conditions is positive with 97.5 %
/// confidence (an intersection–union test), active if one is negative with 97.5 % joint confidence for all conditions
/// of the model (Bonferroni).
struct ModelPassivity {
  Method method = Method::least_squares;  ///< that gave the model
  Vector vaf;                             ///< [%], of each axis, on held-out data if there are any
  bool usable = true;
  bool judged = true;  ///< false: without a reference it is unknown whether the model is that of the limb
  bool fits = true;    ///< it explains enough of the force to describe the limb (WarningCode::fit_poor)
  Verdict symmetric = Verdict::undecided;  ///< M_s, B_s, K_s: the parts that act in straight motion
  /// The antisymmetric parts, which do work only in circular motion; absent with one axis.
  std::optional<Verdict> antisymmetric;
  double coherent_residual = 0;  ///< largest perturbation-coherent fraction of the residual; 0 if unknown
  bool published_rule = false;   ///< theorem 3.2 as published: estimates without intervals, symmetric parts only
  PassivityBand band;
  std::vector<PassivityCondition> conditions;
  PassivityIndexCurve curve;
  double smallest_index = 0;  ///< over the band [N·s/m]
  Interval smallest_index95;  ///< the lowest of both bounds anywhere in the band
  Hertz smallest_at;
  /// In circular motion the model absorbs energy between these frequencies [Hz] and can generate energy outside;
  /// absent: at no frequency, or with one axis.
  std::optional<Interval> circular_hz;
  std::optional<ExcessOfPassivity> excess;

  [[nodiscard]] Verdict verdict() const { return verdict_of(symmetric, antisymmetric); }
};

/// Prediction of the model for other motions within a band. It is not a statement on the stability of any machine with
/// this person.
struct PassivityPrediction {
  std::optional<Verdict> verdict;  ///< of both parts; absent: no usable model, so no prediction
  std::optional<Verdict> symmetric,
      antisymmetric;  ///< as ModelPassivity, at most undecided if the model fits poorly
  bool extrapolated = false;
  std::string statement;  ///< in words
};

/// Energy balance of the trial, from force and motion only, without a model.
struct TrialPassivity {
  EnergyAccount energy;
  std::vector<EnergyLine> lines;  ///< of a periodic perturbation; empty if there are none
  std::string statement;          ///< in words
};

/// Energy balance of the trial and prediction of the model: two independent statements.
struct Passivity {
  std::optional<TrialPassivity> trial;  ///< absent if force and motion are implausible or missing
  PassivityPrediction prediction;
  std::optional<PassivityBand> band;   ///< band in which the data show the response of the limb; absent: none
  std::vector<ModelPassivity> models;  ///< one per method; the one used for the prediction first
};

}  // namespace mbk
