#include "mbk/experiment/console/live_estimate.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>

#include "mbk/base/realtime/rest.h"
#include "mbk/base/realtime/signal_stack.h"
#include "mbk/measure/preprocess/perturbation_only.h"
#include "mbk/model/trial/recording.h"

namespace mbk::console {
namespace {

constexpr auto kInterval = std::chrono::seconds(1);
constexpr double kShortest = 2.0;      // of a perturbation worth a look [s]
constexpr double kRecent = 5.0;        // that tell of the limb as it is now, once it has changed [s]
constexpr double kChange = 0.3;        // of stiffness or damping, by norm, from which it changed
constexpr double kBeyondChance = 8.0;  // standard errors: each second of each trial asks, of four elements
constexpr int kNiceness = 10;

double perturbed(const journal::Journal& journal) {
  const auto last = std::find_if(journal.ticks.rbegin(), journal.ticks.rend(),
                                 [](const journal::Tick& tick) { return tick.perturbing(); });
  return last == journal.ticks.rend() ? 0.0 : last->perturbation_time;
}

/// While a perturbation goes on, the last samples have no reading of their own yet where the sensor's comes later.
void cut_unread(Recording& recording, int latency) {
  const Index samples = std::max<Index>(0, recording.samples() - latency);
  recording.time.conservativeResize(samples);
  for (Channel& channel : recording.channels) channel.values.conservativeResize(samples);
}

/// By more than chance, and by enough to matter. What the fit of all so far holds back at its end, a change there above
/// all, its own tests of constant stiffness and damping do not see.
bool differs(const Identification& now, const Identification& all, Matrix impedance::Model::*part) {
  const Matrix &recent = now.model.*part, &whole = all.model.*part;
  const Matrix difference = recent - whole;
  const Matrix chance =
      ((now.standard_error.*part).array().square() + (all.standard_error.*part).array().square()).sqrt();
  return difference.norm() > kChange * whole.norm() &&
         (difference.array().abs() > kBeyondChance * chance.array()).any();
}

bool warns_of(const Identification& id, WarningCode code) {
  return std::ranges::find(id.warnings, code, &Warning::code) != id.warnings.end();
}

/// The perturbation in it, as far as its readings have come.
Result<Recording> perturbation_of(const journal::Journal& journal) {
  auto recording = MBK_TRY(journal::to_recording(journal));
  const auto holds = [&](const char* name) {
    return std::ranges::find(recording.events, name, &Event::name) != recording.events.end();
  };
  if (holds("trigger")) {
    return bad_data("a hand that reaches has no M, B and K about one place", "'mbk explore' measures the recording");
  }
  if (!holds("perturbation_start")) return bad_data("nothing was perturbed yet", "wait for the perturbation");
  if (!holds("perturbation_end")) cut_unread(recording, journal.header.force_latency);
  return preprocess::perturbation_only(std::move(recording));
}

}  // namespace

Result<Measurement> estimate(const journal::Journal& journal, const measurement::Options& options) {
  const auto perturbation = MBK_TRY(perturbation_of(journal));
  return measurement::measure({&perturbation, 1}, options);
}

Result<Recent> estimate_now(const journal::Journal& journal, const measurement::Options& options) {
  const auto perturbation = MBK_TRY(perturbation_of(journal));
  auto whole = MBK_TRY(measurement::measure({&perturbation, 1}, options));
  const double from = perturbed(journal) - kRecent;
  if (from < kRecent) return Recent{0.0, std::move(whole)};
  measurement::Options last = options;
  last.preprocess.window.from_s = from;
  auto recent = measurement::measure({&perturbation, 1}, last);
  if (!recent) return Recent{0.0, std::move(whole)};
  const Identification& all = whole.identification;
  Identification& now = recent->identification;
  const auto say = [&](const char* what, WarningCode code, Matrix impedance::Model::*part) {
    if (!warns_of(all, code) && !differs(now, all, part)) return false;
    if (!warns_of(now, code)) {
      now.warnings.push_back({code,
                              fmt::format("the {} changed: M, B and K are those of the last {:g} s", what, kRecent),
                              "ask for the same state throughout, or measure the parts with --from and --to"});
    }
    return true;
  };
  const bool stiffness = say("stiffness", WarningCode::stiffness_changes, &impedance::Model::K);
  const bool damping = say("damping", WarningCode::damping_changes, &impedance::Model::B);
  if (!stiffness && !damping) return Recent{0.0, std::move(whole)};
  return Recent{from, std::move(*recent)};
}

LiveEstimate::LiveEstimate(std::function<void(const Estimate&)> done)
    : done_(std::move(done)), thread_([this] { run(); }) {}

LiveEstimate::~LiveEstimate() {
  {
    const std::scoped_lock lock(mutex_);
    over_ = true;
  }
  thread_.join();
}

void LiveEstimate::begin(journal::Header header, measurement::Options options) {
  std::unique_lock lock(mutex_);
  finished_.wait(lock, [&] { return !busy_; });
  journal_ = {std::move(header), {}, {}, {}};
  incoming_.clear();
  options_ = std::move(options);
  options_.passivity = false;
  running_ = true;
  finishing_ = false;
}

void LiveEstimate::add(std::span<const journal::Tick> ticks) {
  const std::scoped_lock lock(mutex_);
  if (running_) incoming_.insert(incoming_.end(), ticks.begin(), ticks.end());
}

void LiveEstimate::finish() {
  std::unique_lock lock(mutex_);
  if (!running_) return;
  finishing_ = true;
  finished_.wait(lock, [&] { return !running_; });
}

void LiveEstimate::look(std::span<const journal::Tick> came, bool final) noexcept {
  double seen = 0.0;
  const auto give_up = [&](const char* why) {
    done_({final, seen, 0.0, bad_data(fmt::format("not estimated: {}", why), "the recording can be measured later")});
  };
  try {
    try {
      journal_.ticks.insert(journal_.ticks.end(), came.begin(), came.end());
      seen = perturbed(journal_);
      if (seen < kShortest) {
        if (final) done_({final, seen, 0.0, bad_data(fmt::format("the perturbation went on for {:.1f} s only", seen))});
      } else if (final) {
        done_({final, seen, 0.0, estimate(journal_, options_)});
      } else if (!came.empty() && came.back().perturbing()) {
        auto now = estimate_now(journal_, options_);
        const double from = now ? now->from : 0.0;
        done_({final, seen, from, std::move(now).map([](Recent&& one) { return std::move(one.measured); })});
      }
    } catch (const std::exception& error) {
      give_up(error.what());
    }
  } catch (...) {  // it cannot be said either: the last estimate stays
  }
}

void LiveEstimate::make(std::unique_lock<std::mutex>& lock, bool final) noexcept {
  std::vector<journal::Tick> came;
  came.swap(incoming_);
  busy_ = true;
  lock.unlock();
  look(came, final);
  lock.lock();
  busy_ = false;
}

void LiveEstimate::run() noexcept {
  const realtime::SignalStack stack;
  // a thread of Linux has a priority of its own; where it is refused, nothing is lost
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness);
  const auto is_called = [&] {
    const std::scoped_lock lock(mutex_);
    return over_ || finishing_;
  };
  while (true) {
    realtime::rest(kInterval, is_called);
    std::unique_lock lock(mutex_);
    if (over_) break;
    if (!running_) continue;
    const bool final = finishing_;
    make(lock, final);
    if (final) running_ = finishing_ = false;
    finished_.notify_all();
  }
  const std::scoped_lock lock(mutex_);
  running_ = false;
  finished_.notify_all();
}

}  // namespace mbk::console
