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

/// One condition of passivity, and whether the data decide it: it must be positive.
struct PassivityCondition {
  std::string name;    ///< "smallest eigenvalue of B"
  std::string source;  ///< the published condition that it stands for
  std::string unit;
  double value = 0, standard_error = 0;
  double lower = 0;  ///< above it with 97.5 % confidence: positive, where this is
  double upper = 0;  ///< below it with 97.5 % confidence for all conditions at once: negative, where this is
  Verdict verdict = Verdict::undecided;
};

/// Frequencies that a prediction is about.
struct PassivityBand {
  Hertz low, high;
  std::string rule;           ///< how it came about, in words
  bool extrapolated = false;  ///< it reaches beyond the frequencies at which the data show how the limb answers
};

/// ½ λ_min(Z + Zᴴ) at frequencies of the band, with pointwise 95 % intervals.
struct PassivityIndexCurve {
  Vector frequency;                ///< [Hz]
  Vector index, lower95, upper95;  ///< [N·s/m]
};

/// Excess of passivity of the symmetric part; a shortage where it is negative.
struct ExcessOfPassivity {
  double corrected = 0;  ///< λ_min(B_s)
  Interval corrected95;
  double published = 0;  ///< λ_max(B_s)/2, as table 3.6 of Dyck (2013) has it
  Interval published95;
};

/// Of both parts of a model: active where either is, passive where both are.
[[nodiscard]] constexpr Verdict verdict_of(Verdict symmetric, std::optional<Verdict> antisymmetric) {
  const Verdict other = antisymmetric.value_or(symmetric);
  if (symmetric == Verdict::active || other == Verdict::active) return Verdict::active;
  return symmetric == other ? symmetric : Verdict::undecided;
}

/// What the model of one method says in a band. A part is passive where every condition of it is positive with 97.5 %
/// confidence by itself (an intersection–union test), active where one is negative with 97.5 % confidence for all
/// conditions of the model at once (Bonferroni).
struct ModelPassivity {
  Method method = Method::least_squares;  ///< that found the model
  Vector vaf;                             ///< [%], of each axis, on held-out data where there are any
  bool usable = true;
  bool judged = true;  ///< false: no reference shows whether the model is that of the limb
  bool fits = true;    ///< it explains enough of the force to describe the limb (WarningCode::fit_poor)
  Verdict symmetric = Verdict::undecided;  ///< M_s, B_s, K_s: all that straight motion can show
  /// The antisymmetric parts, which do work in circular motion only; absent with one axis, which has none.
  std::optional<Verdict> antisymmetric;
  double coherent_residual = 0;  ///< largest perturbation-coherent fraction of the residual; 0 where not known
  bool published_rule = false;   ///< theorem 3.2 as it was applied: estimates without intervals, symmetric parts only
  PassivityBand band;
  std::vector<PassivityCondition> conditions;
  PassivityIndexCurve curve;
  double smallest_index = 0;  ///< over the band [N·s/m]
  Interval smallest_index95;  ///< the lowest of both bounds anywhere in the band
  Hertz smallest_at;
  /// In circular motion the model absorbs energy between these frequencies [Hz] and can generate some beyond; absent:
  /// at no frequency, or with one axis.
  std::optional<Interval> circular_hz;
  std::optional<ExcessOfPassivity> excess;

  [[nodiscard]] Verdict verdict() const { return verdict_of(symmetric, antisymmetric); }
};

/// What the model predicts of motions that were not made, within a band. It is no statement on the stability of any
/// machine with this person.
struct PassivityPrediction {
  std::optional<Verdict> verdict;  ///< of both parts; absent: no usable model, and no prediction
  std::optional<Verdict> symmetric,
      antisymmetric;  ///< as ModelPassivity, at most undecided where the model fits poorly
  bool extrapolated = false;
  std::string statement;  ///< in words
};

/// What happened in the trial, by force and motion alone. No model has a share in it.
struct TrialPassivity {
  EnergyAccount energy;
  std::vector<EnergyLine> lines;  ///< of a periodic perturbation; empty where there are none
  std::string statement;          ///< in words
};

/// What happened in the trial, and what the model predicts: two statements, neither of which follows from the other.
struct Passivity {
  std::optional<TrialPassivity> trial;  ///< absent where force and motion are not plausible, or not there
  PassivityPrediction prediction;
  std::optional<PassivityBand> band;   ///< in which the data show how the limb answers; absent: nowhere
  std::vector<ModelPassivity> models;  ///< one for each method; the one that predicts comes first
};

}  // namespace mbk
