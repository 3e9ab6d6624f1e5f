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
  double lower95 = 0;  ///< above it with 95 % confidence: positive, where this is
  double upper = 0;    ///< below it with 95 % confidence for all conditions at once: negative, where this is
  Verdict verdict = Verdict::undecided;
};

/// Which frequencies the verdict of a model is about.
struct PassivityBand {
  Hertz low, high;
  std::string rule;  ///< how it came about, in words
};

/// ½ λ_min(Z + Zᴴ)(jω) over the band, with pointwise 95 % intervals.
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

/// Is a model passive in a band? "Passive" is an intersection–union test: every condition is positive with 95 %
/// confidence by itself. "Active": one is negative with 95 % confidence for all at once (Bonferroni).
struct ModelPassivity {
  Method method = Method::least_squares;  ///< that found the model
  Verdict verdict = Verdict::undecided;
  Verdict symmetric_verdict = Verdict::undecided;  ///< of M_s, B_s, K_s alone
  double coherent_residual = 0;  ///< largest perturbation-coherent fraction of the residual; 0 where not known
  bool published_rule = false;   ///< theorem 3.2 as it was applied: estimates without intervals, symmetric parts only
  PassivityBand band;
  std::vector<PassivityCondition> conditions;
  PassivityIndexCurve curve;
  double smallest_index = 0;  ///< over the band [N·s/m]
  Interval smallest_index95;
  Hertz smallest_at;
  std::optional<double> nonpassive_below_hz;
  std::optional<ExcessOfPassivity> excess;
};

/// Passivity of a limb by model and by data, and what follows.
struct Passivity {
  Verdict verdict = Verdict::undecided;
  bool by_model = false;  ///< false: the energy decided
  std::string reason;     ///< in words
  double explained = 0;   ///< [%] of the held-out force, mean of the axes, by the M, B, K that explain most
  std::vector<ModelPassivity> models;  ///< one for each method; the one that describes the limb comes first
  std::optional<EnergyAccount> energy;
};

}  // namespace mbk
