#include "mbk/present/result/exploration_parts_json.h"

namespace mbk::result {
namespace response_in_time {

Json columns(const Matrix& matrix) {
  Json array = Json::array();
  for (Index k = 0; k < matrix.cols(); ++k) array.push_back(list(matrix.col(k)));
  return array;
}

Json margin(const Margin& one) {
  return {{"value", number(one.value)},
          {"interval95", interval({one.value - one.half_width, one.value + one.half_width})}};
}

Json margins(const std::vector<Margin>& all) {
  Json array = Json::array();
  for (const Margin& one : all) array.push_back(margin(one));
  return array;
}

Json explained(const ExplainedForce& one) {
  return {{"VAF", number(one.vaf)},
          {"VAF_interval95", interval({one.vaf - one.vaf_half_width, one.vaf + one.vaf_half_width})},
          {"RMSE", number(one.rmse)}};
}

Json explained(const std::vector<ExplainedForce>& all) {
  Json array = Json::array();
  for (const ExplainedForce& one : all) array.push_back(explained(one));
  return array;
}

Json model(const ResponseModel& found) {
  Json json = {{"identifiable", found.identifiable}};
  if (!found.identifiable) return json;
  const auto entry = [&](const char* name, const Matrix& value, const Matrix& half, bool identifiable) {
    json[name] = {{"value", rows(value)}, {"half_width95", rows(half)}, {"identifiable", identifiable}};
  };
  entry("M", found.M, found.M_half_width, found.M_identifiable);
  entry("B", found.B, found.B_half_width, found.B_identifiable);
  entry("K", found.K, found.K_half_width, found.K_identifiable);
  json["enough"] = {{"enough", found.enough},
                    {"F", number(found.statistic)},
                    {"degrees_of_freedom", Json::array({number(found.numerator), number(found.denominator)})},
                    {"p", number(found.p_value)}};
  return json;
}

Json response(const Vector& lag, const Matrix& value, const Matrix& half_width) {
  return {{"lag_s", list(lag)}, {"response", columns(value)}, {"half_width95", columns(half_width)}};
}

}  // namespace response_in_time

Json impulse_response_json(const ImpulseResponseEstimate& found) {
  using namespace response_in_time;
  Json json = {{"sample_time_s", number(found.sample_time)},
               {"memory_s", number(found.memory)},
               {"memory_rule", found.memory_rule},
               {"memory_at_limit", found.memory_at_limit},
               {"rank", found.rank},
               {"directions", found.directions},
               {"instruments", found.instruments},
               {"validated_on", validated_on(found.held_out)}};
  json.update(response(found.lag, found.response, found.half_width));
  json["excited"] = columns(found.excited);
  json["explained"] = explained(found.explained);
  json["explained_by_model"] = explained(found.explained_by_model);
  json["model"] = model(found.model);
  return json;
}

Json parallel_cascade_json(const ParallelCascadeEstimate& found) {
  using namespace response_in_time;
  Json json = {{"delayed_response", word_of(found.found)},
               {"why", found.why},
               {"sample_time_s", number(found.sample_time)},
               {"instruments", found.instruments}};
  if (found.found == DelayedResponse::not_identifiable) return json;
  json["p_both_directions_alike"] = number(found.p_value);
  json["intrinsic_VAF"] = number(found.intrinsic_vaf);
  json["candidates"] = Json::array();
  for (const StretchCandidate& one : found.candidates) {
    json["candidates"].push_back({{"direction", one.direction.size() > 0 ? list(one.direction) : Json(nullptr)},
                                  {"VAF", number(one.vaf)},
                                  {"standard_error_of_difference", number(one.vaf_error)}});
  }
  json["intrinsic"] = response(found.intrinsic_lag, found.intrinsic, found.intrinsic_half_width);
  json["validated_on"] = validated_on(found.held_out);
  json["shares"] = Json::array();
  const bool reflex = found.found == DelayedResponse::reflex;
  for (const PathShares& one : found.shares) {
    Json shares = {{"intrinsic_alone", explained(one.intrinsic_alone)}};
    if (reflex) {
      shares["both"] = explained(one.both);
      shares["intrinsic_path"] = explained(one.intrinsic_path);
      shares["reflex_path"] = explained(one.reflex_path);
    }
    json["shares"].push_back(std::move(shares));
  }
  if (!reflex) return json;
  Json path = {{"direction", list(found.direction)},
               {"delay_s", number(found.delay)},
               {"delay_interval95_s", interval({found.delay_low, found.delay_high})},
               {"delay_at_limit", found.delay_at_limit},
               {"memory_s", number(found.memory)},
               {"rank", found.reflex_rank},
               {"gain", margins(found.gain)},
               {"gain_along", margin(found.gain_along)},
               {"gain_identifiable", found.gain_identifiable},
               {"nonlinearity", list(found.nonlinearity)},
               {"speed_scale", number(found.speed_scale)}};
  path.update(response(found.reflex_lag, found.reflex, found.reflex_half_width));
  if (found.second_order) {
    path["second_order"] = {{"gain", margins(found.second_order->gain)},
                            {"delay_s", margin(found.second_order->delay)},
                            {"frequency_hz", margin(found.second_order->frequency)},
                            {"damping", margin(found.second_order->damping)},
                            {"p", number(found.second_order->p_value)}};
  }
  json["reflex"] = std::move(path);
  json["intrinsic_model"] = model(found.intrinsic_model);
  return json;
}

}  // namespace mbk::result
