#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/journal/journal.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/model/trial/measurement.h"

namespace mbk::console {

/// What `mbk measure` makes of the perturbation in a journal, as far as it has come, across missed ticks.
/// @fails  data: nothing was perturbed yet; as journal::to_recording and measurement::measure.
[[nodiscard]] Result<Measurement> estimate(const journal::Journal& journal, const measurement::Options& options);

/// What a trial that still runs shows of the limb as it is now.
struct Recent {
  double from = 0.0;  ///< time of the perturbation from which it counts [s]; 0 where the limb did not change
  Measurement measured;
};

/// `estimate` of all ticks so far, or, where the last five seconds have another stiffness or damping (8 standard errors
/// of the difference of an element, and 30 % of K or B by norm), or that of all warns of a change, of those five
/// seconds with the warning stiffness-changes or damping-changes: a mean over two states of the limb is that of
/// neither.
/// @fails  as `estimate`
[[nodiscard]] Result<Recent> estimate_now(const journal::Journal& journal, const measurement::Options& options);

/// M, B, K of a trial while it runs: about once a second `estimate_now`, by a thread of its own that every other goes
/// before. The last one, `estimate` of the whole trial, is the one of its recording.
class LiveEstimate {
 public:
  struct Estimate {
    bool final = false;      ///< of the whole trial
    double perturbed = 0.0;  ///< time of the perturbation that it saw [s]
    double from = 0.0;       ///< and from which on it counts [s]
    Result<Measurement> measured;
  };

  /// @param done  called from the thread with each estimate; where one cannot be made for want of memory, with that
  explicit LiveEstimate(std::function<void(const Estimate&)> done);
  LiveEstimate(const LiveEstimate&) = delete;
  LiveEstimate& operator=(const LiveEstimate&) = delete;
  ~LiveEstimate();

  /// A trial begins; what was there is forgotten.
  void begin(journal::Header header, measurement::Options options);

  /// From the recorder's thread: takes a copy.
  void add(std::span<const journal::Tick> ticks);

  /// No more ticks will come: returns after the last estimate, the final one.
  void finish();

 private:
  void run() noexcept;
  void make(std::unique_lock<std::mutex>& lock, bool final) noexcept;
  void look(std::span<const journal::Tick> came, bool final) noexcept;

  std::function<void(const Estimate&)> done_;
  std::mutex mutex_;
  std::condition_variable finished_;
  std::vector<journal::Tick> incoming_;
  journal::Journal journal_;  // of the thread, and of `begin` while that rests
  measurement::Options options_;
  bool running_ = false, finishing_ = false, over_ = false, busy_ = false;
  std::thread thread_;
};

}  // namespace mbk::console
