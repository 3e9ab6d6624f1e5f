#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/batch/job_request.h"
#include "mbk/study/store/store.h"
#include "mbk/study/workflow/measuring.h"

namespace mbk::workflow {

/// How measuring ended, by the number of recordings.
struct Tally {
  int usable = 0, not_usable = 0;
  int failed = 0;  ///< the recording cannot be measured
  int unread = 0;  ///< its file cannot be had

  [[nodiscard]] int count() const { return usable + not_usable + failed + unread; }
  Tally& operator+=(const Tally& other);
};

/// Who measures, and what is told on the way. Nothing is told twice at a time.
struct MeasureListener {
  store::Role role = store::Role::analyst;
  std::function<void(int done, int of)> progress = [](int, int) {};
  std::function<void(const store::Unit&, const std::string& why)> failed = [](const store::Unit&, const std::string&) {
  };  ///< a recording cannot be measured
  std::function<void(const store::Unit&, const std::string& codes)> not_usable =
      [](const store::Unit&, const std::string&) {};               ///< with the codes of its warnings, "a, b"
  std::function<void(const Error&)> unread = [](const Error&) {};  ///< its file cannot be had
};

/// Measures units within this process and stores the results in the order of the units: many in one transaction, but
/// none waits for more than a second.
/// @param key  as key_in    @param threads  0: as many as there are cores
/// @fails  data: results could not be stored.
[[nodiscard]] Result<Tally> measure_units_here(store::Store& study, const std::string& key, const Measuring& measuring,
                                               const std::vector<store::Unit>& units, unsigned threads,
                                               const MeasureListener& listener);

/// The same as a job.   @param given  the options of `measuring`
[[nodiscard]] Result<batch::JobRequest> measure_request(const store::Store& study, const OptionTexts& given,
                                                        const std::shared_ptr<const Measuring>& measuring,
                                                        const std::vector<store::Unit>& units);

/// Stores what the shards of a job hold, in the order of the units.
/// @fails  data: results could not be stored; as batch::merge.
[[nodiscard]] Result<Tally> collect_job(store::Store& study, const std::string& key, const batch::JobFolder& job,
                                        const MeasureListener& listener);

/// Measures every result of this version again, and compares it with what is stored, byte by byte; what differs and
/// what cannot be repeated goes into `report`.
/// @param progress  of one analysis after the other    @fails  data: the study cannot be read.
[[nodiscard]] Result<void> repeat_results(const store::Store& study, unsigned threads,
                                          const std::function<void(int done, int of)>& progress,
                                          store::CheckReport& report);

}  // namespace mbk::workflow
