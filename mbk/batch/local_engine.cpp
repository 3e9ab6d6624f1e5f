// Chunks as processes on this machine, so many at a time.
#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <thread>

#include "mbk/base/system/child_process.h"
#include "mbk/batch/engines.h"

namespace mbk::batch {
namespace {

class LocalEngine : public Engine {
 public:
  LocalEngine(const JobFolder& folder, const EngineOptions& options)
      : folder_(folder),
        command_(work_command(folder, options)),
        tasks_(options.tasks > 0 ? static_cast<std::size_t>(options.tasks)
                                 : std::max<std::size_t>(std::thread::hardware_concurrency(), 1)) {
    // A chunk must not outlive whoever would start it again.
    command_.emplace_back("--with-parent");
  }

  Result<std::int64_t> max_chunks() override { return kMaxChunks; }

  Result<void> submit(std::span<const std::int64_t> chunks) override {
    waiting_.insert(waiting_.end(), chunks.begin(), chunks.end());
    return fill();
  }

  Result<std::map<std::int64_t, Alive>> alive() override {
    reap();
    MBK_TRY(fill());
    std::map<std::int64_t, Alive> all;
    for (const std::int64_t chunk : waiting_) all[chunk] = {};
    for (const auto& [chunk, process] : running_) all[chunk] = {true, ""};
    return all;
  }

  void cancel(std::span<const std::int64_t> chunks) override {
    for (const std::int64_t chunk : chunks) {
      std::erase(waiting_, chunk);
      const auto found = running_.find(chunk);
      if (found != running_.end()) found->second.send(system::Signal::kill);
    }
    reap();
  }

  void cancel_all() override {
    waiting_.clear();
    for (const auto& [chunk, process] : running_) process.send(system::Signal::terminate);
    for (auto& [chunk, process] : running_) std::ignore = process.wait(2.0);
    running_.clear();  // what still runs is killed
  }

  std::string why_ended(std::int64_t chunk) override {
    const auto found = ended_.find(chunk);
    return found == ended_.end() ? "" : why_of_process(found->second, log_of(chunk));
  }

  double interval_s() const override { return 0.02; }
  double settle_s() const override { return 0.0; }

 private:
  std::filesystem::path log_of(std::int64_t chunk) const { return folder_.logs() / fmt::format("{}.txt", chunk); }

  void reap() {
    for (auto at = running_.begin(); at != running_.end();) {
      const auto code = at->second.wait(0.0);
      if (code) ended_[at->first] = *code;
      at = code ? running_.erase(at) : std::next(at);
    }
  }

  Result<void> fill() {
    while (running_.size() < tasks_ && !waiting_.empty()) {
      const std::int64_t chunk = waiting_.front();
      std::vector<std::string> command = command_;
      command.push_back("--chunk");
      command.push_back(std::to_string(chunk));
      auto process = MBK_TRY(system::ChildProcess::start(command, log_of(chunk)));
      waiting_.pop_front();
      running_.emplace(chunk, std::move(process));
    }
    return {};
  }

  const JobFolder& folder_;
  std::vector<std::string> command_;
  std::size_t tasks_;
  std::deque<std::int64_t> waiting_;
  std::map<std::int64_t, system::ChildProcess> running_;
  std::map<std::int64_t, int> ended_;
};

}  // namespace

std::unique_ptr<Engine> make_local_engine(const JobFolder& folder, const EngineOptions& options) {
  return std::make_unique<LocalEngine>(folder, options);
}

}  // namespace mbk::batch
