#include <cmath>
#include <nlohmann/json.hpp>

#include "mbk/study/statistics/study_statistics.h"

namespace mbk::statistics {
namespace {

using Document = nlohmann::ordered_json;

/// null where a number is undefined.
Document number(double value) {
  return std::isfinite(value) ? Document(value) : Document();
}

Document pair(const Interval& interval) {
  return Document::array({number(interval.first), number(interval.second)});
}

Document icc_json(const reliability::Icc& icc) {
  return {{"form", word_of(icc.form)},
          {"averaged", icc.averaged},
          {"value", number(icc.value)},
          {"interval95", pair(icc.interval95)}};
}

Document error_json(const reliability::MeasurementError& error) {
  return {{"form", word_of(error.form)},
          {"sem", number(error.sem)},
          {"sem95", pair(error.sem95)},
          {"mdc95", number(error.mdc95)},
          {"mdc95_interval", pair(error.mdc95_interval)}};
}

Document repeated_json(const Repeated& repeated, const char* repetitions) {
  Document json = {{"support", word_of(repeated.support)},
                   {"participants", repeated.participants.size()},
                   {"left_out", repeated.left_out},
                   {repetitions, repeated.repetitions}};
  json["icc"] = Document::array();
  json["error"] = Document::array();
  for (const reliability::Icc& one : repeated.test_retest.icc) json["icc"].push_back(icc_json(one));
  for (const auto& one : repeated.test_retest.error) json["error"].push_back(error_json(one));
  return json;
}

Document agreement_json(const SessionAgreement& one) {
  const reliability::BlandAltman& limits = one.limits;
  return {{"first_session", one.first_session},
          {"second_session", one.second_session},
          {"support", word_of(limits.support)},
          {"participants", limits.people},
          {"bias", number(limits.bias)},
          {"bias95", pair(limits.bias95)},
          {"standard_deviation", number(limits.standard_deviation)},
          {"lower", number(limits.lower.value)},
          {"lower95", pair(limits.lower.interval95)},
          {"upper", number(limits.upper.value)},
          {"upper95", pair(limits.upper.interval95)},
          {"tolerance95", pair(limits.tolerance95)}};
}

Document influence_json(const std::optional<Influence>& influence) {
  if (!influence) return {};
  return {{"participant", influence->participant}, {"without", number(influence->without)}};
}

Document mixed_json(const MixedReliability& model) {
  Document json = {{"support", word_of(model.support)},
                   {"weighted", model.weighted},
                   {"participants", model.participants},
                   {"sessions", model.sessions},
                   {"results", model.results},
                   {"variance",
                    {{"participant", number(model.participant)},
                     {"session", number(model.session)},
                     {"residual", number(model.residual)},
                     {"within_participant", number(model.within)},
                     {"known", number(model.known)}}}};
  json["of_trials"] = Document::array();
  for (const reliability::ModelReliability& one : model.of_trials) {
    json["of_trials"].push_back({{"trials", one.trials},
                                 {"icc", number(one.icc)},
                                 {"icc95", pair(one.icc95)},
                                 {"sem_between", number(one.sem_between)},
                                 {"sem_between95", pair(one.sem_between95)},
                                 {"sem_within", number(one.sem_within)},
                                 {"sem_within95", pair(one.sem_within95)},
                                 {"mdc95_between", number(one.mdc95_between)},
                                 {"mdc95_within", number(one.mdc95_within)}});
  }
  return json;
}

Document bootstrap_json(const BootstrapInterval& one) {
  return {{"value", number(one.value)},
          {"standard_error", number(one.standard_error)},
          {"percentile95", pair(one.percentile95)},
          {"bca95", pair(one.bca95)},
          {"undefined", one.undefined}};
}

Document reliability_json(const OutcomeReliability& one) {
  Document json = {{"condition", one.condition},
                   {"outcome", one.outcome},
                   {"unit", one.unit},
                   {"axial", one.axial},
                   {"participants", one.participants},
                   {"repeated_participants", one.repeated_participants},
                   {"results", one.results},
                   {"between_sessions", repeated_json(one.between_sessions, "sessions")}};
  json["agreement"] = Document::array();
  for (const SessionAgreement& agreement : one.agreement) json["agreement"].push_back(agreement_json(agreement));
  json["influence"] = influence_json(one.influence);
  json["session"] = one.session > 0 ? Document(one.session) : Document();
  json["within_session"] = repeated_json(one.within_session, "trials");
  json["mixed_model"] = mixed_json(one.mixed_model);
  if (one.bootstrap) {
    json["bootstrap"] = {{"icc_agreement", bootstrap_json(one.bootstrap->icc_agreement)},
                         {"icc_consistency", bootstrap_json(one.bootstrap->icc_consistency)},
                         {"sem_agreement", bootstrap_json(one.bootstrap->sem_agreement)}};
  }
  json["warnings"] = Document::array();
  for (const ReliabilityWarning warning : one.warnings) json["warnings"].push_back(word_of(warning));
  json["notes"] = one.notes;
  return json;
}

Document quartiles_json(const Quartiles& quartiles) {
  return {{"count", quartiles.count},
          {"lower_quartile", number(quartiles.lower)},
          {"median", number(quartiles.median)},
          {"upper_quartile", number(quartiles.upper)}};
}

Document spread_json(const MatrixSpread& one) {
  return {{"condition", one.condition},
          {"matrix", one.matrix},
          {"support", word_of(one.support)},
          {"participants", one.participants},
          {"sessions", one.sessions},
          {"left_out", one.left_out},
          {"within_participants", quartiles_json(one.within)},
          {"between_participants", quartiles_json(one.between)},
          {"closer", number(one.closer)}};
}

Document mixed_json(const std::optional<MixedDifference>& model) {
  if (!model) return {};
  const reliability::FixedEffect& effect = model->difference;
  return {{"weighted", model->weighted},
          {"participants", model->participants},
          {"difference", number(effect.value)},
          {"standard_error", number(effect.standard_error)},
          {"degrees_of_freedom", number(effect.degrees_of_freedom)},
          {"interval95", pair(effect.interval95)},
          {"p", number(effect.p)},
          {"variance", {{"participant", number(model->participant)}, {"residual", number(model->residual)}}}};
}

Document comparison_json(const OutcomeComparison& one) {
  const reliability::Difference& difference = one.difference;
  const reliability::Permutation& permutation = one.permutation;
  const bool enough = difference.support == Support::enough;
  Document json = {{"condition", one.condition},
                   {"first", one.first},
                   {"second", one.second},
                   {"outcome", one.outcome},
                   {"unit", one.unit},
                   {"axial", one.axial},
                   {"verdict", word_of(one.verdict)},
                   {"pairing", word_of(difference.pairing)},
                   {"support", word_of(difference.support)},
                   {"first_participants", difference.first_count},
                   {"second_participants", difference.second_count},
                   {"left_out", one.left_out},
                   {"first_mean", number(one.first_mean)},
                   {"second_mean", number(one.second_mean)},
                   {"difference", number(difference.value)}};
  json["standard_error"] = enough ? number(difference.standard_error) : Document();
  json["degrees_of_freedom"] = enough ? number(difference.degrees_of_freedom) : Document();
  json["interval95"] = enough ? pair(difference.interval95) : Document();
  json["p"] = number(difference.p);
  json["p_holm"] = number(one.p_holm);
  json["p_benjamini_hochberg"] = number(one.p_benjamini_hochberg);
  json["effect"] = enough ? Document{{"g", number(difference.effect.g)},
                                     {"d", number(difference.effect.d)},
                                     {"interval95", pair(difference.effect.interval95)}}
                          : Document();
  json["permutation"] = {{"support", word_of(permutation.support)},
                         {"p", number(permutation.p)},
                         {"smallest_p", number(permutation.smallest_p)},
                         {"exact", permutation.exact},
                         {"arrangements", permutation.arrangements}};
  json["mixed_model"] = mixed_json(one.mixed_model);
  json["influence"] = influence_json(one.influence);
  if (one.bootstrap) json["bootstrap"] = bootstrap_json(*one.bootstrap);
  json["notes"] = one.notes;
  return json;
}

}  // namespace

std::string to_json(const StudyStatistics& statistics) {
  Document json = Document::object();
  json["reliability"] = Document::array();
  for (const OutcomeReliability& one : statistics.reliability) json["reliability"].push_back(reliability_json(one));
  json["matrices"] = Document::array();
  for (const MatrixSpread& one : statistics.matrices) json["matrices"].push_back(spread_json(one));
  if (statistics.comparison) {
    Document comparison = {{"by", word_of(statistics.comparison->by)},
                           {"levels", statistics.comparison->levels},
                           {"tests", statistics.comparison->tests},
                           {"outcomes", Document::array()}};
    for (const OutcomeComparison& one : statistics.comparison->outcomes) {
      comparison["outcomes"].push_back(comparison_json(one));
    }
    json["comparison"] = std::move(comparison);
  }
  if (statistics.bootstrap) {
    json["bootstrap"] = {{"draws", statistics.bootstrap->draws}, {"seed", statistics.bootstrap->seed}};
  }
  json["notes"] = statistics.notes;
  return json.dump(-1, ' ', false, Document::error_handler_t::replace);
}

}  // namespace mbk::statistics
