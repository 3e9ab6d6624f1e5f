// Chunks handed out by the first rank of a run of Open MPI (apps/mbk_mpi).
#include <fmt/format.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): SIGTERM

#include <algorithm>
#include <fstream>
#include <optional>
#include <set>
#include <thread>

#include "mbk/batch/child_process.h"
#include "mbk/batch/engines.h"
#include "mbk/batch/merge.h"

namespace mbk::batch {
namespace {

namespace fs = std::filesystem;

class MpiEngine : public Engine {
 public:
  MpiEngine(const JobFolder& folder, const EngineOptions& options)
      : folder_(folder),
        options_(options),
        tasks_(options.tasks > 0 ? options.tasks
                                 : std::max<int>(static_cast<int>(std::thread::hardware_concurrency()), 1)) {}

  Result<std::int64_t> max_chunks() override { return kMaxChunks; }

  Result<void> submit(std::span<const std::int64_t> chunks) override {
    if (process_) {  // those that a run lost are handed out by the next
      waiting_.insert(chunks.begin(), chunks.end());
      return {};
    }
    return start({chunks.begin(), chunks.end()});
  }

  Result<std::map<std::int64_t, Alive>> alive() override {
    if (process_) {
      code_ = process_->wait(0.0);
      note_shards();
      if (code_) {
        process_.reset();
        handed_out_.clear();
      }
    }
    if (!process_ && !waiting_.empty()) {
      MBK_TRY(start(std::exchange(waiting_, {})));
    }
    std::map<std::int64_t, Alive> all;
    // The first rank gives the chunks away in this order, as soon as the ranks are there: so those that are not whole
    // are in somebody's hands, as many as there are ranks to work, whether or not a process has come to begin its
    // shard.
    int in_hand = begun_.empty() ? 0 : tasks_;
    for (const std::int64_t chunk : handed_out_) {
      const bool held = !whole_.contains(chunk) && in_hand-- > 0;
      all[chunk] = {held || begun_.contains(chunk), ""};
    }
    for (const std::int64_t chunk : waiting_) all[chunk] = {};
    return all;
  }

  void cancel(std::span<const std::int64_t> chunks) override {
    bool running = false;
    for (const std::int64_t chunk : chunks) running = waiting_.erase(chunk) == 0 || running;
    if (!running || !process_) return;
    // A rank cannot be reached from here. What the others have done of their chunks is taken over.
    process_->send(SIGTERM);
    if (!process_->wait(kEndsWithin)) process_->send(SIGKILL);
  }

  void cancel_all() override {
    waiting_.clear();
    if (!process_) return;
    process_->send(SIGTERM);
    std::ignore = process_->wait(kEndsWithin);
    process_.reset();
    handed_out_.clear();
  }

  std::string why_ended(std::int64_t /*chunk*/) override {
    if (code_ && *code_ != 0) return "mpirun: " + why_of_process(*code_, log());
    return last_line(log());
  }

  bool was_begun(std::int64_t chunk) const override { return begun_.empty() || begun_.contains(chunk); }
  double interval_s() const override { return 0.1; }
  double settle_s() const override { return 0.0; }

 private:
  static constexpr double kEndsWithin = 10.0;  // [s]

  /// The chunks of which this run has begun a shard, and those that are done.
  void note_shards() {
    const auto files = list_shards(folder_);
    if (!files) return;
    for (const ShardFile& file : *files) {
      if (!before_.contains(file.path.stem())) begun_.insert(file.chunk);
      if (file.state == ShardFile::State::whole) whole_.insert(file.chunk);
    }
  }

  fs::path log() const { return folder_.logs() / fmt::format("mpirun-{}.txt", runs_); }

  Result<void> start(const std::set<std::int64_t>& chunks) {
    ++runs_;
    before_.clear();
    begun_.clear();
    whole_.clear();
    const auto files = MBK_TRY(list_shards(folder_));
    for (const ShardFile& file : files) before_.insert(file.path.stem());
    const fs::path list = folder_.folder() / fmt::format("mpi-{}.txt", runs_);
    std::ofstream stream(list, std::ios::trunc);
    for (const std::int64_t chunk : chunks) stream << chunk << "\n";
    stream.close();
    if (!stream) return bad_data("cannot be written", "check the disk and the folder", list.string());
    std::vector<std::string> command = {"mpirun", "-n", std::to_string(tasks_ + 1)};
    command.insert(command.end(), {"--bind-to", "none"});
    // The first rank only waits, so that one more than there are cores is no harm.
    if (options_.extra.empty()) command.emplace_back("--oversubscribe");
    command.insert(command.end(), options_.extra.begin(), options_.extra.end());
    command.push_back((options_.program.parent_path() / "mbk_mpi").string());
    command.push_back(list.string());
    for (const std::string& word : work_command(folder_, options_)) command.push_back(word);
    auto process = MBK_TRY(ChildProcess::start(command, log()));
    process_.emplace(std::move(process));
    code_.reset();
    handed_out_ = chunks;
    return {};
  }

  const JobFolder& folder_;
  EngineOptions options_;
  int tasks_, runs_ = 0;
  std::optional<ChildProcess> process_;
  std::optional<int> code_;
  std::set<std::int64_t> handed_out_, waiting_, begun_, whole_;
  std::set<fs::path> before_;  ///< names of shards, without their ends, that were there when it began
};

}  // namespace

Result<std::unique_ptr<Engine>> make_mpi_engine(const JobFolder& folder, const EngineOptions& options) {
  std::error_code ignored;
  const fs::path program = options.program.parent_path() / "mbk_mpi";
  if (!fs::exists(program, ignored)) {
    return bad_usage(fmt::format("{} is not there", program.string()),
                     "install the package mbk-mpi, or build mbk where libopenmpi-dev is installed");
  }
  return std::make_unique<MpiEngine>(folder, options);
}

}  // namespace mbk::batch
