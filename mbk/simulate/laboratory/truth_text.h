#pragma once

#include <map>
#include <string>

#include "mbk/base/core/units.h"
#include "mbk/model/impedance/model.h"

namespace mbk::laboratory {

/// A number with 12 digits; arrays and matrices as JSON.
[[nodiscard]] std::string exact_text(double value);
[[nodiscard]] std::string exact_text(const Vector& values);
[[nodiscard]] std::string exact_text(const Matrix& values);

/// The true values in the metadata of a recording: truth_M, truth_B, truth_K, truth_x0 and
/// truth_energy_absorbed_J; and rate_hz.
[[nodiscard]] std::map<std::string, std::string> truth_metadata(const impedance::Model& truth, Hertz rate,
                                                                double energy_absorbed);

}  // namespace mbk::laboratory
