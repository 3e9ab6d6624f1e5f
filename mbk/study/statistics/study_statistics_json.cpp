#include "mbk/study/statistics/summary_document.h"
#include "mbk/study/store/study_documents.h"

namespace mbk::reliability {

using document::Fields;

/// Of a field "support".
constexpr const char* kSupport = "whether the data support the statistic; otherwise its numbers are absent or null";

void describe(Fields<Icc>& fields) {
  fields.type("StudyIcc");
  fields.add("form", &Icc::form, "ICC(1), ICC(A,1), ICC(C,1) of McGraw and Wong (1996)");
  fields.add("averaged", &Icc::averaged, "number of measurements averaged");
  fields.add("value", &Icc::value);
  fields.add("interval95", &Icc::interval95, "after McGraw and Wong (1996), from the F distribution; may be below 0");
}

void describe(Fields<MeasurementError>& fields) {
  fields.type("StudyMeasurementError");
  fields.add("form", &MeasurementError::form,
             "agreement or consistency: whether a common change of all people counts as error");
  fields.add("sem", &MeasurementError::sem, "standard error of measurement [unit]");
  fields.add("sem95", &MeasurementError::sem95);
  fields.add("mdc95", &MeasurementError::mdc95, "minimal detectable change, 1.96 √2 SEM [unit]");
  fields.add("mdc95_interval", &MeasurementError::mdc95_interval);
}

void describe(Fields<ModelReliability>& fields) {
  fields.type("StudyModelReliability");
  fields.add("trials", &ModelReliability::trials, "trials averaged per session");
  fields.add("icc", &ModelReliability::icc);
  fields.add("icc95", &ModelReliability::icc95);
  fields.add("sem_between", &ModelReliability::sem_between, "between sessions [unit]");
  fields.add("sem_between95", &ModelReliability::sem_between95);
  fields.add("sem_within", &ModelReliability::sem_within, "within a session [unit]");
  fields.add("sem_within95", &ModelReliability::sem_within95);
  fields.add("mdc95_between", &ModelReliability::mdc95_between);
  fields.add("mdc95_within", &ModelReliability::mdc95_within);
}

void describe(Fields<EffectSize>& fields) {
  fields.type("StudyEffect");
  fields.add("g", &EffectSize::g, "Hedges's g");
  fields.add("d", &EffectSize::d,
             "divided by the pooled standard deviation; paired: by the standard deviation of the differences");
  fields.add("interval95", &EffectSize::interval95);
}

void describe(Fields<Permutation>& fields) {
  fields.type("StudyPermutation");
  fields.add("support", &Permutation::support, kSupport);
  fields.add("p", &Permutation::p);
  fields.add("smallest_p", &Permutation::smallest_p, "smallest possible with this number of people");
  fields.add("exact", &Permutation::exact, "true: all arrangements; false: random ones");
  fields.add("arrangements", &Permutation::arrangements);
}

void describe(Fields<FacetVariance>& fields) {
  fields.type("StudyRaterVariance");
  fields.add("term", &FacetVariance::term);
  fields.add("value", &FacetVariance::value, "[unit²]; never below 0");
  fields.add("standard_error", &FacetVariance::standard_error, "from the expected information");
  fields.add("pooled", &FacetVariance::pooled, "variances that the design cannot separate from it");
}

void describe(Fields<AveragedError>& fields) {
  fields.type("StudyRaterError");
  fields.add("sem", &AveragedError::sem, "[unit]; null: unknown");
  fields.add("sem95", &AveragedError::sem95, "Satterthwaite, allowing for heavy tails");
  fields.add("mdc95", &AveragedError::mdc95, "1.96 √2 SEM");
  fields.add("mdc95_interval", &AveragedError::mdc95_interval);
}

void describe(Fields<Generalizability>& fields) {
  using From = const Generalizability&;
  fields.type("StudyGeneralizability", "Of the mean of so many raters, sessions and trials.");
  fields.add("support", &Generalizability::support, kSupport);
  fields.add(
      "raters", [](From one) { return one.averaged.raters; }, "averaged");
  fields.add("sessions", [](From one) { return one.averaged.sessions; });
  fields.add(
      "trials", [](From one) { return one.averaged.trials; }, "by each rater in each session");
  fields.add("relative", &Generalizability::relative, "generalizability coefficient G: by the same raters");
  fields.add("relative95", &Generalizability::relative95);
  fields.add("absolute", &Generalizability::absolute, "dependability coefficient Φ: by any raters");
  fields.add("absolute95", &Generalizability::absolute95);
  fields.add("relative_error", &Generalizability::relative_error);
  fields.add("absolute_error", &Generalizability::absolute_error);
  fields.add("same_raters", &Generalizability::same_raters, "between two sessions measured by the same raters");
}

}  // namespace mbk::reliability

namespace mbk::store {

void describe(document::Fields<OutcomeSummary>& fields) {
  fields.add("condition", &OutcomeSummary::condition);
  fields.add("outcome", &OutcomeSummary::outcome);
  fields.add("unit", &OutcomeSummary::unit);
  fields.add("results", &OutcomeSummary::results);
  fields.add("participants", &OutcomeSummary::participants);
  fields.add_number("mean", &OutcomeSummary::mean, "of the participants' means; for an orientation, the mean axis");
  fields.add("standard_deviation", &OutcomeSummary::standard_deviation,
             "of the participants' means; null: one participant");
  fields.add_number("minimum", &OutcomeSummary::minimum, "of all results");
  fields.add_number("maximum", &OutcomeSummary::maximum, "of all results");
}

}  // namespace mbk::store

namespace mbk::statistics {

using document::Fields;
using document::through;
using reliability::kSupport;

namespace {

struct BetweenSessions {
  const Repeated& of;
};
struct WithinSession {
  const Repeated& of;
};

template <class View>
void describe_repeated(Fields<View>& fields, const std::string& repetitions) {
  fields.add(
      "support", [](const View& view) { return view.of.support; }, kSupport);
  fields.add(
      "participants", [](const View& view) { return view.of.participants.size(); },
      "participants who have all of these");
  fields.add(
      "left_out", [](const View& view) { return view.of.left_out; }, "participants with values who lack one of these");
  fields.add(repetitions, [](const View& view) { return view.of.repetitions; });
  fields.add("icc", [](const View& view) { return view.of.test_retest.icc; });
  fields.add("error", [](const View& view) { return view.of.test_retest.error; });
}

void describe(Fields<BetweenSessions>& fields) {
  describe_repeated(fields, "sessions");
}

void describe(Fields<WithinSession>& fields) {
  describe_repeated(fields, "trials");
}

}  // namespace

void describe(Fields<SessionAgreement>& fields) {
  using From = const SessionAgreement&;
  fields.type("StudyAgreement", "Bland and Altman's limits of agreement, with exact intervals.");
  fields.add("first_session", &SessionAgreement::first_session);
  fields.add("second_session", &SessionAgreement::second_session);
  fields.add("support", through(&SessionAgreement::limits, &reliability::BlandAltman::support), kSupport);
  fields.add("participants", through(&SessionAgreement::limits, &reliability::BlandAltman::people));
  fields.add("bias", through(&SessionAgreement::limits, &reliability::BlandAltman::bias),
             "mean of second − first [unit]");
  fields.add("bias95", through(&SessionAgreement::limits, &reliability::BlandAltman::bias95));
  fields.add("standard_deviation", through(&SessionAgreement::limits, &reliability::BlandAltman::standard_deviation),
             "of the differences");
  fields.add(
      "lower", [](From one) { return one.limits.lower.value; }, "bias − 1.96 s");
  fields.add("lower95", [](From one) { return one.limits.lower.interval95; });
  fields.add(
      "upper", [](From one) { return one.limits.upper.value; }, "bias + 1.96 s");
  fields.add("upper95", [](From one) { return one.limits.upper.interval95; });
  fields.add("tolerance95", through(&SessionAgreement::limits, &reliability::BlandAltman::tolerance95));
}

void describe(Fields<Influence>& fields) {
  fields.type("StudyInfluence", "The most influential person.");
  fields.add("participant", &Influence::participant);
  fields.add("without", &Influence::without, "ICC(A,1), or p, without that person");
}

void describe(Fields<MixedReliability>& fields) {
  fields.type("StudyMixedModel", "By restricted maximum likelihood, from every result.");
  fields.add("support", &MixedReliability::support, kSupport);
  fields.add("weighted", &MixedReliability::weighted, "each trial weighted by its standard error");
  fields.add("participants", &MixedReliability::participants);
  fields.add("sessions", &MixedReliability::sessions);
  fields.add("results", &MixedReliability::results);
  const auto variances = [](Fields<MixedReliability>& variance) {
    variance.add("participant", &MixedReliability::participant);
    variance.add("session", &MixedReliability::session,
                 "between sessions; null: not identifiable, since too few sessions have two trials");
    variance.add("residual", &MixedReliability::residual, "between trials; null: not identifiable");
    variance.add("within_participant", &MixedReliability::within, "session and residual together");
    variance.add("known", &MixedReliability::known, "mean of the trials' squared standard errors; 0 if not weighted");
  };
  fields.group("variance", variances, "[unit²]");
  fields.add("of_trials", &MixedReliability::of_trials,
             "for one trial, and for the mean of the median number of trials per session");
}

void describe(Fields<RaterReliability>& fields) {
  using reliability::RaterModel;
  fields.type("StudyRaters", "People × raters × sessions × trials, by restricted maximum likelihood.");
  fields.add("support", through(&RaterReliability::model, &RaterModel::support), kSupport);
  fields.add("participants", through(&RaterReliability::model, &RaterModel::participants));
  fields.add("repeated_participants", through(&RaterReliability::model, &RaterModel::repeated_participants),
             "measured by two raters or more");
  fields.add("raters", through(&RaterReliability::model, &RaterModel::raters));
  fields.add("sessions", through(&RaterReliability::model, &RaterModel::sessions));
  fields.add("results", through(&RaterReliability::model, &RaterModel::rows));
  fields.add("without_rater", &RaterReliability::without_rater, "results that name no rater, left out");
  fields.add("session_facet", through(&RaterReliability::model, &RaterModel::session_facet),
             "whether sessions have variances of their own");
  fields.add("variances", through(&RaterReliability::model, &RaterModel::variances));
  fields.add("of_numbers", &RaterReliability::of_numbers,
             "for one rater, session and trial; for the typical numbers of the study; for those of --raters");
}

void describe(Fields<BootstrapInterval>& fields) {
  fields.type("StudyBootstrap", "A number with its bootstrap over people.");
  fields.add("value", &BootstrapInterval::value);
  fields.add("standard_error", &BootstrapInterval::standard_error, "standard deviation of the draws");
  fields.add("percentile95", &BootstrapInterval::percentile95);
  fields.add("bca95", &BootstrapInterval::bca95);
  fields.add("undefined", &BootstrapInterval::undefined, "draws without a number; above 5 % there is no interval");
}

void describe(Fields<ReliabilityBootstrap>& fields) {
  fields.add("icc_agreement", &ReliabilityBootstrap::icc_agreement);
  fields.add("icc_consistency", &ReliabilityBootstrap::icc_consistency);
  fields.add("sem_agreement", &ReliabilityBootstrap::sem_agreement);
}

void describe(Fields<OutcomeReliability>& fields) {
  using From = const OutcomeReliability&;
  fields.type("StudyReliability", "Reliability of one outcome under one condition.");
  fields.add("condition", &OutcomeReliability::condition);
  fields.add("outcome", &OutcomeReliability::outcome);
  fields.add("unit", &OutcomeReliability::unit);
  fields.add("axial", &OutcomeReliability::axial, "an orientation: unwrapped about the mean axis");
  fields.add("participants", &OutcomeReliability::participants, "with a result");
  fields.add("repeated_participants", &OutcomeReliability::repeated_participants, "in two sessions or more");
  fields.add("results", &OutcomeReliability::results);
  fields.add("between_sessions", [](From one) { return BetweenSessions{one.between_sessions}; });
  fields.add("agreement", &OutcomeReliability::agreement, "each session with the one before");
  fields.add_or_null("influence", &OutcomeReliability::influence);
  fields.add_or_null(
      "session", [](From one) { return one.session > 0 ? std::optional(one.session) : std::nullopt; },
      "session of within_session");
  fields.add("within_session", [](From one) { return WithinSession{one.within_session}; });
  fields.add("mixed_model", &OutcomeReliability::mixed_model);
  fields.add("raters", &OutcomeReliability::raters, "if results name raters");
  fields.add("bootstrap", &OutcomeReliability::bootstrap, "of the reliability between sessions, with --bootstrap");
  fields.add("warnings", &OutcomeReliability::warnings,
             "codes of reasons not to take the numbers at face value; each has a sentence in notes");
  fields.add("notes", &OutcomeReliability::notes, "remarks needed to interpret the numbers");
}

void describe(Fields<Quartiles>& fields) {
  fields.type("StudyQuartiles");
  fields.add("count", &Quartiles::count);
  fields.add("lower_quartile", &Quartiles::lower);
  fields.add("median", &Quartiles::median);
  fields.add("upper_quartile", &Quartiles::upper);
}

void describe(Fields<MatrixSpread>& fields) {
  fields.type("StudyMatrixSpread", "Impedance widths (affine-invariant distances) of matrices.");
  fields.add("condition", &MatrixSpread::condition);
  fields.add_as("matrix", {{"enum", {"M", "B", "K"}}}, &MatrixSpread::matrix);
  fields.add("support", &MatrixSpread::support, kSupport);
  fields.add("participants", &MatrixSpread::participants);
  fields.add("sessions", &MatrixSpread::sessions);
  fields.add("left_out", &MatrixSpread::left_out, "sessions whose mean matrix is not positive definite");
  fields.add("within_participants", &MatrixSpread::within);
  fields.add("between_participants", &MatrixSpread::between);
  fields.add("closer", &MatrixSpread::closer, "probability that two sessions of one person are closer than two people");
}

void describe(Fields<MixedDifference>& fields) {
  fields.type("StudyMixedDifference", "Participants as random effect; includes those who have only one of the two.");
  fields.add("weighted", &MixedDifference::weighted, "each mean weighted by the standard errors of its trials");
  fields.add("participants", &MixedDifference::participants);
  fields.add("difference", through(&MixedDifference::difference, &reliability::FixedEffect::value));
  fields.add("standard_error", through(&MixedDifference::difference, &reliability::FixedEffect::standard_error));
  fields.add("degrees_of_freedom",
             through(&MixedDifference::difference, &reliability::FixedEffect::degrees_of_freedom));
  fields.add("interval95", through(&MixedDifference::difference, &reliability::FixedEffect::interval95));
  fields.add("p", through(&MixedDifference::difference, &reliability::FixedEffect::p));
  fields.group("variance", [](Fields<MixedDifference>& variance) {
    variance.add("participant", &MixedDifference::participant);
    variance.add("residual", &MixedDifference::residual);
  });
}

void describe(Fields<OutcomeComparison>& fields) {
  using From = const OutcomeComparison&;
  const auto enough = [](From one) { return one.difference.support == Support::enough; };
  fields.type("StudyDifference", "One outcome between two levels; each person counts once in each.");
  fields.add("condition", &OutcomeComparison::condition,
             "under which groups or sessions are compared; \"\" if conditions are compared");
  fields.add("first", &OutcomeComparison::first);
  fields.add("second", &OutcomeComparison::second);
  fields.add("outcome", &OutcomeComparison::outcome);
  fields.add("unit", &OutcomeComparison::unit);
  fields.add("axial", &OutcomeComparison::axial, "an orientation");
  fields.add("verdict", &OutcomeComparison::verdict, "differs: p_holm is at most 0.05");
  fields.add("pairing", through(&OutcomeComparison::difference, &reliability::Difference::pairing));
  fields.add("support", through(&OutcomeComparison::difference, &reliability::Difference::support), kSupport);
  fields.add("first_participants", through(&OutcomeComparison::difference, &reliability::Difference::first_count));
  fields.add("second_participants", through(&OutcomeComparison::difference, &reliability::Difference::second_count));
  fields.add("left_out", &OutcomeComparison::left_out, "paired: people who have only one of the two");
  fields.add("first_mean", &OutcomeComparison::first_mean);
  fields.add("second_mean", &OutcomeComparison::second_mean);
  fields.add("difference", through(&OutcomeComparison::difference, &reliability::Difference::value),
             "second − first [unit]");
  fields.add("standard_error", [=](From one) { return enough(one) ? one.difference.standard_error : kNaN; });
  fields.add("degrees_of_freedom", [=](From one) { return enough(one) ? one.difference.degrees_of_freedom : kNaN; });
  fields.add_or_null("interval95",
                     [=](From one) { return enough(one) ? std::optional(one.difference.interval95) : std::nullopt; });
  fields.add("p", through(&OutcomeComparison::difference, &reliability::Difference::p),
             "Welch's t, or Student's where paired");
  fields.add("p_holm", &OutcomeComparison::p_holm, "adjusted for all tests of the comparison");
  fields.add("p_benjamini_hochberg", &OutcomeComparison::p_benjamini_hochberg);
  fields.add_or_null("effect",
                     [=](From one) { return enough(one) ? std::optional(one.difference.effect) : std::nullopt; });
  fields.add("permutation", &OutcomeComparison::permutation);
  fields.add_or_null("mixed_model", &OutcomeComparison::mixed_model);
  fields.add_or_null("influence", &OutcomeComparison::influence);
  fields.add("bootstrap", &OutcomeComparison::bootstrap);
  fields.add("notes", &OutcomeComparison::notes, "remarks needed to interpret the numbers");
}

void describe(Fields<Comparison>& fields) {
  fields.type("StudyComparison");
  fields.add("by", &Comparison::by);
  fields.add("levels", &Comparison::levels);
  fields.add("tests", &Comparison::tests, "p-values that are adjusted together");
  fields.add("outcomes", &Comparison::outcomes);
}

void describe(Fields<BootstrapDraws>& fields) {
  fields.add("draws", &BootstrapDraws::draws);
  fields.add("seed", &BootstrapDraws::seed);
}

void describe(Fields<StudyStatistics>& fields) {
  fields.add("reliability", &StudyStatistics::reliability);
  fields.add("matrices", &StudyStatistics::matrices);
  fields.add("comparison", &StudyStatistics::comparison);
  fields.add("bootstrap", &StudyStatistics::bootstrap, "resampling of people, with --bootstrap");
  fields.add("notes", &StudyStatistics::notes, "on the study as a whole");
}

void describe(Fields<StudySummary>& fields) {
  using From = const StudySummary&;
  fields.type("StudySummary",
              "Output of `mbk study summary --json`: usable results of recordings that are not excluded.");
  fields.header("mbk.study_summary/1");
  fields.add("title", [](From summary) { return summary.list.facts.title; });
  fields.add_or_null("analysis", [](From summary) { return summary.list.analysis; });
  fields.add("counts", [](From summary) { return store::Counts{summary.list}; });
  fields.add("outcomes", &StudySummary::outcomes);
  fields.with([](From summary) -> const StudyStatistics& { return summary.statistics; });
}

void add_schemas(document::Schemas& schemas) {
  schemas["study_summary"] = document::schema_of<StudySummary>();
  add_plan_schema(schemas);
}

std::string to_json(const store::StudyList& list, std::span<const store::OutcomeSummary> outcomes,
                    const StudyStatistics& statistics) {
  return document::document(StudySummary{list, outcomes, statistics});
}

}  // namespace mbk::statistics
