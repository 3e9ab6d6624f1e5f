#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mbk/base/core/words.h"
#include "mbk/batch/job.h"

/// What the process that looks after a job notes of its chunks, line by line: of what happens outside of the shards.
namespace mbk::batch {

enum class EventKind {
  taken_up,    ///< a process looks after the job; `why`: by which engine
  handed_out,  ///< a chunk, to the engine
  begun,       ///< its task was first seen to run
  finished,    ///< its shard is whole
  lost,        ///< its task ended without one; `why`
  given_up,    ///< nobody tries it again
  left,        ///< the process no longer looks after the job
  merged,      ///< its results were taken; `took_s`
};

[[nodiscard]] constexpr auto word_table(EventKind) {
  using enum EventKind;
  return std::to_array<Word<EventKind>>({{taken_up, "taken up"},
                                         {handed_out, "handed out"},
                                         {begun, "begun"},
                                         {finished, "finished"},
                                         {lost, "lost"},
                                         {given_up, "given up"},
                                         {left, "left"},
                                         {merged, "merged"}});
}

struct JobEvent {
  EventKind kind = EventKind::taken_up;
  double at_s = 0.0;        ///< time that processes have looked after the job, one after the other
  std::int64_t chunk = -1;  ///< −1: of the job
  std::string why;
  double took_s = 0.0;
};

/// In the order in which they were noted; a line that is not whole is passed over. None where the job has no notes.
[[nodiscard]] std::vector<JobEvent> job_events(const JobFolder& folder);

/// Appends to the notes. What cannot be written is not there: no result depends on it.
class JobEventWriter {
 public:
  explicit JobEventWriter(const JobFolder& folder);
  /// Since notes were first taken, without the time in which nobody looked after the job.
  [[nodiscard]] double now_s() const;
  void add(EventKind kind, std::int64_t chunk = -1, const std::string& why = "", double took_s = 0.0);
  /// What was added is in the file.
  void flush();

 private:
  std::filesystem::path file_;
  double before_s_ = 0.0, begin_s_;
  std::string waiting_;
};

/// Notes that the results of a job were taken, and how long that took [s].
void note_merged(const JobFolder& folder, double took_s);

}  // namespace mbk::batch
