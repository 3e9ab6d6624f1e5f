#pragma once

#include <numbers>

#include "mbk/model/trial/findings.h"
#include "mbk/present/result/json_parts.h"

/// Ellipses and antisymmetry of one matrix. For the sources of this module only.
namespace mbk::result {

inline Json ellipse_json(const EllipseFinding& finding) {
  const double degrees = 180.0 / std::numbers::pi;
  return {{"area", number(finding.ellipse.area)},
          {"shape", number(finding.ellipse.shape)},
          {"orientation_deg", number(degrees * finding.ellipse.orientation)},
          {"eigenvalues", {number(finding.ellipse.lambda_min), number(finding.ellipse.lambda_max)}},
          {"symmetric_part", rows(finding.symmetric)},
          {"interval95",
           {{"area", interval(finding.area95)},
            {"shape", interval(finding.shape95)},
            {"orientation_deg", interval(finding.orientation95, degrees)},
            {"eigenvalues", {interval(finding.lambda_min95), interval(finding.lambda_max95)}}}}};
}

inline Json antisymmetry_json(const AntisymmetryFinding& finding) {
  return {{"value", number(finding.value)},
          {"value_interval95", interval(finding.value95)},
          {"zmean_percent", number(finding.zmean_percent)},
          {"interval95", interval(finding.zmean95)}};
}

}  // namespace mbk::result
