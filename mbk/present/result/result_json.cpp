#include <fmt/format.h>

#include "mbk/base/numeric/dense.h"
#include "mbk/present/result/json.h"
#include "mbk/present/result/result_document.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;
using document::List;
using document::through;

namespace {

using Ellipses = std::array<EllipseFinding, 3>;
using Antisymmetries = std::array<AntisymmetryFinding, 2>;
using Ellipsoids = std::array<EllipsoidFinding, 3>;
using Circulations = std::array<CirculationFinding, 2>;

/// What a force sensor gives, and what the computed force makes of it instead.
struct ByForceSensor {
  const Identification *computed, *sensed;
};

void describe(Fields<ByForceSensor>& fields) {
  const auto sensed = &ByForceSensor::sensed;
  fields.type("ByForceSensor", "Result with the force sensor if the model is from a computed force.");
  fields.add("model", through(sensed, &Identification::model));
  fields.add("standard_error", through(sensed, &Identification::standard_error));
  fields.add("fit", through(sensed, &Identification::fit));
  fields.add(
      "induced_error",
      [](const ByForceSensor& by) {
        const impedance::Model &a = by.computed->model, &b = by.sensed->model;
        return impedance::Model{a.M - b.M, a.B - b.B, a.K - b.K, a.x0 - b.x0};
      },
      "with the computed force minus with the sensor");
}

result::Covariance covariance(const Identification& id) {
  return {id.parameters, id.covariance};
}

}  // namespace

void describe(Fields<Ellipses>& fields) {
  fields.type("Ellipses");
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
    fields.add(kMatrixNames[k], [k](const Ellipses& all) { return all[k]; });
  }
}

void describe(Fields<Antisymmetries>& fields) {
  fields.type("Antisymmetries");
  fields.add("inertia", [](const Antisymmetries& all) { return all[0]; });
  fields.add("stiffness", [](const Antisymmetries& all) { return all[1]; });
}

void describe(Fields<Ellipsoids>& fields) {
  fields.type("Ellipsoids");
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
    fields.add(kMatrixNames[k], [k](const Ellipsoids& all) { return all[k]; });
  }
}

void describe(Fields<Circulations>& fields) {
  fields.type("AntisymmetryVectors");
  fields.add("inertia", [](const Circulations& all) { return all[0]; });
  fields.add("stiffness", [](const Circulations& all) { return all[1]; });
}

namespace {

/// Ellipses and antisymmetry with two axes, ellipsoids and antisymmetry vectors with three.
struct Shapes {
  const std::optional<Findings>* planar;
  const std::optional<SpatialFindings>* spatial;
};

Shapes shapes_of(const Measurement& measured) {
  return {&measured.findings, &measured.spatial};
}

void describe(Fields<Shapes>& fields) {
  using From = const Shapes&;
  fields.add(
      "ellipses", [](From shapes) { return *shapes.planar ? &(*shapes.planar)->ellipses : nullptr; }, "two axes only");
  fields.add(
      "antisymmetry", [](From shapes) { return *shapes.planar ? &(*shapes.planar)->antisymmetry : nullptr; },
      "two axes only");
  fields.add(
      "ellipsoids", [](From shapes) { return *shapes.spatial ? &(*shapes.spatial)->ellipsoids : nullptr; },
      "three axes only");
  fields.add(
      "antisymmetry_vectors", [](From shapes) { return *shapes.spatial ? &(*shapes.spatial)->antisymmetry : nullptr; },
      "three axes only");
}

}  // namespace

void describe(Fields<InstrumentCheck>& fields) {
  fields.type("Instrument", "Validity of instrumental variables.");
  fields.add("reference", &InstrumentCheck::from);
  fields.add("first_stage_F", &InstrumentCheck::strength,
             "first-stage F of acceleration, velocity and position, each along all axes");
  fields.add("weakest_F", &InstrumentCheck::weakest);
  fields.add("strong", &InstrumentCheck::strong, fmt::format("the weakest is above {}", kStrongInstruments));
  fields.add("coherent_residual_fraction", &InstrumentCheck::coherent_residual,
             "share of the residual that is coherent with the perturbation");
}

void describe(Fields<UnmodelledResponse>& fields) {
  fields.type("UnmodelledResponse",
              "Share of the force that follows the perturbation but is not inertia, damping or stiffness.");
  fields.add("coherent_share", &UnmodelledResponse::coherent,
             "of the force's variance: residual that is linear in the past of the reference");
  fields.add_if([](const UnmodelledResponse& response) { return response.induced.size() > 0; }, "induced_share",
                &UnmodelledResponse::induced, "of the force's variance: residual beyond that at rest between pulses");
}

void describe(Fields<AssumptionTest>& fields) {
  fields.type("AssumptionTest", "One assumption of M, B and K, tested on this recording.");
  fields.add("assumption", &AssumptionTest::assumption);
  fields.add("contradicted", &AssumptionTest::contradicted, "it is violated, with a relevant effect");
  fields.add("p_value", &AssumptionTest::p_value, "p-value if the assumption is true");
  fields.add("size", &AssumptionTest::size,
             "force late by [s]; stiffness at the amplitude of the motion more than at none, as a share; dry friction, "
             "drift of the force over the recording, standard deviation of the tremor [N or N·m]; standard deviation "
             "of the stiffness or damping over time, as a share; force of a memory, or of what is even, as a share of "
             "that of the stiffness; residual at the lines beyond its scatter, as a share of the force");
  fields.add("shift", &AssumptionTest::shift,
             "change of M, B or K when the effect is modelled, in half widths of their 95 % intervals");
  fields.add_if([](const AssumptionTest& test) { return test.frequency_hz > 0.0; }, "frequency_hz",
                &AssumptionTest::frequency_hz, "of a tremor");
}

/// A second method beside the first, without what both have in common.
void describe(Fields<Identification>& fields) {
  fields.type("Alternative");
  fields.add("method", &Identification::method);
  fields.add("model", &Identification::model);
  fields.add("standard_error", &Identification::standard_error);
  fields.add("fit", &Identification::fit);
  fields.add("covariance", covariance);
  fields.add("warnings", &Identification::warnings);
  fields.add("usable", &Identification::usable);
  fields.add("instrument", &Identification::instrument);
  fields.add("unmodelled_response", &Identification::response);
}

void describe(Fields<BootstrapFinding>& fields) {
  fields.type("BootstrapQuantity");
  fields.add("name", &BootstrapFinding::name);
  fields.add("unit", &BootstrapFinding::unit);
  fields.add("value", &BootstrapFinding::value);
  fields.add("interval95", &BootstrapFinding::interval95);
  fields.add("delta_interval95", &BootstrapFinding::delta95, "from the covariance");
}

void describe(Fields<BootstrapFindings>& fields) {
  fields.type("Bootstrap", "Estimation repeated on resampled blocks of the recording.");
  fields.add("replicates", &BootstrapFindings::replicates);
  fields.add_number("block_s", &BootstrapFindings::block_s, "[s]");
  fields.add("blocks", &BootstrapFindings::blocks, "number of blocks that the data contain");
  fields.add("seed", &BootstrapFindings::seed);
  fields.add("quantities", &BootstrapFindings::findings);
}

void describe(Fields<Semidefiniteness>& fields) {
  fields.type("Cone", "Whether a matrix had to be made positive semidefinite.");
  fields.add("free_smallest_eigenvalue", &Semidefiniteness::free_smallest, "of the free fit");
  fields.add("smallest_eigenvalue", &Semidefiniteness::smallest, "of the consistent one");
  fields.add("active", &Semidefiniteness::active);
}

void describe(Fields<ConsistentFit>& fields) {
  fields.type("ConsistentFit", "The best fit with matrices that are possible for a passive limb.");
  fields.add("model", &ConsistentFit::model);
  fields.add("inertia", &ConsistentFit::inertia);
  fields.add("damping", &ConsistentFit::damping);
  fields.add("stiffness", &ConsistentFit::stiffness);
  fields.add("fit", &ConsistentFit::fit);
  fields.add("residual_power_increase_percent", &ConsistentFit::increase_percent, "[%]");
  fields.add("force_change", &ConsistentFit::force_change,
             "rms of the change of force relative to rms of the residual");
  fields.group("largest_change", [](Fields<ConsistentFit>& part) {
    part.add("parameter", &ConsistentFit::largest_change);
    part.add("standard_errors", &ConsistentFit::largest_change_errors);
  });
  fields.add("duality_gap", &ConsistentFit::duality_gap);
}

void describe(Fields<Disagreement>& fields) {
  fields.type(
      "Disagreement",
      "The parameter whose difference between the methods most clearly exceeds the standard error of least squares.");
  fields.add("parameter", &Disagreement::parameter, "as in `covariance`");
  fields.add("least_squares", &Disagreement::least_squares, "value of the parameter");
  fields.add("iv_less_ls", &Disagreement::difference);
  fields.add("standard_error", &Disagreement::standard_error, "of that difference");
  fields.add("significant", &Disagreement::significant,
             "the difference exceeds the standard error of least squares with 99 % confidence");
}

void describe(Fields<Excitation>& fields) {
  fields.type("Excitation", "Excitation of the limb by the perturbation.");
  fields.add("rank", &Excitation::rank, "of the regressors");
  fields.add("condition", &Excitation::condition, "condition number of the centred regressors");
  fields.add("motion_ratio", &Excitation::motion_ratio,
             "smallest relative to largest standard deviation of position over directions");
  fields.add("motion", &Excitation::motion, "largest standard deviation of position [m or rad]");
  fields.add("inertia_share", &Excitation::inertia_share,
             "share of the variance of the force that only inertia can explain");
}

void describe(Fields<DecimationCheck>& fields) {
  fields.type("DecimateCheck", "The same fit at a lower sample rate.");
  fields.add_number("rate_hz", &DecimationCheck::rate_hz, "[Hz]");
  fields.add("model", &DecimationCheck::model);
  fields.add("largest_relative_change", &DecimationCheck::largest_change);
}

void describe(Fields<Measurement>& fields) {
  using From = const Measurement&;
  const auto of = [](auto member) { return through(&Measurement::identification, member); };
  /// A result that was read from a file contains no preparation.
  const auto prepared = [](auto member) {
    return [member](From measured) {
      const auto& all = measured.identification.preparations;
      return all.empty() ? std::nullopt : std::optional(all.front().*member);
    };
  };
  fields.type(
      "Result",
      "Output of `mbk measure --json` and `mbk identify --json` for one recording, or for several pooled ones.");
  fields.header(result::kResultSchema);
  fields.add("inputs", [](From measured) {
    const Identification& id = measured.identification;
    std::vector<result::TimedInput> inputs;
    for (std::size_t i = 0; i < id.sources.size(); ++i) inputs.push_back({id.sources[i], id.durations[i], id.rates[i]});
    return inputs;
  });
  fields.add_unless_empty("notes", of(&Identification::notes), "notes from reading the recordings");
  fields.add("mode", prepared(&Preparation::mode));
  fields.add("protocol", prepared(&Preparation::protocol));
  fields.add("method", of(&Identification::method));
  fields.add_unless_empty("method_rule", of(&Identification::method_rule),
                          "how the method was chosen if none was requested");
  fields.add_as("axes", {{"enum", {1, 2, 3}}}, of(&Identification::axes));
  fields.add("structure", of(&Identification::structure));
  fields.add(
      "units", [](From measured) { return result::known_units(measured.identification.motion); },
      "absent if the file does not state the kind of motion");
  fields.add("model", of(&Identification::model));
  fields.add("standard_error", of(&Identification::standard_error), "of each parameter");
  fields.add("standard_error_of_robot", of(&Identification::standard_error_of_robot),
             "the part of it due to the coefficients of the robot");
  fields.add("fit", of(&Identification::fit));
  fields.with(shapes_of);
  fields.add("joint_domain", &Measurement::joints);
  fields.add("instrument", of(&Identification::instrument));
  fields.add("unmodelled_response", of(&Identification::response));
  fields.add("assumptions", of(&Identification::assumptions), "tests of the assumptions of the model").always = false;
  const auto describe_sensitivity = [](Fields<Measurement>& part) {
    part.add(
        "x0_per_force", [](From measured) { return Matrix(numeric::inverse(measured.identification.model.K)); },
        "of x0, for each N of a constant error of −F: K⁻¹ [m/N]");
    part.add(
        "B_per_delay", [](From measured) { return Matrix(-measured.identification.model.K); },
        "of B, for each second of delay of the force: −K [N/m]");
  };
  fields.group("sensitivity", describe_sensitivity, "Effect on the model of errors that one recording cannot show.")
      .always = false;
  fields.add(
      "alternatives",
      [](From measured) {
        const auto& other = measured.alternative;
        return other ? std::span(&*other, 1) : std::span<const Identification>();
      },
      "the same with the other method");
  fields.add_or_null("disagreement", &Measurement::disagreement);
  fields.add("force_comparison", &Measurement::force_comparison);
  fields.add("by_force_sensor", [](From measured) -> std::optional<ByForceSensor> {
    if (!measured.by_sensor) return std::nullopt;
    return ByForceSensor{&measured.identification, &*measured.by_sensor};
  });
  fields.add("bootstrap", &Measurement::bootstrap);
  fields.add("consistent_fit", &Measurement::consistent);
  fields.add("passivity", &Measurement::passivity);
  fields.add("warnings", of(&Identification::warnings));
  fields.add("usable", of(&Identification::usable));
  fields.add("covariance", of(covariance));
  fields.group("estimation", [of](Fields<Measurement>& part) {
    part.type("Estimation");
    document::Json words = kWordList<ParametersFrom>;
    words.push_back("");
    part.add_as(
        "parameters_from", {{"enum", words}},
        [](From measured) {
          const auto& from = measured.identification.parameters_from;
          return from ? word_of(*from) : "";
        },
        "data used for the parameters; empty: not stated in the file from which the result was read");
    part.add("samples", of(&Identification::samples));
    part.add("duration_s", of(through(&Identification::excitation, &Excitation::duration)), "[s]");
    part.add("hac_lag_s", of(&Identification::hac_lag_s),
             "noise correlation time allowed for in the standard errors [s]");
    part.add("handle_mass_kg", of(&Identification::handle_mass), "subtracted from the diagonal of M [kg]");
    part.add("handle_mass_from", of(&Identification::handle_mass_from), "source of the handle mass");
  });
  fields.add("excitation", of(&Identification::excitation));
  fields.add("decimate_check", of(&Identification::decimation));
  fields.add("preparation", of(&Identification::preparations), "one for each recording");
}

void describe(Fields<OmittedTrial>& fields) {
  fields.type("OmittedTrial");
  fields.add("file", &OmittedTrial::file);
  fields.add("why", &OmittedTrial::why);
}

void describe(Fields<Summary>& fields) {
  fields.type("Summary", "Mean over the usable, different recordings, and its standard error between them.");
  fields.add("trials", &Summary::trials, "number of trials in the mean");
  fields.add("omitted", &Summary::omitted);
  fields.add("method", &Summary::method);
  fields.add("model", &Summary::mean);
  fields.add("between_trial_standard_error", &Summary::between_trial_standard_error);
  fields.add("half_width95", &Summary::half_width95, "of the 95 % interval of the mean, by Student's t");
}

namespace result {
namespace {

/// One of the ellipse documents.
struct EllipseDocument {
  const Measurement* of;
};

void describe(Fields<EllipseDocument>& fields) {
  fields.type("EllipseDocument", "Output of `mbk ellipse --json` for one result.");
  fields.header("mbk.ellipse/1");
  fields.add("inputs", [](const EllipseDocument& one) { return one.of->identification.sources; });
  fields.with([](const EllipseDocument& one) { return shapes_of(*one.of); });
}

void describe(Fields<List<EllipseDocument>>& fields) {
  describe_list(fields, "EllipseDocuments", "mbk.ellipses/1", "Output of `mbk ellipse --json` for several results.");
}

}  // namespace

void describe(Fields<Results>& fields) {
  const auto of = [](auto member) { return through(&Results::together, member); };
  fields.type("Results", "Output of `mbk measure --json` for several recordings.");
  fields.header(kResultsSchema);
  fields.add("results", &Results::results);
  fields.add("summary", of(&SeveralTrials::summary));
  fields.add("no_summary", of(&SeveralTrials::no_summary), "why there is no summary").only_if([](const Results& all) {
    return !all.together->summary;
  });
  fields.add_unless_empty("failed", of(&SeveralTrials::failed), "recordings that could not be measured");
}

std::string to_json(const Measurement& measured) {
  return document::document(measured);
}

std::string to_compact_json(const Measurement& measured) {
  return document::compact(document::written(measured));
}

std::string to_json(const std::vector<Measurement>& results, const SeveralTrials& together) {
  Results all{{}, &together};
  for (const Measurement& one : results) all.results.push_back(&one);
  return document::document(all);
}

std::string ellipses_json(std::span<const Measurement> measured) {
  std::vector<EllipseDocument> all;
  for (const Measurement& one : measured) all.push_back({&one});
  return document::one_or_list<EllipseDocument>(all);
}

void add_result_schemas(document::Schemas& schemas) {
  schemas["result"] = document::schema_of<Measurement>();
  schemas["results"] = document::schema_of<Results>();
  schemas["ellipse"] = document::schema_of<EllipseDocument>();
  schemas["ellipses"] = document::schema_of<List<EllipseDocument>>();
}

}  // namespace result
}  // namespace mbk
