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

/// Structure of the parameters.
enum class Structure {
  full,         ///< M, B, K free (eq. 3.2–3.3)
  symmetric,    ///< M and K symmetric, B free
  mass_spring,  ///< M = m I, B = 0, K symmetric (eq. 3.8–3.9)
};

[[nodiscard]] constexpr auto word_table(Structure) {
  using enum Structure;
  return std::to_array<Word<Structure>>({{full, "full"}, {symmetric, "symmetric"}, {mass_spring, "mass-spring"}});
}

/// Estimation method.
enum class Method {
  least_squares,           ///< regression on the measured motion
  instrumental_variables,  ///< on the motion caused by the known perturbation
};

[[nodiscard]] constexpr auto word_table(Method) {
  using enum Method;
  return std::to_array<Word<Method>>({{least_squares, "ls"}, {instrumental_variables, "iv"}});
}

/// Its name in sentences.
[[nodiscard]] constexpr const char* method_name(Method method) {
  return method == Method::least_squares ? "least squares" : "instrumental variables";
}

/// Data used for the parameters; the fit is always judged on held-out data if there are any.
enum class ParametersFrom {
  identification,  ///< the identification segments
  all,             ///< every segment (Dyck 2013, §3.6.2: parameters from 16 pulses, VAF from 8 against 8)
};

[[nodiscard]] constexpr auto word_table(ParametersFrom) {
  using enum ParametersFrom;
  return std::to_array<Word<ParametersFrom>>({{identification, "identification"}, {all, "all"}});
}

/// Smallest first-stage F at which ±1.96 standard errors of instrumental variables are a 95 % interval (Lee, McCrary,
/// Moreira & Porter 2022, Am. Econ. Rev. 112: 104.7).
inline constexpr double kStrongInstruments = 104.7;

/// The largest known value, and at least 0.
[[nodiscard]] inline double largest_share(const Vector& shares) {
  double largest = 0.0;
  for (const double share : shares) largest = share > largest ? share : largest;  // a NaN is not
  return largest;
}

/// Strength and validity of instrumental variables.
struct InstrumentCheck {
  ReferenceQuantity from = ReferenceQuantity::unknown;  ///< interpretation of the reference
  Vector strength;           ///< 3n, first-stage F of ẍ, ẋ, x, each given the others; weak below kStrongInstruments
  Vector coherent_residual;  ///< n, perturbation-coherent fraction of the residual: the part that follows the
                             ///< perturbation linearly within half a second

  [[nodiscard]] double weakest() const { return strength.minCoeff<Eigen::PropagateNaN>(); }
  [[nodiscard]] bool strong() const { return weakest() > kStrongInstruments; }
};

/// Share of the force that follows the perturbation and is neither inertia nor damping nor stiffness: the response of
/// the limb. Part of that response resembles mechanics and is included in M, B and K with any method.
struct UnmodelledResponse {
  Vector coherent;  ///< n, share of the force's variance in the residual that is linear in the past of the reference
  Vector induced;   ///< n, share of the force's variance in the residual beyond that at rest; empty: never at rest

  [[nodiscard]] double largest() const { return std::max(largest_share(coherent), largest_share(induced)); }
};

/// Assumptions of M ẍ + B ẋ + K (x − x₀) = −F that one recording can contradict.
enum class Assumption {
  simultaneous,        ///< force and motion are simultaneous, without compliance or delay between them
  linear_stiffness,    ///< as stiff in large motion as in small
  no_dry_friction,     ///< no force that depends only on the direction of motion
  constant_stiffness,  ///< one stiffness for the whole recording
  constant_damping,    ///< one damping for the whole recording
  no_memory,           ///< no force that relaxes after a displacement
  alike_both_ways,     ///< equal stiffness and damping in opposite directions
  fits_at_lines,       ///< M, B and K explain the force at each frequency of a periodic perturbation
  constant_rest,       ///< one equilibrium, and a constant zero of the force sensor
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

/// Test of one assumption.
struct AssumptionTest {
  Assumption assumption;
  double p_value = 1;  ///< p-value under the assumption
  /// Estimated size of the deviation: delay of the force [s]; increase of stiffness with the amplitude of motion, as a
  /// share; dry friction [N or N·m]; standard deviation of the stiffness or damping over time, as a share; force of
  /// memory, or of the even part, as a share of the stiffness force; residual at the lines beyond scatter, as a share
  /// of the force; drift of the force over the data used [N or N·m]; standard deviation of the tremor's force [N or
  /// N·m].
  double size = 0;
  double frequency_hz = 0;  ///< of a tremor
  double shift = 0;         ///< change of M, B or K if it is also modelled, in half-widths of their 95 % intervals
  bool contradicted = false;
};

/// Source of the subtracted handle mass.
enum class HandleMassSource { none, option, recording };

[[nodiscard]] constexpr auto word_table(HandleMassSource) {
  using enum HandleMassSource;
  return std::to_array<Word<HandleMassSource>>({{none, "none"}, {option, "option"}, {recording, "recording"}});
}

/// How well the model explains the force, axis by axis.
struct Fit {
  Vector vaf;            ///< [%], on held-out data if there are any (eq. 3.10)
  Vector rmse;           ///< [N], on the same data, including a constant error
  Vector vaf_in_sample;  ///< [%], on the data used for the parameters of this check
  bool held_out = true;  ///< false: no data were held out, and vaf is in-sample
};

/// Whether the perturbation was sufficient.
struct Excitation {
  int rank = 0;             ///< of the regressors
  double condition = 0;     ///< of the centred regressors, each scaled to unit length
  double motion_ratio = 1;  ///< smallest over largest standard deviation of position over directions; 1 axis: 1
  double motion = 0;        ///< largest standard deviation of position [m]
  double inertia_share =
      0;                ///< share of the force variance that only the inertial term can explain, smallest direction
  double duration = 0;  ///< [s] of data used for the parameters
};

/// §3.5.4 of Dyck 2013: the same fit on every nth row, at 100 Hz or half the rate of the rows, whichever is lower.
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

/// Difference between two methods on the same rows: the parameter whose difference exceeds the standard error of least
/// squares most clearly, in units of the standard error of the difference, which includes the common noise. A
/// significant difference that is small compared with the least-squares interval is ignored; in a stiff loop there is
/// always one.
struct Disagreement {
  std::string parameter;      ///< as in Identification::parameters
  double difference = 0;      ///< instrumental variables less least squares
  double standard_error = 0;  ///< of that difference
  double least_squares = 0;   ///< the parameter itself, by least squares
  /// The error of least squares exceeds its own standard error, with 99 % confidence jointly for all of M, B and K.
  bool significant = false;
};

/// Bootstrap of the fit over blocks of rows: the variation of the results in repeated experiments of the same kind.
struct Replicates {
  Matrix models;       ///< (3n²+n)×B, stacked as in impedance/model.h
  double block_s = 0;  ///< [s] of a block; a whole perturbation if that is shorter
  double blocks = 0;   ///< number of disjoint blocks in the data
  std::uint64_t seed = 1;
};

/// An impedance with its uncertainty, its fit, and whether it is usable. n is the number of axes, 1, 2 or 3.
struct Identification {
  /// M ẍ + B ẋ + K (x − x₀) = −F: M [kg], B [N·s/m], K [N/m], x₀ [m], or their rotational units (`units_of(motion)`).
  /// Every number is NaN if the regressors could not be distinguished; `usable` is then false.
  impedance::Model model;

  /// Covariance of `parameters`, in their order, 3n² + n square. Valid for coloured residuals (Newey & West), widened
  /// so that ±1.96 standard errors are a 95 % interval at this length of data.
  Matrix covariance;

  /// Names of the rows of `covariance`: m_xx m_xy m_yx m_yy b_… k_… x0 y0; with one axis m b k x0.
  std::vector<std::string> parameters;

  /// The model behind `fit`, from the identification data only. Equals `model` unless the parameters are from all data.
  impedance::Model judged;

  /// √ of the diagonal of `covariance`, in the shape of the model.
  impedance::Model standard_error;

  /// The part of it that comes from the coefficients of the robot. Absent unless the force rests on a model of the
  /// robot.
  std::optional<impedance::Model> standard_error_of_robot;

  /// Estimation method, with the reason in words; the reason is empty if the method was requested.
  Method method = Method::least_squares;
  std::string method_rule;

  /// Strength and validity of the instruments. Only with instrumental variables.
  std::optional<InstrumentCheck> instrument;

  /// Response to the perturbation other than inertia, damping and stiffness. Only if the reference is known.
  std::optional<UnmodelledResponse> response;

  /// One test for each assumption of the model that these data can contradict.
  std::vector<AssumptionTest> assumptions;

  /// Models of the bootstrap. Absent unless requested.
  std::optional<Replicates> replicates;

  Structure structure = Structure::full;

  /// Length of the residual autocovariance used in the standard errors [s].
  double hac_lag_s = 0;

  /// What was subtracted from the diagonal of M [kg], and where it comes from.
  double handle_mass = 0;
  HandleMassSource handle_mass_from = HandleMassSource::none;

  /// Data used for the parameters. Absent: not stated in a stored result.
  std::optional<ParametersFrom> parameters_from;

  /// How well the model explains the force, on held-out data if there are any.
  Fit fit;

  /// Whether the perturbation moved the limb enough, and in enough directions.
  Excitation excitation;

  /// The same fit on fewer rows. Absent unless requested.
  std::optional<DecimationCheck> decimation;

  /// Number of rows used for the parameters.
  Index samples = 0;

  /// How each pooled trial was prepared and under which conditions it was recorded, in their order.
  std::vector<Preparation> preparations;
  std::vector<TrialConditions> conditions;

  /// The files, and the duration [s] and rate [Hz] of each.
  std::vector<SourceFile> sources;
  std::vector<double> durations, rates;

  int axes = 2;
  Motion motion = Motion::translation;

  /// Notes of the reader on the recordings.
  std::vector<std::string> notes;

  /// Reasons for caution. Scripts test `code`; `message` is for the user.
  std::vector<Warning> warnings;

  /// false: the numbers must not be used; `warnings` says why. A command then exits with 4.
  bool usable = true;
};

}  // namespace mbk
