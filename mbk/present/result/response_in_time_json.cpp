#include "mbk/present/result/exploration_parts_json.h"

namespace mbk {

using document::Fields;
using document::through;

void describe(Fields<Margin>& fields) {
  fields.type("Margin");
  fields.add("value", &Margin::value);
  fields.add("interval95",
             [](const Margin& one) { return std::pair(one.value - one.half_width, one.value + one.half_width); });
}

void describe(Fields<ExplainedForce>& fields) {
  fields.type("ExplainedForce", "Explained part of the force of one axis.");
  fields.add("VAF", &ExplainedForce::vaf, "[%]");
  fields.add("VAF_interval95", [](const ExplainedForce& one) {
    return std::pair(one.vaf - one.vaf_half_width, one.vaf + one.vaf_half_width);
  });
  fields.add("RMSE", &ExplainedForce::rmse, "[unit of force]");
}

namespace {

struct FittedMatrix {
  Matrix value, half_width;
  bool identifiable;
};

void describe(Fields<FittedMatrix>& fields) {
  fields.type("FittedMatrix");
  fields.add("value", &FittedMatrix::value);
  fields.add("half_width95", &FittedMatrix::half_width, "of the 95 % intervals");
  fields.add("identifiable", &FittedMatrix::identifiable, "the intervals of the diagonal are narrower than its values");
}

/// A response and its lags.
struct PathResponse {
  const Vector& lag;
  const Matrix &response, &half_width;
};

void describe(Fields<PathResponse>& fields) {
  fields.type("PathResponse");
  fields.add("lag_s", [](const PathResponse& path) { return path.lag; });
  fields.add_columns("response", [](const PathResponse& path) { return path.response; });
  fields.add_columns(
      "half_width95", [](const PathResponse& path) { return path.half_width; },
      "of the 95 % interval of what is excited of it");
}

/// The paths of one axis.
struct Shares {
  const PathShares* of;
  bool reflex;
};

void describe(Fields<Shares>& fields) {
  const auto of = [](auto member) { return through(&Shares::of, member); };
  fields.type("PathShares");
  fields.add("intrinsic_alone", of(&PathShares::intrinsic_alone));
  fields.add_if(&Shares::reflex, "both", of(&PathShares::both));
  fields.add_if(&Shares::reflex, "intrinsic_path", of(&PathShares::intrinsic_path));
  fields.add_if(&Shares::reflex, "reflex_path", of(&PathShares::reflex_path));
}

}  // namespace

void describe(Fields<ResponseModel>& fields) {
  using From = const ResponseModel&;
  const auto there = &ResponseModel::identifiable;
  fields.type("ResponseModel",
              "M, B and K fitted to an impulse response, weighted by its covariance. If the motion does not excite "
              "them enough, `identifiable` is false and nothing else is present.");
  fields.add("identifiable", there);
  fields.add_if(there, "M", [](From found) { return FittedMatrix{found.M, found.M_half_width, found.M_identifiable}; });
  fields.add_if(there, "B", [](From found) { return FittedMatrix{found.B, found.B_half_width, found.B_identifiable}; });
  fields.add_if(there, "K", [](From found) { return FittedMatrix{found.K, found.K_half_width, found.K_identifiable}; });
  const auto enough = [](Fields<ResponseModel>& part) {
    part.add("enough", &ResponseModel::enough, "p is not below 1e-5");
    part.add("F", &ResponseModel::statistic, "maximum over the axes");
    part.add("degrees_of_freedom", [](From found) { return std::vector{found.numerator, found.denominator}; });
    part.add("p", &ResponseModel::p_value);
  };
  fields.group("enough", enough, "Whether M, B and K are sufficient to describe the response.").only_if(there);
}

void describe(Fields<ImpulseResponseEstimate>& fields) {
  using Found = ImpulseResponseEstimate;
  fields.type("ImpulseResponseEstimate",
              "Two-sided impulse response from motion to force, −F(t) = Σ h(l) x(t − l) T + c. Of two axes the columns "
              "of `response` are xx, yx, xy, yy: force, then motion.");
  fields.add("sample_time_s", &Found::sample_time, "T, after decimation");
  fields.add("memory_s", &Found::memory, "longest lag in both directions");
  fields.add("memory_rule", &Found::memory_rule);
  fields.add("memory_at_limit", &Found::memory_at_limit, "it is the longest that was tried");
  fields.add("rank", &Found::rank, "directions of the lagged motion that were kept");
  fields.add("directions", &Found::directions, "all directions");
  fields.add("instruments", &Found::instruments, "instrumental variables from the reference");
  result::add_validated_on(fields, &Found::held_out);
  fields.with([](const Found& found) { return PathResponse{found.lag, found.response, found.half_width}; });
  fields.add_columns("excited", &Found::excited,
                     "share of a unit response at that lag of that input that the motion excites");
  fields.add("explained", &Found::explained);
  fields.add("explained_by_model", &Found::explained_by_model, "by M, B and K fitted directly to the same rows");
  fields.add("model", &Found::model);
}

void describe(Fields<StretchCandidate>& fields) {
  fields.type("StretchCandidate");
  fields.add_or_null(
      "direction",
      [](const StretchCandidate& one) {
        return one.direction.size() > 0 ? std::optional(one.direction) : std::nullopt;
      },
      "direction of stretch; null: both directions");
  fields.add("VAF", &StretchCandidate::vaf, "cross-validated [%]");
  fields.add("standard_error_of_difference", &StretchCandidate::vaf_error);
}

void describe(Fields<SecondOrderReflex>& fields) {
  fields.type("SecondOrderReflex", "G ω²/(s² + 2ζωs + ω²) e^{−s d}, fitted to the response of the reflex.");
  fields.add("gain", &SecondOrderReflex::gain);
  fields.add("delay_s", &SecondOrderReflex::delay);
  fields.add("frequency_hz", &SecondOrderReflex::frequency);
  fields.add("damping", &SecondOrderReflex::damping);
  fields.add("p", &SecondOrderReflex::p_value, "p-value if this model is sufficient");
}

void describe(Fields<EmgMuscle>& fields) {
  fields.type("EmgMuscle");
  fields.add("channel", &EmgMuscle::channel);
  fields.add("unit", &EmgMuscle::unit, "of its EMG: MVC, or mean of the recordings");
  fields.add("gain", &EmgMuscle::gain,
             "force F of the limb at a steady EMG of 1, for each axis [N or N.m]; empty where EMG does not explain");
}

void describe(Fields<EmgShares>& fields) {
  fields.type("EmgShares");
  fields.add("intrinsic_and_emg", &EmgShares::intrinsic_and_emg, "fitted together, without the reflex path");
  fields.add("all", &EmgShares::all, "intrinsic, reflex if one was found, and EMG");
  fields.add("emg_path", &EmgShares::emg_path, "of `all`, alone");
}

void describe(Fields<CoherenceBand>& fields) {
  fields.type("CoherenceBand",
              "Multiple coherence in a band: the share of the power of -F that linear responses explain, corrected for "
              "what unrelated signals explain.");
  fields.add("band_hz", [](const CoherenceBand& band) { return std::pair(band.from_hz, band.to_hz); });
  fields.add("motion", &CoherenceBand::motion, "for each axis");
  fields.add("motion_and_emg", &CoherenceBand::motion_and_emg, "for each axis");
}

void describe(Fields<EmgPath>& fields) {
  fields.type("EmgPath", "The rectified EMG of muscles as a third path of the force, present with --muscles.");
  fields.add("explains", &EmgPath::explains, "the force is predicted better with EMG");
  fields.add("why", &EmgPath::why);
  fields.add("p", &EmgPath::p_value, "p-value of EMG that adds nothing to the other paths");
  fields.add("memory_s", &EmgPath::memory, "last lag");
  fields.add("muscles", &EmgPath::muscles);
  fields.add("shares", &EmgPath::shares, "for each axis");
  fields.add("coherence", &EmgPath::coherence);
}

void describe(Fields<ParallelCascadeEstimate>& fields) {
  using Found = ParallelCascadeEstimate;
  using From = const Found&;
  const auto decided = [](From found) { return found.found != DelayedResponse::not_identifiable; };
  const auto has_reflex = [](From found) { return found.found == DelayedResponse::reflex; };
  fields.type("ParallelCascadeEstimate",
              "Force as the sum of an intrinsic path, linear in motion, and a reflex path. `reflex` and "
              "`intrinsic_model` are present if a reflex was found.");
  fields.add("delayed_response", &Found::found);
  fields.add("why", &Found::why);
  fields.add("sample_time_s", &Found::sample_time);
  fields.add("instruments", &Found::instruments);
  fields.add_if(decided, "p_both_directions_alike", &Found::p_value);
  fields.add_if(decided, "intrinsic_VAF", &Found::intrinsic_vaf, "cross-validated, without a delayed response [%]");
  fields.add_if(decided, "candidates", &Found::candidates, "in descending order of VAF");
  fields.add_if(decided, "intrinsic", [](From found) {
    return PathResponse{found.intrinsic_lag, found.intrinsic, found.intrinsic_half_width};
  });
  result::add_validated_on(fields, &Found::held_out).only_if(decided);
  fields.add_if(
      decided, "shares",
      [has_reflex](From found) {
        std::vector<Shares> all;
        for (const PathShares& one : found.shares) all.push_back({&one, has_reflex(found)});
        return all;
      },
      "for each axis; the paths overlap and need not add up");
  const auto reflex = [](Fields<Found>& part) {
    part.type("ReflexPath", "Force in response to stretch in one direction, v⁺ = max(eᵀẋ, 0), after a delay.");
    part.add("direction", &Found::direction, "e, of stretch");
    part.add("delay_s", &Found::delay, "first lag with a response");
    part.add("delay_interval95_s", [](From found) { return std::pair(found.delay_low, found.delay_high); });
    part.add("delay_at_limit", &Found::delay_at_limit, "it is the shortest that was tried and may be shorter");
    part.add("memory_s", &Found::memory, "last lag");
    part.add("rank", &Found::reflex_rank);
    part.add("gain", &Found::gain, "force for a steady stretch velocity, for each axis [N·s/m]");
    part.add("gain_along", &Found::gain_along, "along e; positive resists the stretch");
    part.add("gain_identifiable", &Found::gain_identifiable, "its interval is narrower than it");
    part.add("nonlinearity", &Found::nonlinearity, "c of N(v) = Σ c_k (v/speed_scale)^k, k = 1 …");
    part.add("speed_scale", &Found::speed_scale);
    part.with([](From found) { return PathResponse{found.reflex_lag, found.reflex, found.reflex_half_width}; });
    part.add("second_order", &Found::second_order);
  };
  fields.group("reflex", reflex).only_if(has_reflex);
  fields.add_if(has_reflex, "intrinsic_model", &Found::intrinsic_model);
  fields.add("emg", &Found::emg);
}

namespace {

struct Course {
  const MatrixCourse& of;
  bool changes;
};

void describe(Fields<Course>& fields) {
  using From = const Course&;
  fields.type("MatrixCourse",
              "M, B or K along a variable. `value`, `half_width95` and `change` are present if a change was detected.");
  fields.add(
      "constant", [](From course) { return course.of.mean; }, "from the constant model");
  fields.add("constant_half_width95", [](From course) { return course.of.mean_half_width; });
  fields
      .add_columns(
          "value", [](From course) { return course.of.value; },
          "one list for each entry of the matrix, column by column, with one number for each of `at`")
      .only_if(&Course::changes);
  fields
      .add_columns(
          "half_width95", [](From course) { return course.of.half_width; }, "pointwise")
      .only_if(&Course::changes);
  fields.add_if(
      &Course::changes, "change", [](From course) { return course.of.change; },
      "root mean square difference from `constant`, as a share of it; 0 where it does not vary");
}

}  // namespace

void describe(Fields<TimeCourseEstimate>& fields) {
  using Found = TimeCourseEstimate;
  using From = const Found&;
  fields.type("TimeCourseEstimate", "M, B and K as splines of time or of another variable.");
  fields.add_choice("verdict", &Found::changes, "changes", "constant");
  fields.add("why", &Found::why);
  fields.add("variable", &Found::variable);
  fields.add("unit", &Found::unit);
  fields.add(
      "range", [](From found) { return std::pair(found.from, found.to); }, "of the variable, [low, high]");
  fields.add("repetitions", &Found::repetitions, "trials or events that were pooled");
  fields.add("rows", &Found::rows, "behind the low-pass");
  fields.add("rate_hz", &Found::rate_hz, "of the rows [Hz]");
  fields.add("instruments", &Found::instruments, "instrumental variables from the reference; otherwise least squares");
  fields.add("functions", &Found::functions, "splines of each entry that varies; 1: a constant");
  fields.add("degree", &Found::degree, "of the splines: 1 linear, 3 cubic; 0: constants");
  fields.add("varying", &Found::varying, "which of M, B and K vary; empty: none");
  fields.add("knots", &Found::knots, "interior ones");
  fields.add("BIC_gain", &Found::bic_gain, "BIC of constant M, B and K minus that of the chosen model");
  fields.add("p", &Found::p_value, "p-value for a constant limb");
  fields.add("at", &Found::at, "values of the variable");
  fields.add("M", [](From found) { return Course{found.M, found.changes}; });
  fields.add("B", [](From found) { return Course{found.B, found.changes}; });
  fields.add("K", [](From found) { return Course{found.K, found.changes}; });
}

void describe(Fields<MatrixEstimate>& fields) {
  fields.type("MatrixAfterOnset");
  fields.add("value", &MatrixEstimate::value);
  fields.add("half_width95", &MatrixEstimate::half_width);
  fields.add("eigenvalues", &MatrixEstimate::eigenvalue, "of the symmetric part, ascending");
  fields.add("eigenvalues_half_width95", &MatrixEstimate::eigenvalue_half_width);
  fields.add("identifiable", &MatrixEstimate::identifiable,
             "the intervals of all eigenvalues reach less than half of the largest one to either side");
}

void describe(Fields<AfterOnsetEstimate>& fields) {
  using Found = AfterOnsetEstimate;
  const auto of_axes = [](double ExplainedForce::*member) {
    return [member](const Found& found) {
      std::vector<double> values;
      for (const ExplainedForce& one : found.explained) values.push_back(one.*member);
      return values;
    };
  };
  fields.type("AfterOnsetEstimate",
              "M, B and K from the first milliseconds after a step of the reference, before a voluntary response. "
              "Present if requested.");
  fields.add("window_s", &Found::window_s, "after each onset [s]");
  fields.add("baseline_s", &Found::baseline_s, "before each onset [s]");
  fields.add("onsets", &Found::onsets, "pooled");
  fields.add("omitted_onsets", &Found::omitted,
             "omitted because the limb did not rest before them, or too near an end of the recording");
  fields.add("displacement", &Found::displacement, "largest, mean over the onsets");
  fields.add("handle_mass", &Found::handle_mass, "subtracted from M [kg]");
  fields.add("degrees_of_freedom", &Found::degrees_of_freedom, "of Student's t for the intervals");
  fields.add("M", &Found::M);
  fields.add("B", &Found::B);
  fields.add("K", &Found::K);
  fields.add("VAF", of_axes(&ExplainedForce::vaf), "in sample, of the increments [%]");
  fields.add("RMSE", of_axes(&ExplainedForce::rmse));
}

}  // namespace mbk
