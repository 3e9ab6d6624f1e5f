#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mbk/measure/measurement/measure.h"
#include "mbk/simulate/laboratory/prescribed_motion.h"

namespace mbk::pipeline {

inline constexpr Hertz kRate{1000.0};

inline Recording generated(const laboratory::PrescribedMotionOptions& options) {
  return laboratory::record_prescribed_motion(options, kRate).value();
}

/// Largest |got − expected| over the largest |expected|, as checks of this project count it.
inline double difference(const Matrix& got, const Matrix& expected) {
  return (got - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

/// Row by row, as the 113-bit twin and expected.json write it.
template <class Numbers>
Matrix matrix2(const Numbers& by_row) {
  return (Matrix(2, 2) << by_row[0], by_row[1], by_row[2], by_row[3]).finished();
}

template <class Numbers>
Vector vector2(const Numbers& numbers) {
  return (Vector(2) << numbers[0], numbers[1]).finished();
}

inline bool warns(const Identification& identification, WarningCode code) {
  return std::any_of(identification.warnings.begin(), identification.warnings.end(),
                     [&](const Warning& warning) { return warning.code == code; });
}

inline std::string codes(const Identification& identification) {
  std::string all;
  for (const Warning& warning : identification.warnings) all += std::string(word_of(warning.code)) + " ";
  return all;
}

/// The folder of outside recordings, where there is one.
inline std::optional<std::filesystem::path> data_folder() {
  const char* folder = std::getenv("MBK_DATA_DIR");
  if (folder == nullptr) return std::nullopt;
  return std::filesystem::path(folder);
}

}  // namespace mbk::pipeline
