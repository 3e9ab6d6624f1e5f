#include "mbk/measure/analyse/summarise.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace mbk::analyse {

Result<Summary> summarise(const std::vector<Identification>& identifications) {
  const auto count = static_cast<double>(identifications.size());
  if (identifications.size() < 2) return bad_data(fmt::format("{} trials have no spread", identifications.size()));
  for (const Identification& one : identifications) {
    if (one.axes != identifications.front().axes || one.motion != identifications.front().motion) {
      return bad_data("its axes or units are not those of the first file, so there is no common mean",
                      "measure it by itself", one.sources.empty() ? "" : one.sources.front().path);
    }
  }
  Summary summary;
  summary.trials = static_cast<int>(identifications.size());
  summary.motion = identifications.front().motion;
  const auto over_trials = [&](auto part) {  // part: pointer to one member of impedance::Model
    using Member = std::remove_cvref_t<decltype(summary.mean.*part)>;
    Member mean = identifications.front().model.*part, squares = mean;
    mean.setZero();
    squares.setZero();
    for (const Identification& one : identifications) mean += one.model.*part / count;
    for (const Identification& one : identifications) squares += (one.model.*part - mean).cwiseAbs2();
    summary.mean.*part = mean;
    summary.between_trial_standard_error.*part = (squares / ((count - 1.0) * count)).cwiseSqrt();
  };
  over_trials(&impedance::Model::M);
  over_trials(&impedance::Model::B);
  over_trials(&impedance::Model::K);
  over_trials(&impedance::Model::x0);
  return summary;
}

}  // namespace mbk::analyse
