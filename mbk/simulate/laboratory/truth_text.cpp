#include "mbk/simulate/laboratory/truth_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace mbk::laboratory {

std::string exact_text(double value) {
  return fmt::format("{:.12g}", value);
}

std::string exact_text(const Vector& values) {
  std::vector<std::string> entries;
  for (const double value : values) entries.push_back(exact_text(value));
  return fmt::format("[{}]", fmt::join(entries, ", "));
}

std::string exact_text(const Matrix& values) {
  std::vector<std::string> rows;
  for (Index i = 0; i < values.rows(); ++i) rows.push_back(exact_text(Vector(values.row(i).transpose())));
  return fmt::format("[{}]", fmt::join(rows, ", "));
}

std::map<std::string, std::string> truth_metadata(const impedance::Model& truth, Hertz rate, double energy_absorbed) {
  return {{"rate_hz", fmt::format("{:g}", rate.value)},
          {"truth_M", exact_text(truth.M)},
          {"truth_B", exact_text(truth.B)},
          {"truth_K", exact_text(truth.K)},
          {"truth_x0", exact_text(truth.x0)},
          {"truth_energy_absorbed_J", exact_text(energy_absorbed)}};
}

}  // namespace mbk::laboratory
