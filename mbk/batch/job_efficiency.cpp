#include "mbk/batch/job_efficiency.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "mbk/batch/job_events.h"

namespace mbk::batch {
namespace {

using Span = std::pair<double, double>;  ///< from, to [s]

/// What the notes say of a chunk.
struct ChunkNotes {
  int handed_out = 0;
  std::optional<double> handed_out_s, begun_s, finished_s;
};

/// Reads the notes from the first to the last.
class Notes {
 public:
  Notes(const std::vector<JobEvent>& events, std::size_t chunks, JobEfficiency& job) : chunks_(chunks), job_(job) {
    for (const JobEvent& event : events) read(event);
    if (taken_up_s_) job_.elapsed_s += last_s_ - *taken_up_s_;  // it still looks after the job, or was killed
  }

  [[nodiscard]] const ChunkNotes& of(std::int64_t chunk) const { return chunks_[static_cast<std::size_t>(chunk)]; }
  std::vector<Span> lost;

 private:
  void read(const JobEvent& event) {
    if (event.kind != EventKind::merged) last_s_ = event.at_s;
    switch (event.kind) {
      case EventKind::taken_up:
        if (taken_up_s_) job_.elapsed_s += event.at_s - *taken_up_s_;
        taken_up_s_ = event.at_s;
        job_.engine = event.why;
        return;
      case EventKind::left:
        if (taken_up_s_) job_.elapsed_s += event.at_s - *taken_up_s_;
        taken_up_s_.reset();
        return;
      case EventKind::merged:
        job_.merge_s = event.took_s;
        return;
      default:
        break;
    }
    if (event.chunk >= 0 && event.chunk < std::ssize(chunks_))
      read(event, chunks_[static_cast<std::size_t>(event.chunk)]);
  }

  void read(const JobEvent& event, ChunkNotes& chunk) {
    if (event.kind == EventKind::lost) {
      ++job_.losses[event.why];
      if (chunk.begun_s && !chunk.finished_s) lost.emplace_back(*chunk.begun_s, event.at_s);
      chunk.begun_s.reset();
      return;
    }
    if (chunk.finished_s) return;  // a later process saw it again
    if (event.kind == EventKind::handed_out) {
      ++chunk.handed_out;
      chunk.handed_out_s = event.at_s;
      chunk.begun_s.reset();
    } else if (event.kind == EventKind::begun) {
      chunk.begun_s = event.at_s;
    } else if (event.kind == EventKind::finished) {
      chunk.finished_s = event.at_s;
    }
  }

  std::vector<ChunkNotes> chunks_;
  JobEfficiency& job_;
  std::optional<double> taken_up_s_;
  double last_s_ = 0.0;
};

/// When a task ran, as far as was seen. What was handed out and finished between two looks ran at the end of them.
std::optional<Span> span_of(const ChunkNotes& notes, double wall_s) {
  if (!notes.finished_s) return std::nullopt;
  const double end = *notes.finished_s, seen = notes.begun_s.value_or(end), begin = std::min(seen, end - wall_s);
  return Span(std::max({begin, notes.handed_out_s.value_or(0.0), 0.0}), end);
}

/// How long at least one of them lasted, and how many did at once.
std::pair<double, int> covered(std::vector<Span> spans) {
  std::vector<std::pair<double, int>> steps;
  for (const auto& [from, to] : spans) {
    steps.emplace_back(from, 1);
    steps.emplace_back(to, -1);
  }
  std::ranges::sort(steps);  // where one ends as another begins, the end comes first
  double covered_s = 0.0, since = 0.0;
  int at_once = 0, most = 0;
  for (const auto& [at, step] : steps) {
    if (at_once == 0) since = at;
    at_once += step;
    most = std::max(most, at_once);
    if (at_once == 0) covered_s += at - since;
  }
  return {covered_s, most};
}

/// Why units of a shard gave nothing.
void add_failures(const JobFolder& folder, const ShardFile& file, std::map<std::string, std::int64_t>& failures) {
  constexpr std::size_t kMostReasons = 20;
  auto reader = open_shard_of(folder, file.path, file.chunk);
  while (reader) {
    const auto record = reader->next();
    if (!record || !*record) return;
    if ((*record)->kind != RecordKind::failure) continue;
    const bool room = failures.size() < kMostReasons || failures.contains((*record)->payload);
    ++failures[room ? (*record)->payload : "other reasons"];
  }
}

Result<std::map<std::string, std::int64_t>> failures_of(const JobFolder& folder,
                                                        const std::vector<FinishedTask>& tasks) {
  std::map<std::string, std::int64_t> failures;
  const auto files = MBK_TRY(list_shards(folder));
  for (const FinishedTask& task : tasks) {
    if (task.end.failed == 0) continue;
    const auto file = std::ranges::find_if(
        files, [&](const ShardFile& one) { return one.chunk == task.chunk && one.state == ShardFile::State::whole; });
    if (file != files.end()) add_failures(folder, *file, failures);
  }
  return failures;
}

/// What the tasks of one machine did.
struct HostShare {
  std::int64_t tasks = 0, units = 0, failed = 0;
  double wall_s = 0.0, cpu_s = 0.0;
};

std::map<std::string, HostShare> hosts_of(const JobEfficiency& job) {
  std::map<std::string, HostShare> hosts;
  for (const TaskEfficiency& one : job.tasks) {
    HostShare& host = hosts[one.task.end.host];
    ++host.tasks;
    host.units += one.task.end.units;
    host.failed += one.task.end.failed;
    host.wall_s += one.task.end.wall_s;
    host.cpu_s += one.task.end.cpu_s;
  }
  return hosts;
}

}  // namespace

double JobEfficiency::units_per_s() const {
  return elapsed_s > 0.0 ? static_cast<double>(finished_units) / elapsed_s : 0.0;
}

double JobEfficiency::busy() const {
  const double available = elapsed_s * most_at_a_time;
  return available > 0.0 ? std::min(1.0, wall_s / available) : 0.0;
}

Result<JobEfficiency> job_efficiency(const JobFolder& folder) {
  auto tasks = MBK_TRY(finished_tasks(folder));
  // What was done twice counts once.
  const auto [twice, end] = std::ranges::unique(tasks, {}, &FinishedTask::chunk);
  tasks.erase(twice, end);
  JobEfficiency job;
  job.title = folder.job().title;
  job.chunks = folder.job().chunks;
  job.units = folder.job().units;
  const Notes notes(job_events(folder), static_cast<std::size_t>(job.chunks), job);
  std::vector<Span> spans = notes.lost;
  for (const auto& [from, to] : spans) job.lost_s += to - from;
  for (const FinishedTask& task : tasks) {
    ++job.finished_chunks;
    job.finished_units += task.end.units;
    job.failed_units += task.end.failed;
    job.wall_s += task.end.wall_s;
    job.cpu_s += task.end.cpu_s;
    TaskEfficiency one{task};
    const ChunkNotes& of_chunk = notes.of(task.chunk);
    one.attempts = std::max(1, of_chunk.handed_out);
    if (const auto span = span_of(of_chunk, task.end.wall_s)) {
      spans.push_back(*span);
      one.waited_s = std::max(0.0, span->first - of_chunk.handed_out_s.value_or(span->first));
    }
    job.tasks.push_back(std::move(one));
  }
  std::tie(job.working_s, job.most_at_a_time) = covered(std::move(spans));
  job.working_s = std::min(job.working_s, job.elapsed_s);
  job.waiting_s = job.elapsed_s - job.working_s;
  auto failures = MBK_TRY(failures_of(folder, tasks));
  job.failures = std::move(failures);
  return job;
}

std::string to_json(const JobEfficiency& job) {
  nlohmann::ordered_json json = {{"schema", "mbk.job_efficiency/1"},
                                 {"title", job.title},
                                 {"engine", job.engine},
                                 {"chunks", job.chunks},
                                 {"finished_chunks", job.finished_chunks},
                                 {"units", job.units},
                                 {"finished_units", job.finished_units},
                                 {"failed_units", job.failed_units},
                                 {"elapsed_s", job.elapsed_s},
                                 {"working_s", job.working_s},
                                 {"waiting_s", job.waiting_s},
                                 {"merge_s", job.merge_s},
                                 {"wall_s", job.wall_s},
                                 {"cpu_s", job.cpu_s},
                                 {"lost_s", job.lost_s},
                                 {"most_at_a_time", job.most_at_a_time},
                                 {"units_per_s", job.units_per_s()},
                                 {"busy", job.busy()},
                                 {"losses", job.losses},
                                 {"failures", job.failures},
                                 {"hosts", nlohmann::ordered_json::array()},
                                 {"tasks", nlohmann::ordered_json::array()}};
  for (const auto& [name, host] : hosts_of(job)) {
    json["hosts"].push_back({{"host", name},
                             {"tasks", host.tasks},
                             {"units", host.units},
                             {"failed", host.failed},
                             {"wall_s", host.wall_s},
                             {"cpu_s", host.cpu_s}});
  }
  for (const TaskEfficiency& one : job.tasks) {
    const ShardEnd& end = one.task.end;
    json["tasks"].push_back({{"chunk", one.task.chunk},
                             {"host", end.host},
                             {"units", end.units},
                             {"failed", end.failed},
                             {"attempts", one.attempts},
                             {"expected_s", one.task.expected_s},
                             {"waited_s", one.waited_s},
                             {"wall_s", end.wall_s},
                             {"cpu_s", end.cpu_s}});
  }
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string to_text(const JobEfficiency& job) {
  if (job.tasks.empty()) return "";
  double expected = 0.0, slowest = 0.0;
  for (const TaskEfficiency& one : job.tasks) {
    expected += one.task.expected_s;
    slowest = std::max(slowest, one.task.end.wall_s);
  }
  std::string text = fmt::format(
      "  finished tasks: {}; {:.1f} s each, slowest {:.1f} s; processor busy {:.0f} % of the time; {:.2f} times the "
      "expected cost\n",
      job.tasks.size(), job.wall_s / static_cast<double>(job.tasks.size()), slowest,
      job.wall_s > 0.0 ? 100.0 * job.cpu_s / job.wall_s : 0.0, expected > 0.0 ? job.wall_s / expected : 0.0);
  text += fmt::format("  {:.1f} s looked after: {:.1f} s working, at most {} at a time, {:.1f} s waiting",
                      job.elapsed_s, job.working_s, job.most_at_a_time, job.waiting_s);
  if (job.merge_s > 0.0) text += fmt::format(", and {:.1f} s taking the results", job.merge_s);
  text += fmt::format("; {:.3g} units/s\n", job.units_per_s());
  for (const auto& [why, count] : job.losses) text += fmt::format("  lost: {} × {}\n", count, why);
  for (const auto& [why, count] : job.failures) text += fmt::format("  failed: {} × {}\n", count, why);
  return text;
}

}  // namespace mbk::batch
