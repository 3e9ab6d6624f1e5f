#include "mbk/validation/coverage.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "mbk/identify/impedance_fit.h"
#include "mbk/impedance/model.h"
#include "mbk/laboratory/prescribed_motion.h"
#include "mbk/measurement/measure.h"
#include "mbk/numeric/parallel.h"
#include "mbk/numeric/statistics.h"

namespace mbk::validation {
namespace {

/// Which parameters of one run lie inside their interval.
Result<Eigen::Array<bool, Eigen::Dynamic, 1>> held(const CoverageOptions& options, int run) {
  laboratory::PrescribedMotionOptions lab;
  lab.seed = options.seed * 1'000'003u + static_cast<std::uint64_t>(run);
  lab.sensors.coloured_force_noise = options.remnant_force;
  const auto recording = laboratory::record_prescribed_motion(lab, Hertz(1000.0));
  if (!recording) return tl::unexpected(recording.error());
  const auto measured = measurement::measure({&*recording, 1}, {});
  if (!measured) return tl::unexpected(measured.error());
  const Identification& id = measured->identification;
  const Vector error = impedance::stacked(id.model) - impedance::stacked(lab.limb);
  const Vector reach = numeric::kNormal95 * impedance::stacked(id.standard_error);
  return Eigen::Array<bool, Eigen::Dynamic, 1>(error.array().abs() <= reach.array());
}

}  // namespace

Result<ValidationTable> coverage(const CoverageOptions& options) {
  if (options.runs < 1) return bad_usage(fmt::format("{} runs show nothing", options.runs), "pass --runs 400");
  const std::vector<std::string> names = identify::parameter_names(2);
  std::vector<Eigen::Array<bool, Eigen::Dynamic, 1>> inside(static_cast<std::size_t>(options.runs));
  int done = 0;
  const auto ran = numeric::parallel_for(
      options.runs, options.threads,
      [&](int run) -> Result<void> {
        auto one = held(options, run);
        if (!one) return tl::unexpected(one.error());
        inside[static_cast<std::size_t>(run)] = std::move(*one);
        return {};
      },
      [&](int) {
        if (options.progress) options.progress(++done);
      });
  if (!ran) return tl::unexpected(ran.error());

  ValidationTable table;
  table.study = "coverage";
  table.question =
      fmt::format("how often do the 95 % intervals hold the truth, with coloured force noise of {:g} N in one trial?",
                  options.remnant_force);
  table.unit = "%";
  table.runs = options.runs;
  table.seed = options.seed;
  for (std::size_t k = 0; k < names.size(); ++k) {
    int hits = 0;
    for (const auto& run : inside) hits += run[static_cast<Index>(k)] ? 1 : 0;
    const auto [low, high] = numeric::binomial_interval(hits, options.runs, 0.99);
    table.rows.push_back({names[k], 100.0 * hits / options.runs, {100.0 * low, 100.0 * high}, std::pair{92.0, 98.0}});
  }
  return table;
}

}  // namespace mbk::validation
