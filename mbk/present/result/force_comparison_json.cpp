#include "mbk/present/result/force_comparison_json.h"

#include "mbk/present/result/json_parts.h"

namespace mbk::result {
namespace {

Json agreement_json(const ForceAgreement& agreement) {
  return {{"rows", agreement.rows}, {"bias", list(agreement.bias)}, {"RMSE", list(agreement.rmse)}};
}

}  // namespace

Json force_comparison_json(const ForceComparison& comparison) {
  Json json = {{"duration_s", number(comparison.duration)}};
  json["all"] = agreement_json(comparison.all);
  json["rest"] = agreement_json(comparison.rest);
  json["motion"] = agreement_json(comparison.motion);
  json["reversals"] = agreement_json(comparison.reversals);
  json["measured_rms"] = list(comparison.measured_rms);
  json["VAF"] = list(comparison.vaf);
  json["gain"] = list(comparison.gain);
  json["correlation"] = list(comparison.correlation);
  json["lag_s"] = list(comparison.lag);
  json["correlation_at_lag"] = list(comparison.correlation_at_lag);
  json["rest_speed"] = number(comparison.rest_speed);
  json["reversal_window_s"] = number(comparison.reversal_window);
  json["longest_lag_s"] = number(comparison.longest_lag);
  return json;
}

}  // namespace mbk::result
