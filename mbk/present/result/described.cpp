#include "mbk/present/result/described.h"

#include "mbk/base/core/units.h"

namespace mbk {

using document::Fields;
using document::Json;
using document::through;

void describe(Fields<Warning>& fields) {
  fields.type("Warning", "Why a result needs care.");
  fields.add("code", &Warning::code);
  fields.add("message", &Warning::message, "what was found");
  fields.add("try", &Warning::remedy, "what to do");
  const auto former = [](const Warning& warning) {
    return std::string(warning.was.empty() ? former_word_of(warning.code) : warning.was);
  };
  fields.add_unless_empty("was", former, "former code, for one version, if it changed");
}

void describe(Fields<SourceFile>& fields) {
  fields.type("Input", "A file that was read.");
  fields.add("file", &SourceFile::path, "path, as given");
  fields.add("sha256", &SourceFile::sha256, "SHA-256 of the file, in hexadecimal; empty if it was not a file");
  fields.add("format", &SourceFile::format, "such as \"CSV\" or \"MAT level 5\"; empty if unknown");
  fields.add_unless_empty("trial", &SourceFile::trial, "trial within the file; absent if the file contains one only");
}

void describe(Fields<Error>& fields) {
  fields.type("Failure");
  fields.add("file", &Error::where, "file and place in it");
  fields.add("message", &Error::message);
  fields.add("try", &Error::remedy);
}

void describe(Fields<Units>& fields) {
  fields.type("Units", "Units of inertia, damping, stiffness, position and force, for translation or rotation.");
  const auto unit = [&fields](const char* name, const char* Units::*of) {
    const Json both = {units_of(Motion::translation).*of, units_of(Motion::rotation).*of};
    fields.add_as(name, {{"enum", both}}, of);
  };
  unit("M", &Units::inertia);
  unit("B", &Units::damping);
  unit("K", &Units::stiffness);
  unit("x0", &Units::position);
  unit("force", &Units::force);
}

void describe(Fields<Preparation>& fields) {
  using How = const Preparation&;
  fields.type("Preparation", "How the signals were prepared, so that every number can be reproduced.");
  fields.add("protocol", &Preparation::protocol);
  fields.add("protocol_rule", &Preparation::protocol_rule, "why that protocol");
  fields.add("window_rule", &Preparation::window_rule, "how the analysed interval was chosen");
  fields.add_number("from_s", &Preparation::from_s,
                    "start of the analysed interval, from the first sample of the recording [s]");
  fields.add_number("to_s", &Preparation::to_s, "end of the analysed interval [s]");
  fields.group("savitzky_golay", [](Fields<Preparation>& part) {
    part.type("SavitzkyGolay");
    part.add("order", &Preparation::smoothing_order);
    part.add("window", &Preparation::smoothing_window, "samples");
  });
  fields.add_or_null("cutoff_hz", &Preparation::cutoff,
                     "cutoff frequency of the zero-phase low-pass filter [Hz]; null: none");
  fields.add("cutoff_rule", &Preparation::cutoff_rule, "how the cutoff was chosen");
  fields.add("every", &Preparation::every, "decimation: every Nth filtered sample is used");
  fields.add(
      "excited_band_hz", [](How how) { return std::pair(how.band_low.value, how.band_high.value); },
      "low and high [Hz]");
  fields.add("force_source", &Preparation::force_source);
  fields.add("acceleration", [](How how) {
    return how.acceleration_from_sensor ? AccelerationSource::sensor : AccelerationSource::derivative;
  });
  fields.add("cut_before_filter", &Preparation::cut_before_filter);
  fields.add_number("split_s", &Preparation::split_s, "end of the fitted and start of the held-out data [s]");
  fields.add_if([](How how) { return how.protocol == Protocol::underdamped; }, "perturbations",
                &Preparation::perturbations, "number of displacements cut out; protocol underdamped only");
  fields.add_if([](How how) { return how.mode == Mode::reference; }, "procedure", &Preparation::procedure,
                "reference mode only");
}

void describe(Fields<Fit>& fields) {
  fields.type("Fit", "Fit of the model to the force, for each axis.");
  fields.add("VAF", &Fit::vaf, "variance accounted for [%]");
  fields.add("RMSE", &Fit::rmse, "root-mean-square error [unit of force]");
  result::add_validated_on(fields, &Fit::held_out);
  fields.add("VAF_in_sample", &Fit::vaf_in_sample, "VAF on the data used for fitting [%]");
}

void describe(Fields<EllipseFinding>& fields) {
  using From = const EllipseFinding&;
  const auto ellipse = &EllipseFinding::ellipse;
  fields.type("Ellipse", "Ellipse of the symmetric part of a matrix.");
  fields.add("area", through(ellipse, &impedance::Ellipse::area), "π λ₁ λ₂");
  fields.add("shape", through(ellipse, &impedance::Ellipse::shape), "larger over smaller eigenvalue");
  fields.add(
      "orientation_deg", [](From one) { return kDegrees * one.ellipse.orientation; },
      "angle of the major axis, counter-clockwise from x [°]");
  fields.add(
      "eigenvalues",
      [](From one) {
        return std::array{one.ellipse.lambda_min, one.ellipse.lambda_max};
      },
      "smaller and larger");
  fields.add("symmetric_part", &EllipseFinding::symmetric);
  fields.group("interval95", [](Fields<EllipseFinding>& part) {
    part.add("area", &EllipseFinding::area95);
    part.add("shape", &EllipseFinding::shape95);
    part.add(
        "orientation_deg",
        [](From one) { return Interval(kDegrees * one.orientation95.first, kDegrees * one.orientation95.second); },
        "[°]; 180 wide: any angle, because the ellipse may be a circle");
    part.add(
        "eigenvalues",
        [](From one) {
          return std::array{one.lambda_min95, one.lambda_max95};
        },
        "smaller and larger");
  });
}

void describe(Fields<AntisymmetryFinding>& fields) {
  fields.type("Antisymmetry");
  fields.add("value", &AntisymmetryFinding::value, "half the difference of the off-diagonal elements");
  fields.add("value_interval95", &AntisymmetryFinding::value95);
  fields.add("zmean_percent", &AntisymmetryFinding::zmean_percent, "[%]");
  fields.add("interval95", &AntisymmetryFinding::zmean95, "of zmean_percent [%]");
}

void describe(Fields<PrincipalDirection>& fields) {
  using From = const PrincipalDirection&;
  fields.type("PrincipalDirection", "A principal value of the symmetric part of a matrix, and its axis.");
  fields.add("value", &PrincipalDirection::value, "eigenvalue, in the unit of the matrix");
  fields.add("value95", &PrincipalDirection::value95);
  fields.add("direction", &PrincipalDirection::direction, "unit vector, base frame; its largest component is positive");
  fields.add(
      "half_angle95_deg", [](From one) { return kDegrees * one.half_angle95; },
      "half-angle of the cone that contains the true axis [°]; 90: any direction, because the value may equal another");
}

void describe(Fields<EllipsoidFinding>& fields) {
  fields.type("Ellipsoid", "Ellipsoid of the symmetric part of a 3×3 matrix.");
  fields.add("principal", &EllipsoidFinding::principal, "largest first");
  fields.add("volume", &EllipsoidFinding::volume, "4/3 π λ₁ λ₂ λ₃; null if the smallest is not positive");
  fields.add("shape", &EllipsoidFinding::shape, "largest over smallest; null if the smallest is not positive");
  fields.add("closed", &EllipsoidFinding::closed,
             "the smallest is positive beyond its interval; otherwise there is no ellipsoid to draw");
  fields.add("symmetric_part", &EllipsoidFinding::symmetric);
  fields.group("interval95", [](Fields<EllipsoidFinding>& part) {
    part.add("volume", &EllipsoidFinding::volume95);
    part.add("shape", &EllipsoidFinding::shape95);
  });
}

void describe(Fields<CirculationFinding>& fields) {
  fields.type("AntisymmetryVector", "The vector a of the antisymmetric part of a 3×3 matrix: (Z − Zᵀ)/2 · u = a × u.");
  fields.add("vector", &CirculationFinding::vector, "base frame, in the unit of the matrix");
  fields.add("vector95", &CirculationFinding::vector95, "of each component");
  fields.add("size", &CirculationFinding::size, "length of the vector");
  fields.add("size95", &CirculationFinding::size95, "from 0 if the vector may be zero");
  fields.add("significant", &CirculationFinding::significant, "the vector is not zero, with 95 % confidence");
  fields.add("percent", &CirculationFinding::percent, "size over the geometric mean of the principal values [%]");
}

void describe(Fields<ForceAgreement>& fields) {
  fields.type("ForceAgreement");
  fields.add("rows", &ForceAgreement::rows);
  fields.add("bias", &ForceAgreement::bias, "mean of computed minus measured force [N]");
  fields.add("RMSE", &ForceAgreement::rmse, "[N]");
}

void describe(Fields<ForceComparison>& fields) {
  fields.type("ForceComparison", "Comparison of a computed with the measured force, on the same rows.");
  fields.add("duration_s", &ForceComparison::duration, "[s]");
  fields.add("all", &ForceComparison::all);
  fields.add("rest", &ForceComparison::rest);
  fields.add("motion", &ForceComparison::motion);
  fields.add("reversals", &ForceComparison::reversals);
  fields.add("measured_rms", &ForceComparison::measured_rms, "rms about the mean [N]");
  fields.add("VAF", &ForceComparison::vaf, "[%]");
  fields.add("gain", &ForceComparison::gain, "slope of computed over measured");
  fields.add("correlation", &ForceComparison::correlation);
  fields.add("lag_s", &ForceComparison::lag, "delay of the computed force [s]");
  fields.add("correlation_at_lag", &ForceComparison::correlation_at_lag);
  fields.add("rest_speed", &ForceComparison::rest_speed, "[rad/s, or m/s for a sliding joint]");
  fields.add("reversal_window_s", &ForceComparison::reversal_window, "to each side of a reversal [s]");
  fields.add("longest_lag_s", &ForceComparison::longest_lag, "longest lag tried [s]");
}

void describe(Fields<ChartReference>& fields) {
  fields.type("Line", "A reference line across the chart.");
  fields.add("value", &ChartReference::value);
  fields.add("name", &ChartReference::name);
}

namespace impedance {

void describe(Fields<Model>& fields) {
  fields.type("Model",
              "M ẍ + B ẋ + K (x − x₀) = −F, with F the force of the limb on the machine; n×n with n axes. "
              "Units: `units` of the result.");
  fields.add("M", &Model::M, "inertia");
  fields.add("B", &Model::B, "damping");
  fields.add("K", &Model::K, "stiffness");
  fields.add("x0", &Model::x0, "equilibrium position");
}

}  // namespace impedance

namespace result {

void describe(Fields<TimedInput>& fields) {
  fields.type("TimedInput", "A recording behind a result.");
  fields.with(&TimedInput::source);
  fields.add("duration_s", &TimedInput::duration_s, "[s]");
  fields.add("rate_hz", &TimedInput::rate_hz, "sample rate [Hz]");
}

void describe(Fields<Covariance>& fields) {
  fields.type("Covariance");
  fields.add("parameters", &Covariance::parameters, "m_xx, m_xy, …; with one axis m, b, k, x0");
  fields.add("matrix", &Covariance::matrix, "of the parameters, in SI units");
}

}  // namespace result
}  // namespace mbk
