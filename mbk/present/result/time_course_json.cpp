#include "mbk/present/result/exploration_parts_json.h"

namespace mbk::result {
namespace time_course_parts {

Json columns(const Matrix& matrix) {
  Json array = Json::array();
  for (Index k = 0; k < matrix.cols(); ++k) array.push_back(list(matrix.col(k)));
  return array;
}

Json course(const MatrixCourse& one, bool changes) {
  Json json = {{"constant", rows(one.mean)}, {"constant_half_width95", rows(one.mean_half_width)}};
  if (!changes) return json;
  json["value"] = columns(one.value);
  json["half_width95"] = columns(one.half_width);
  json["change"] = number(one.change);
  return json;
}

}  // namespace time_course_parts

Json time_course_json(const TimeCourseEstimate& found) {
  using namespace time_course_parts;
  return {{"verdict", found.changes ? "changes" : "constant"},
          {"why", found.why},
          {"variable", found.variable},
          {"unit", found.unit},
          {"range", interval({found.from, found.to})},
          {"repetitions", found.repetitions},
          {"rows", found.rows},
          {"rate_hz", number(found.rate_hz)},
          {"instruments", found.instruments},
          {"functions", found.functions},
          {"degree", found.degree},
          {"varying", found.varying},
          {"knots", found.knots},
          {"BIC_gain", number(found.bic_gain)},
          {"p", number(found.p_value)},
          {"at", list(found.at)},
          {"M", course(found.M, found.changes)},
          {"B", course(found.B, found.changes)},
          {"K", course(found.K, found.changes)}};
}

}  // namespace mbk::result
