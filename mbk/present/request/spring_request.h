#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/option_table.h"
#include "mbk/base/core/result.h"
#include "mbk/measure/calibration/spring_design.h"
#include "mbk/model/trial/springs.h"

namespace mbk::request {

/// A spring field to compute: the springs, and the options of the search.
struct SpringFieldRequest {
  std::vector<std::string> springs;  ///< "k=120,l=90mm,anchor=565:183[,hole=8:8]"
  std::string start;                 ///< "X:Y" in mm; "": the centre of the anchors
  double radius = 0.030;             ///< [m]
  double rotation_deg = 0.0;         ///< of the disc
  std::optional<double> grid_step;   ///< [m]; absent: no grid
  bool push = false;                 ///< springs shorter than at rest push
};

/// --spring, --radius, --start, --rotation, --grid-step and --push.
[[nodiscard]] const OptionTable<SpringFieldRequest>& spring_field_table();

/// Of the springs that the request names.   @fails  usage: a key is unknown, missing or twice; a value is not a number.
[[nodiscard]] Result<std::vector<Spring>> springs_of(const SpringFieldRequest& request);

/// The field of an array of springs.   @fails  usage: the start is no place. As calibration::spring_field.
[[nodiscard]] Result<SpringField> spring_field_of(const SpringFieldRequest& request,
                                                  const std::vector<Spring>& springs);

/// Springs for a target stiffness, as they are typed.
struct SpringDesignRequest {
  std::string stiffness;                    ///< "KXX,KYY,KS"
  std::string at, frame = "390:0";          ///< "X:Y" in mm; at: "" is the frame's middle
  std::string spring_stiffness = "20:400";  ///< "FROM:TO" in N/m
  std::string spring_length = "60:160";     ///< "FROM:TO" in mm
  std::vector<std::string> eyes;            ///< "X:Y" in mm; empty: the published frame
  bool disc = false;                        ///< each hangs in the facing hole of the published disc
  calibration::SpringRequest options;       ///< but for what the words above say
};

/// --stiffness and the rest.
[[nodiscard]] const OptionTable<SpringDesignRequest>& spring_design_table();

/// @fails  usage: a word that is no stiffness, place or range.
[[nodiscard]] Result<calibration::SpringRequest> spring_design_of(const SpringDesignRequest& request);

}  // namespace mbk::request
