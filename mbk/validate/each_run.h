#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "mbk/base/numeric/parallel.h"
#include "mbk/batch/value_bytes.h"
#include "mbk/validate/study.h"

namespace mbk::validation {

/// What a study answers whose runs cannot be handed to other processes.
[[nodiscard]] inline tl::unexpected<Error> only_here() {
  return bad_usage("what a run of this study gives cannot be passed from process to process", "leave out --engine");
}

/// work(i) for i = 0 … count − 1, several at a time in this process; in the order of i.
/// @param options  threads, progress
/// @fails  as work: the first failure.
template <class Options, class Work>
auto each_run_here(const Options& options, int count, const Work& work)
    -> Result<std::vector<typename std::invoke_result_t<Work, int>::value_type>> {
  std::vector<typename std::invoke_result_t<Work, int>::value_type> runs(static_cast<std::size_t>(count));
  int done = 0;
  MBK_TRY(numeric::parallel_for(
      count, options.threads,
      [&](int i) -> Result<void> {
        auto run = MBK_TRY(work(i));
        runs[static_cast<std::size_t>(i)] = std::move(run);
        return {};
      },
      [&](int) {
        if (options.progress) options.progress(++done, count);
      }));
  return runs;
}

/// The same, in other processes where the options say so. What work(i) gives depends on i and the study's options
/// alone, and passes value_bytes.h unchanged.
/// @param options  threads, progress, elsewhere
template <class Options, class Work>
auto each_run(const Options& options, int count, const Work& work)
    -> Result<std::vector<typename std::invoke_result_t<Work, int>::value_type>> {
  if (!options.elsewhere) return each_run_here(options, count, work);
  const auto gave = MBK_TRY(options.elsewhere(count, [&](int i) -> Result<std::string> {
    const auto run = MBK_TRY(work(i));
    return batch::to_bytes(run);
  }));
  std::vector<typename std::invoke_result_t<Work, int>::value_type> runs(gave.size());
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (!batch::from_bytes(gave[k], runs[k]))
      return bad_data("what another process gave cannot be read", "begin the job again");
  }
  return runs;
}

}  // namespace mbk::validation
