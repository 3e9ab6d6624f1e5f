#include "mbk/batch/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <optional>
#include <set>
#include <span>
#include <system_error>
#include <thread>

#include "mbk/base/system/files.h"
#include "mbk/base/system/process.h"
#include "mbk/batch/merge.h"
#include "mbk/batch/shard.h"
#include "mbk/batch/work.h"
#include "mbk/files/contents/durable_files.h"

namespace mbk::batch {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Who looks after a job. The lock ends with its process, so that none is ever stale.
class Keeper {
 public:
  static Result<Keeper> take(const JobFolder& folder) {
    const fs::path file = folder.folder() / "keeper";
    Keeper keeper(system::create_or_open(file));
    if (!keeper.lock_) {
      return bad_data(fmt::format("cannot be locked: {}", std::generic_category().message(errno)),
                      "check the permissions of the folder", file.string());
    }
    // A program that a killed process was about to start holds its lock for a moment longer.
    bool taken = false;
    for (const auto begin = Clock::now(); !taken && seconds_since(begin) < 1.0;) {
      taken = system::try_lock(keeper.lock_, system::Lock::alone) == 0;
      if (!taken) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    if (!taken) {
      std::array<char, 256> text{};
      const auto got = system::read_some(keeper.lock_.number(), text.data(), text.size() - 1);
      return bad_data(fmt::format("another mbk is running this job{}{}", got > 0 ? ": " : "", text.data()),
                      "wait for it, or end it; running tasks continue", folder.folder().string());
    }
    const std::string who = fmt::format("process {} on {}", system::process_id(), system::host_name());
    if (system::cut(keeper.lock_, 0) == 0) {
      std::ignore = system::write_all(keeper.lock_.number(), std::as_bytes(std::span(who)));
    }
    return keeper;
  }

 private:
  explicit Keeper(system::OpenFile lock) : lock_(std::move(lock)) {}
  system::OpenFile lock_;
};

/// What is known of a chunk.
struct Known {
  bool finished = false, handed_out = false, given_up = false;
  int losses = 0;               ///< one after the other, without a unit done
  std::int64_t units_left = 0;  ///< done by processes that ended
  std::optional<Clock::time_point> gone_since;
  std::uintmax_t bytes = 0;  ///< of its shards that are not whole
  std::optional<Clock::time_point> grew;
};

class Run {
 public:
  Run(const JobFolder& folder, Engine& engine, const RunOptions& options, std::vector<Chunk> chunks)
      : folder_(folder), engine_(engine), options_(options), chunks_(std::move(chunks)), known_(chunks_.size()) {
    state_.chunks = folder.job().chunks;
    state_.units = folder.job().units;
  }

  Result<RunReport> to_end() {
    MBK_TRY(look());
    finished_before_ = state_.finished_units;
    cost_before_ = finished_cost_;
    while (true) {
      if (state_.finished == state_.chunks) return ended(RunEnd::finished);
      if (const Stop stop = options_.stop(); stop != Stop::no) {
        if (stop == Stop::leave && engine_.outlives()) return ended(RunEnd::detached);
        engine_.cancel_all();
        return ended(RunEnd::stopped);
      }
      MBK_TRY(hand_out());
      if (state_.finished + state_.given_up == state_.chunks) return ended(RunEnd::incomplete);
      if (options_.detach && answered_) return ended(RunEnd::detached);
      say();
      MBK_TRY(wait());
    }
  }

 private:
  /// Until the engine is asked again, which must not keep its controller busy. Shards are looked for more often, so
  /// that the end of a short job is seen soon.
  Result<void> wait() {
    constexpr double kAsked = 0.1, kLookedFor = 0.02, kShortest = 0.2;  // of what has elapsed; [s]
    const double elapsed_s = seconds_since(begin_), longest_s = engine_.interval_s();
    const auto pause_s = [&](double share) { return std::min(longest_s, std::max(kShortest, share * elapsed_s)); };
    const auto begin = Clock::now();
    do {
      std::this_thread::sleep_for(std::chrono::duration<double>(pause_s(kLookedFor)));
      MBK_TRY(look());
    } while (seconds_since(begin) < pause_s(kAsked) && state_.finished < state_.chunks && options_.stop() == Stop::no);
    return {};
  }

  /// What the shards say.
  Result<void> look() {
    const auto files = MBK_TRY(list_shards(folder_));
    std::map<std::int64_t, std::uintmax_t> parts;
    for (const ShardFile& file : files) {
      if (file.chunk < 0 || file.chunk >= state_.chunks) continue;
      Known& known = known_[static_cast<std::size_t>(file.chunk)];
      if (known.finished) continue;
      if (file.state == ShardFile::State::part) {
        std::error_code ignored;
        const auto bytes = fs::file_size(file.path, ignored);
        if (!ignored) parts[file.chunk] += bytes;
        continue;
      }
      const Chunk& chunk = chunks_[static_cast<std::size_t>(file.chunk)];
      const auto end = check_shard(folder_, chunk, file.path);
      if (!end) {
        fs::path aside = file.path;
        aside.replace_extension(kDamagedEnd);
        ++state_.losses[end.error().message];
        MBK_TRY(files::rename_on_disk(file.path, aside));
        continue;
      }
      known.finished = true;
      if (known.given_up) --state_.given_up;
      known.given_up = false;
      ++state_.finished;
      state_.finished_units += chunk.count;
      state_.failed_units += end->failed;
      finished_cost_ += chunk.expected_s;
    }
    for (const auto& [chunk, bytes] : parts) {
      Known& known = known_[static_cast<std::size_t>(chunk)];
      if (known.bytes != bytes) known.grew = Clock::now();
      known.bytes = bytes;
    }
    return {};
  }

  /// Hands out what nobody does.
  Result<void> hand_out() {
    const auto alive = engine_.alive();
    answered_ = alive.has_value();
    state_.trouble = alive ? "" : alive.error().line();
    if (!alive) return {};  // the chunks go on; their shards come without it
    std::vector<std::int64_t> missing, silent;
    state_.running = state_.waiting = 0;
    for (std::size_t k = 0; k < known_.size(); ++k) {
      Known& known = known_[k];
      const auto number = static_cast<std::int64_t>(k);
      const auto found = alive->find(number);
      if (known.finished || known.given_up) continue;
      if (found != alive->end()) {
        known.handed_out = true;
        known.gone_since.reset();
        ++(found->second.running ? state_.running : state_.waiting);
        if (!found->second.why.empty()) state_.trouble = "tasks wait: " + found->second.why;
        if (!found->second.running) {
          known.grew.reset();
        } else if (!known.grew) {
          known.grew = Clock::now();
        } else if (seconds_since(*known.grew) > options_.silence_s) {
          silent.push_back(number);
          known.grew.reset();
        }
      } else if (!known.handed_out) {
        missing.push_back(number);
      } else if (!known.gone_since) {
        known.gone_since = Clock::now();  // its shard may have come between the two looks, or be on its way
      } else if (seconds_since(*known.gone_since) >= engine_.settle_s()) {
        known.gone_since.reset();
        lose(known, number, missing);
      }
    }
    if (!silent.empty()) {
      engine_.cancel(silent);
      state_.losses[fmt::format("silent for {:g} s", options_.silence_s)] += std::ssize(silent);
    }
    if (too_many_losses()) {
      engine_.cancel_all();
      return bad_data(fmt::format("every process ended without a result: {}", most_frequent_loss()),
                      fmt::format("read the logs in {}", folder_.logs().string()), folder_.folder().string());
    }
    if (missing.empty()) return {};
    MBK_TRY(engine_.submit(missing));
    for (const std::int64_t number : missing) {
      Known& known = known_[static_cast<std::size_t>(number)];
      known.handed_out = true;
      known.grew.reset();
    }
    return {};
  }

  void lose(Known& known, std::int64_t number, std::vector<std::int64_t>& missing) {
    if (!engine_.was_begun(number)) {
      missing.push_back(number);
      return;
    }
    ++losses_;
    const std::int64_t left = units_left_done(folder_, chunks_[static_cast<std::size_t>(number)]);
    known.losses = left > known.units_left ? 0 : known.losses + 1;
    known.units_left = left;
    something_done_ = something_done_ || left > 0;
    const std::string why = engine_.why_ended(number);
    ++state_.losses[why.empty() ? "ended without a result" : why];
    if (known.losses >= options_.attempts) {
      known.given_up = true;
      ++state_.given_up;
    } else {
      missing.push_back(number);
    }
  }

  /// Where nothing at all comes of it, trying on only fills the log.
  bool too_many_losses() const {
    constexpr std::int64_t kMany = 12;
    return losses_ >= kMany && !something_done_ && state_.finished_units == finished_before_;
  }

  std::string most_frequent_loss() const {
    return std::ranges::max_element(state_.losses, {}, [](const auto& one) { return one.second; })->first;
  }

  void estimate() {
    state_.elapsed_s = seconds_since(begin_);
    const std::int64_t units = state_.finished_units - finished_before_;
    const double cost = finished_cost_ - cost_before_;
    double left = 0.0;
    for (std::size_t k = 0; k < known_.size(); ++k) {
      if (!known_[k].finished && !known_[k].given_up) left += chunks_[k].expected_s;
    }
    state_.units_per_s = state_.elapsed_s > 0.0 ? static_cast<double>(units) / state_.elapsed_s : 0.0;
    state_.left_s = cost > 0.0 ? left * state_.elapsed_s / cost : 0.0;
  }

  void say() {
    if (seconds_since(said_) < 1.0) return;
    said_ = Clock::now();
    write_down();
  }

  void write_down() {
    estimate();
    options_.progress(state_);
    std::ofstream(folder_.folder() / "progress.jsonl", std::ios::app) << to_json(state_) << "\n";
  }

  RunReport ended(RunEnd how) {
    state_.running = how == RunEnd::detached ? state_.running : 0;
    write_down();
    return {how, state_};
  }

  const JobFolder& folder_;
  Engine& engine_;
  const RunOptions& options_;
  std::vector<Chunk> chunks_;
  std::vector<Known> known_;
  JobState state_;
  bool answered_ = false, something_done_ = false;
  std::int64_t losses_ = 0;
  double finished_cost_ = 0.0, cost_before_ = 0.0;
  std::int64_t finished_before_ = 0;
  Clock::time_point begin_ = Clock::now(), said_ = Clock::now();
};

}  // namespace

std::string to_text(const JobState& state) {
  std::string text =
      fmt::format("{} of {} chunks, {} of {} units", state.finished, state.chunks, state.finished_units, state.units);
  if (state.failed_units > 0) text += fmt::format(" ({} failed)", state.failed_units);
  if (state.running + state.waiting > 0) text += fmt::format("; {} running, {} waiting", state.running, state.waiting);
  if (state.units_per_s > 0.0) text += fmt::format("; {:.3g} units/s", state.units_per_s);
  if (state.left_s > 0.0 && state.finished < state.chunks) text += fmt::format("; {:.0f} s left", state.left_s);
  std::int64_t losses = 0;
  for (const auto& [why, count] : state.losses) losses += count;
  if (losses > 0) text += fmt::format("; {} lost and restarted", losses - state.given_up);
  if (state.given_up > 0) text += fmt::format("; {} chunks given up", state.given_up);
  if (!state.trouble.empty()) text += "; " + state.trouble;
  return text;
}

Result<RunReport> run(const JobFolder& folder, Engine& engine, const RunOptions& options) {
  MBK_TRY(folder.check_program());
  MBK_TRY(Keeper::take(folder));
  auto chunks = MBK_TRY(folder.chunks());
  return Run(folder, engine, options, std::move(chunks)).to_end();
}

Result<JobState> state_of(const JobFolder& folder) {
  const auto chunks = MBK_TRY(folder.chunks());
  const auto files = MBK_TRY(list_shards(folder));
  JobState state;
  state.chunks = folder.job().chunks;
  state.units = folder.job().units;
  std::set<std::int64_t> whole, part;
  for (const ShardFile& file : files) {
    if (file.chunk >= 0 && file.chunk < state.chunks) {
      (file.state == ShardFile::State::whole ? whole : part).insert(file.chunk);
    }
  }
  for (const std::int64_t number : whole) {
    state.finished_units += chunks[static_cast<std::size_t>(number)].count;
    part.erase(number);
  }
  state.finished = std::ssize(whole);
  state.running = std::ssize(part);
  state.waiting = state.chunks - state.finished - state.running;
  return state;
}

}  // namespace mbk::batch
