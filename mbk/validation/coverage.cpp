#include "mbk/validation/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "mbk/identify/impedance_fit.h"
#include "mbk/impedance/model.h"
#include "mbk/laboratory/prescribed_motion.h"
#include "mbk/measurement/measure.h"
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
  std::vector<int> hits(names.size(), 0);
  std::optional<Error> error;
  int done = 0;
  std::mutex mutex;
  std::atomic<int> next = 0;
  const auto work = [&] {
    for (int run = next++; run < options.runs; run = next++) {
      const auto inside = held(options, run);
      const std::lock_guard lock(mutex);
      if (!inside) {
        error = inside.error();
        next = options.runs;
        return;
      }
      for (std::size_t k = 0; k < hits.size(); ++k) hits[k] += (*inside)[static_cast<Index>(k)] ? 1 : 0;
      if (options.progress) options.progress(++done);
    }
  };
  {
    const unsigned wanted = options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::jthread> workers;
    for (unsigned k = 1; k < std::min(wanted, static_cast<unsigned>(options.runs)); ++k) workers.emplace_back(work);
    work();
  }
  if (error) return tl::unexpected(*error);

  ValidationTable table;
  table.study = "coverage";
  table.question =
      fmt::format("how often do the 95 % intervals hold the truth, with coloured force noise of {:g} N in one trial?",
                  options.remnant_force);
  table.unit = "%";
  table.runs = options.runs;
  table.seed = options.seed;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto [low, high] = numeric::binomial_interval(hits[k], options.runs, 0.99);
    table.rows.push_back(
        {names[k], 100.0 * hits[k] / options.runs, {100.0 * low, 100.0 * high}, std::pair{92.0, 98.0}});
  }
  return table;
}

}  // namespace mbk::validation
