#include "mbk/batch/job_events.h"

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

namespace mbk::batch {
namespace {

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::filesystem::path events_file(const JobFolder& folder) {
  return folder.folder() / "events.jsonl";
}

}  // namespace

std::vector<JobEvent> job_events(const JobFolder& folder) {
  std::vector<JobEvent> events;
  std::ifstream stream(events_file(folder));
  for (std::string line; std::getline(stream, line);) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (!json.is_object()) continue;  // of a process that was killed while it wrote
    const auto kind = value_of<EventKind>(json.value("is", std::string()));
    if (!kind) continue;
    events.push_back({*kind, json.value("at_s", 0.0), json.value("chunk", std::int64_t{-1}),
                      json.value("why", std::string()), json.value("took_s", 0.0)});
  }
  return events;
}

JobEventWriter::JobEventWriter(const JobFolder& folder) : file_(events_file(folder)), begin_s_(steady_s()) {
  const auto events = job_events(folder);
  if (!events.empty()) {
    before_s_ = events.back().at_s;
    waiting_ = "\n";  // behind a line that was not finished
  }
}

double JobEventWriter::now_s() const {
  return before_s_ + steady_s() - begin_s_;
}

void JobEventWriter::add(EventKind kind, std::int64_t chunk, const std::string& why, double took_s) {
  nlohmann::ordered_json json = {{"at_s", now_s()}, {"is", word_of(kind)}};
  if (chunk >= 0) json["chunk"] = chunk;
  if (!why.empty()) json["why"] = why;
  if (took_s > 0.0) json["took_s"] = took_s;
  waiting_ += json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void JobEventWriter::flush() {
  if (waiting_.empty()) return;
  std::ofstream(file_, std::ios::app) << waiting_;
  waiting_.clear();
}

void note_merged(const JobFolder& folder, double took_s) {
  JobEventWriter events(folder);
  events.add(EventKind::merged, -1, "", took_s);
  events.flush();
}

}  // namespace mbk::batch
