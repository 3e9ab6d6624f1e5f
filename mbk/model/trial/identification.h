#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/warning.h"

namespace mbk {

/// What the parameters may be.
enum class Structure {
  full,         ///< M, B, K free (eq. 3.2–3.3)
  symmetric,    ///< M and K symmetric, B free
  mass_spring,  ///< M = m I, B = 0, K symmetric (eq. 3.8–3.9)
};

[[nodiscard]] constexpr auto word_table(Structure) {
  using enum Structure;
  return std::to_array<Word<Structure>>({{full, "full"}, {symmetric, "symmetric"}, {mass_spring, "mass-spring"}});
}

/// How the parameters are found.
enum class Method {
  least_squares,           ///< regression on the measured motion
  instrumental_variables,  ///< on what the known perturbation alone makes of it
};

[[nodiscard]] constexpr auto word_table(Method) {
  using enum Method;
  return std::to_array<Word<Method>>({{least_squares, "ls"}, {instrumental_variables, "iv"}});
}

/// As it stands in sentences.
[[nodiscard]] constexpr const char* method_name(Method method) {
  return method == Method::least_squares ? "least squares" : "instrumental variables";
}

/// Which data stand behind the parameters; the fit is always judged on held-out data where there are any.
enum class ParametersFrom {
  identification,  ///< the segments that are there to identify
  all,             ///< every segment (Dyck 2013, §3.6.2: parameters from 16 pulses, VAF from 8 against 8)
};

[[nodiscard]] constexpr auto word_table(ParametersFrom) {
  using enum ParametersFrom;
  return std::to_array<Word<ParametersFrom>>({{identification, "identification"}, {all, "all"}});
}

/// Smallest first-stage F at which ±1.96 standard errors of instrumental variables are a 95 % interval (Lee, McCrary,
/// Moreira & Porter 2022, Am. Econ. Rev. 112: 104.7).
inline constexpr double kStrongInstruments = 104.7;

/// The largest of those that are known, and at least 0.
[[nodiscard]] inline double largest_share(const Vector& shares) {
  double largest = 0.0;
  for (const double share : shares) largest = share > largest ? share : largest;  // a NaN is not
  return largest;
}

/// What stands behind instrumental variables, and whether it may.
struct InstrumentCheck {
  ReferenceQuantity from = ReferenceQuantity::unknown;  ///< what the reference was taken for
  Vector strength;           ///< 3n, first-stage F of ẍ, ẋ, x, each given the others; weak below kStrongInstruments
  Vector coherent_residual;  ///< n, perturbation-coherent fraction of the residual: what follows the perturbation
                             ///< linearly within half a second

  [[nodiscard]] double weakest() const { return strength.minCoeff<Eigen::PropagateNaN>(); }
  [[nodiscard]] bool strong() const { return weakest() > kStrongInstruments; }
};

/// How much of the force follows the perturbation and is neither inertia nor damping nor stiffness: what the limb does
/// in response. A part of that response looks like mechanics and stands in M, B and K, whatever the method.
struct UnmodelledResponse {
  Vector coherent;  ///< n, share of the force's variance in the residual that is linear in the past of the reference
  Vector induced;   ///< n, share of the force's variance in the residual beyond that at rest; empty: never at rest

  [[nodiscard]] double largest() const { return std::max(largest_share(coherent), largest_share(induced)); }
};

/// What M ẍ + B ẋ + K (x − x₀) = −F takes for granted, and one recording can contradict.
enum class Assumption {
  simultaneous,        ///< force and motion are of one instant, and nothing between them yields or responds late
  linear_stiffness,    ///< as stiff in large motion as in small
  no_dry_friction,     ///< no force that depends on the direction of motion alone
  constant_stiffness,  ///< one stiffness for the whole recording
  constant_damping,    ///< one damping for the whole recording
  no_memory,           ///< no force that relaxes after a displacement
  alike_both_ways,     ///< as stiff and as damped in one direction as in the opposite one
  fits_at_lines,       ///< M, B and K explain the force at each frequency of a periodic perturbation
  constant_rest,       ///< one equilibrium, and a force sensor whose zero stays
  no_tremor,           ///< no rhythm of the limb's own
};

[[nodiscard]] constexpr auto word_table(Assumption) {
  using enum Assumption;
  return std::to_array<Word<Assumption>>({{simultaneous, "simultaneous"},
                                          {linear_stiffness, "linear-stiffness"},
                                          {no_dry_friction, "no-dry-friction"},
                                          {constant_stiffness, "constant-stiffness"},
                                          {constant_damping, "constant-damping"},
                                          {no_memory, "no-memory"},
                                          {alike_both_ways, "alike-both-ways"},
                                          {fits_at_lines, "fits-at-lines"},
                                          {constant_rest, "constant-rest"},
                                          {no_tremor, "no-tremor"}});
}

/// What the data say of one assumption.
struct AssumptionTest {
  Assumption assumption;
  double p_value = 1;  ///< chance of such data where the assumption holds
  /// What contradicts it, as large as it was found: the force late by [s]; stiffness at the motion's amplitude more
  /// than at none, as a share; dry friction [N or N·m]; standard deviation of the stiffness or damping over time, as
  /// a share; force of the memory, or of what is even, as a share of that of the stiffness; residual at the lines that
  /// no scatter explains, as a share of the force;
  /// drift of the force over the data behind the parameters [N or N·m]; standard deviation of the tremor's force [N or
  /// N·m].
  double size = 0;
  double frequency_hz = 0;  ///< of a tremor
  double shift = 0;  ///< what M, B or K change by when it is modelled too, in half widths of their 95 % intervals
  bool contradicted = false;
};

/// Where the handle's mass that was subtracted comes from.
enum class HandleMassSource { none, option, recording };

[[nodiscard]] constexpr auto word_table(HandleMassSource) {
  using enum HandleMassSource;
  return std::to_array<Word<HandleMassSource>>({{none, "none"}, {option, "option"}, {recording, "recording"}});
}

/// How well the model explains the force, axis by axis.
struct Fit {
  Vector vaf;            ///< [%], on held-out data where there are any (eq. 3.10)
  Vector rmse;           ///< [N], on the same data; a constant error counts
  Vector vaf_in_sample;  ///< [%], on the data that made the parameters of this check
  bool held_out = true;  ///< false: no data were held out, and vaf is in-sample
};

/// Did the perturbation ask enough of the limb?
struct Excitation {
  int rank = 0;              ///< of the regressors
  double condition = 0;      ///< of the centred regressors, each scaled to unit length
  double motion_ratio = 1;   ///< smallest over largest standard deviation of position over directions; 1 axis: 1
  double motion = 0;         ///< largest standard deviation of position [m]
  double inertia_share = 0;  ///< of the force's variance: what only the inertial term can explain, smallest direction
  double duration = 0;       ///< [s] of data behind the parameters
};

/// §3.5.4 of Dyck 2013: the same fit on every n-th row, at 100 Hz or half the rate of the rows, whichever is less.
struct DecimationCheck {
  double rate_hz = 0;  ///< after decimation
  impedance::Model model;
  double largest_change = 0;  ///< of M, B, K, relative to the largest element of its matrix
};

/// Units of M, B, K, x₀, position and force.
struct Units {
  const char *inertia, *damping, *stiffness, *position, *force;
};

[[nodiscard]] constexpr Units units_of(Motion motion) {
  switch (motion) {
    case Motion::translation:
      return {"kg", "N·s/m", "N/m", "m", "N"};
    case Motion::rotation:
      return {"kg·m²", "N·m·s/rad", "N·m/rad", "rad", "N·m"};
    case Motion::unknown:
      break;
  }
  return {"kg or kg·m²", "N·s/m or N·m·s/rad", "N/m or N·m/rad", "m or rad", "N or N·m"};
}

/// The unit of a parameter of M, B or K by its name, as in Identification::parameters: "m_xy", "b", "k_yy".
[[nodiscard]] constexpr const char* unit_of_parameter(std::string_view name, Motion motion) {
  const Units units = units_of(motion);
  return name.starts_with('m') ? units.inertia : (name.starts_with('b') ? units.damping : units.stiffness);
}

/// Where two methods find different models in the same rows: the parameter whose difference exceeds the standard error
/// of least squares most clearly, in terms of the difference's own standard error, which counts that both methods saw
/// the same noise. A difference that is certain but small beside the interval of least squares changes nothing; in a
/// stiff loop there is always one.
struct Disagreement {
  std::string parameter;      ///< as in Identification::parameters
  double difference = 0;      ///< instrumental variables less least squares
  double standard_error = 0;  ///< of that difference
  double least_squares = 0;   ///< the parameter itself, by least squares
  /// Least squares is off by more than its own standard error says, with 99 % confidence for all of M, B and K
  /// together.
  bool significant = false;
};

/// The same fit on data drawn again and again from blocks of the rows: how the numbers would have come out in other
/// experiments of the same kind.
struct Replicates {
  Matrix models;       ///< (3n²+n)×B, stacked as in impedance/model.h
  double block_s = 0;  ///< [s] of a block; a whole perturbation where that is shorter
  double blocks = 0;   ///< that the data hold beside each other
  std::uint64_t seed = 1;
};

/// An impedance, how certain it is, how well it fits, and whether it may be used. n is the number of axes, 1 or 2.
struct Identification {
  /// M ẍ + B ẋ + K (x − x₀) = −F: M [kg], B [N·s/m], K [N/m], x₀ [m], or their rotational units (`units_of(motion)`).
  /// Every number is NaN if the regressors could not be distinguished; `usable` is then false.
  impedance::Model model;

  /// Of `parameters`, in their order, 3n² + n square. Holds for coloured residuals (Newey & West), widened so that
  /// ±1.96 standard errors are a 95 % interval at this length of data.
  Matrix covariance;

  /// Names of the rows of `covariance`: m_xx m_xy m_yx m_yy b_… k_… x0 y0; with one axis m b k x0.
  std::vector<std::string> parameters;

  /// The model behind `fit`, from the data that are there to identify and nothing else. Equals `model` unless the
  /// parameters were made from all data.
  impedance::Model judged;

  /// √ of the diagonal of `covariance`, in the shape of the model.
  impedance::Model standard_error;

  /// The part of it that comes from the coefficients of the robot. Absent unless the force rests on a model of the
  /// robot.
  std::optional<impedance::Model> standard_error_of_robot;

  /// How the model was found, and why that way in words; the rule is empty if the method was asked for.
  Method method = Method::least_squares;
  std::string method_rule;

  /// Strength and validity of the instruments. Only with instrumental variables.
  std::optional<InstrumentCheck> instrument;

  /// What follows the perturbation and is neither inertia nor damping nor stiffness. Only if the reference is known.
  std::optional<UnmodelledResponse> response;

  /// One test for each assumption of the model that these data can contradict.
  std::vector<AssumptionTest> assumptions;

  /// The bootstrap's models. Absent unless one was asked for.
  std::optional<Replicates> replicates;

  Structure structure = Structure::full;

  /// Reach of the residual's autocovariance in the standard errors [s].
  double hac_lag_s = 0;

  /// What was subtracted from the diagonal of M [kg], and where it comes from.
  double handle_mass = 0;
  HandleMassSource handle_mass_from = HandleMassSource::none;

  /// Which data made the parameters. Absent: a stored result does not say.
  std::optional<ParametersFrom> parameters_from;

  /// How well the model explains the force, on held-out data if there are any.
  Fit fit;

  /// Whether the perturbation moved the limb enough, and in enough directions.
  Excitation excitation;

  /// The same fit on fewer rows. Absent unless it was asked for.
  std::optional<DecimationCheck> decimation;

  /// Number of rows behind the parameters.
  Index samples = 0;

  /// How each pooled trial was prepared and under which conditions it was recorded, in their order.
  std::vector<Preparation> preparations;
  std::vector<TrialConditions> conditions;

  /// The files, and the duration [s] and rate [Hz] of each.
  std::vector<SourceFile> sources;
  std::vector<double> durations, rates;

  int axes = 2;
  Motion motion = Motion::translation;

  /// What the reader said of the recordings.
  std::vector<std::string> notes;

  /// Why the answer needs care. Scripts test `code`; `message` is for people.
  std::vector<Warning> warnings;

  /// false: the numbers must not be used; `warnings` says why. A command then exits with 4.
  bool usable = true;
};

}  // namespace mbk
