#include "mbk/experiment/session/session.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <semaphore>
#include <stdexcept>
#include <thread>

#include "mbk/experiment/session/plan.h"
#include "mbk/experiment/session/recorder.h"
#include "mbk/files/recording/read.h"
#include "mbk/files/recording/write.h"
#include "mbk/simulate/laboratory/simulation.h"
#include "tests/support/allocations.h"

namespace mbk::session {
namespace session_test {

using protocol::read_experiment;
using protocol::Trial;

namespace fs = std::filesystem;

constexpr const char* kExperiment = R"(
[recording]
condition = "relaxed"
[robot]
handle_mass_kg = 0.194
[control]
kind = "position"
[perturbation]
kind = "multisine"
duration_s = 6
moving_in_s = 2
[participant]
kind = "arm"
number = 1
[person]
number = 7
age_years = 31
handedness = "right"
consent = "C-12"
)";

class SessionFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              (std::string("mbk_session_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    target_ = folder_ / "trial.h5";
  }
  void TearDown() override { fs::remove_all(folder_); }

  static Trial trial(std::string_view text = kExperiment) {
    auto trials = read_experiment(text, "experiment.toml", laboratory::read_simulation);
    EXPECT_TRUE(trials) << trials.error().line();
    return trials->front();
  }

  static Plan planned(const Trial& trial) {
    auto plan = make_plan(trial);
    EXPECT_TRUE(plan) << plan.error().line();
    return *plan;
  }

  static constexpr Pace kFast{true, 0.0};
  static inline const RecoverOptions kKeep{.keep = true};
  fs::path folder_, target_;
};

TEST_F(SessionFolder, RecordsATrialFromBeginningToEnd) {
  const Trial t = trial();
  auto robot = laboratory::simulated_robot(t).value();
  Session session(kFast);
  std::uint64_t watched = 0;
  const auto outcome = session.perform(*robot, planned(t), target_,
                                       [&](std::span<const journal::Tick> ticks) { watched += ticks.size(); });
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->ended, "completed");
  EXPECT_EQ(outcome->ending.dropped, 0U);
  EXPECT_EQ(watched, outcome->times.ticks);
  EXPECT_FALSE(fs::exists(outcome->journal));
  const auto recording = recording::read(target_, {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(static_cast<std::uint64_t>(recording->samples()), outcome->times.ticks);
  EXPECT_EQ(recording->metadata.at("participant"), "7");
  EXPECT_EQ(recording->metadata.at("consent"), "C-12");
  EXPECT_EQ(recording->metadata.at("ended"), "completed");
  EXPECT_NE(recording->find("torque_2"), nullptr);
}

TEST_F(SessionFolder, AStopOfTheOperatorTripsAndStaysUntilReset) {
  const Trial t = trial();
  auto robot = laboratory::simulated_robot(t).value();
  Session session(kFast);
  const auto outcome = session.perform(*robot, planned(t), target_, [&](std::span<const journal::Tick> ticks) {
    if (ticks.back().time > 1.5) session.flags().operator_stop = true;
  });
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->trip.reason, safety::Reason::operator_stop);
  const auto recording = recording::read(target_, {});
  EXPECT_EQ(recording->metadata.at("ended"), "safety stop");
  EXPECT_NE(recording->metadata.at("ended_detail").find("operator"), std::string::npos);
  const Vector& torque = recording->find("torque_1")->values;
  EXPECT_EQ(torque[torque.size() - 1], 0.0);

  auto second = laboratory::simulated_robot(t).value();
  const auto refused = session.perform(*second, planned(t), folder_ / "second.h5");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find("reset"), std::string::npos);
  ASSERT_TRUE(session.reset());
  EXPECT_TRUE(session.perform(*second, planned(t), folder_ / "second.h5"));
}

TEST_F(SessionFolder, AWatchThatThrowsIsNotCalledAgainAndTheRecordingGoesOn) {
  const Trial t = trial();
  for (const bool known : {true, false}) {
    auto robot = laboratory::simulated_robot(t).value();
    Session session(kFast);
    int calls = 0;
    const fs::path target = folder_ / (known ? "known.h5" : "unknown.h5");
    const auto outcome = session.perform(*robot, planned(t), target, [&](std::span<const journal::Tick>) {
      if (++calls < 3) return;
      if (known) throw std::runtime_error("the screen is broken");
      throw 3;
    });
    ASSERT_TRUE(outcome) << outcome.error().line();
    EXPECT_EQ(calls, 3);
    EXPECT_EQ(outcome->ended, "completed");
    EXPECT_EQ(outcome->trip.reason, safety::Reason::none);
    EXPECT_EQ(outcome->ending.detail.find("the screen is broken") != std::string::npos, known);
    const auto recording = recording::read(target, {});
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_EQ(static_cast<std::uint64_t>(recording->samples()), outcome->times.ticks);
    if (known) {
      EXPECT_NE(recording->metadata.at("ended_detail").find("the screen is broken"), std::string::npos);
    }
  }
}

TEST_F(SessionFolder, AWatchThatIsStuckHoldsUpNoRecordingAndWhatItDidNotSeeIsSaid) {
  constexpr std::uint64_t kTicks = 3000, kRing = 1024;
  const fs::path file = folder_ / "trial.journal";
  auto writer = journal::Writer::create(file, journal::Header{}, kTicks);
  ASSERT_TRUE(writer) << writer.error().line();
  realtime::BoundedRing<journal::Tick> ring(kRing);
  LoopFlags flags;
  std::binary_semaphore let_go{0};
  std::uint64_t seen = 0;
  const auto watch = [&](std::span<const journal::Tick> ticks) {
    if (seen == 0) let_go.acquire();
    seen += ticks.size();
  };
  Recorder recorder(ring, std::move(*writer), flags, watch, /*in_real_time=*/true);

  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::seconds(20);  // for what comes at once, or never
  const auto soon = [&] { return std::chrono::steady_clock::now() < deadline; };
  for (std::uint64_t number = 0; number < kTicks && soon(); std::this_thread::yield()) {
    if (ring.room() == 0) continue;
    journal::Tick tick;
    tick.number = number++;
    tick.time = 1e-3 * static_cast<double>(tick.number);
    ring.push(tick);
  }
  const auto in_the_file = [&] {
    const auto journal = journal::read(file);
    return journal ? journal->ticks.size() : 0;
  };
  while (in_the_file() < kTicks && soon()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(in_the_file(), kTicks);
  EXPECT_TRUE(flags.recording);

  let_go.release();
  const auto ended = recorder.finish({.ticks = kTicks});
  ASSERT_TRUE(ended) << ended.error().line();
  EXPECT_EQ(ended->dropped, 0U);
  EXPECT_GE(seen, kRing);
  EXPECT_LT(seen, kTicks);
  EXPECT_NE(ended->detail.find(fmt::format("{} ticks", kTicks - seen)), std::string::npos) << ended->detail;
}

TEST_F(SessionFolder, EndsEarlyWhenAsked) {
  const Trial t = trial();
  auto robot = laboratory::simulated_robot(t).value();
  Session session(kFast);
  const auto outcome = session.perform(*robot, planned(t), target_, [&](std::span<const journal::Tick> ticks) {
    if (ticks.back().time > 4.0) session.flags().end_trial = true;
  });
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->ended, "ended early by the operator");
  EXPECT_EQ(outcome->trip.reason, safety::Reason::none);
}

TEST_F(SessionFolder, BeginsNothingThatItWouldHaveToRegret) {
  Trial t = trial();
  auto robot = laboratory::simulated_robot(t).value();
  const auto refusal = [&](const Trial& one) {
    const auto plan = make_plan(one);
    if (!plan) return plan.error().line();
    Session session(kFast);
    const auto outcome = session.perform(*robot, *plan, target_);
    EXPECT_FALSE(outcome);
    return outcome ? std::string() : outcome.error().line();
  };
  t.person.withdrawn = true;
  EXPECT_NE(refusal(t).find("withdrawn"), std::string::npos);
  t = trial();
  t.limits.handle_force = 0.0;
  EXPECT_NE(refusal(t).find("handle_force_N"), std::string::npos);
  t = trial();
  t.home = {2.0, 0.0};
  EXPECT_NE(refusal(t).find("home"), std::string::npos);
  EXPECT_FALSE(fs::exists(journal_of(target_)));
  t = trial();
  {
    Session session(kFast);
    ASSERT_TRUE(session.perform(*robot, planned(t), target_));
  }
  EXPECT_NE(refusal(t).find(target_.filename().string()), std::string::npos);
}

/// A robot on the real clock that a test can disturb.
class DisturbedDevice : public device::Device {
 public:
  explicit DisturbedDevice(device::Device& inner) : inner_(&inner), facts_(inner.facts()) { facts_.keeps_time = true; }
  [[nodiscard]] const device::Facts& facts() const override { return facts_; }
  [[nodiscard]] Result<void> start() override { return inner_->start(); }
  bool read(device::State& state) noexcept override {
    const bool fine = inner_->read(state);
    state.stop = button;
    if (stuck_on) state.motors = device::Motors::on;
    return fine;
  }
  bool write(const device::Command& command) noexcept override {
    if (command.tick == stall_at) std::this_thread::sleep_for(std::chrono::milliseconds(300));
    commands_off += command.enabled ? 0 : 1;
    return inner_->write(command);
  }
  void stop() noexcept override { inner_->stop(); }

  std::atomic<bool> button{false}, stuck_on{false};
  std::atomic<int> commands_off{0};
  std::uint64_t stall_at = std::numeric_limits<std::uint64_t>::max();

 private:
  device::Device* inner_;
  device::Facts facts_;
};

/// The machine may be late by itself; what is looked at is a stall of 300 ms behind the clock's look at the time.
TEST_F(SessionFolder, AStallInsideATickIsLate) {
  Trial t = trial();
  t.limits.lateness = 0.25;
  t.limits.link_silence = 1.0;
  t.limits.state_age = 0.0;
  auto robot = laboratory::simulated_robot(t).value();
  DisturbedDevice device(*robot);
  device.stall_at = 200;
  Session session;
  const auto outcome = session.perform(device, planned(t), target_);
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->trip.reason, safety::Reason::late) << safety::sentence(outcome->trip);
  EXPECT_GE(outcome->trip.value, 0.29);
  EXPECT_GE(outcome->times.interval.worst(), 290'000'000);
}

TEST_F(SessionFolder, ATrialWhoseMotorsStayOnIsNotCompleted) {
  const Trial t = trial();
  auto robot = laboratory::simulated_robot(t).value();
  DisturbedDevice device(*robot);
  device.stuck_on = true;
  realtime::VirtualClock clock(1e-3, 40.0);
  Session session({true, 0.0, &clock});
  const auto outcome = session.perform(device, planned(t), target_);
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->trip.reason, safety::Reason::motors_on);
  EXPECT_EQ(outcome->motors.state, safety::MotorsOff::State::missing);
  EXPECT_EQ(outcome->ending.how, journal::Ending::How::safety_stop);
  const auto recording = recording::read(target_, {});
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->metadata.at("trip"), "motors-on");
  EXPECT_NE(recording->metadata.at("motors_off").find("NOT CONFIRMED OFF"), std::string::npos);

  EXPECT_FALSE(session.reset()) << "while the motors may be on";
  const auto until_reset = [&] {
    for (int i = 0; i < 200; ++i) {
      if (session.reset()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  };
  const IdleWatch idle(device, [&](const IdleState& seen) { session.see_idle(seen); });
  device.stuck_on = false;
  EXPECT_TRUE(until_reset());
  EXPECT_GT(device.commands_off, 500);  // "off" is said all the while
}

TEST_F(SessionFolder, AStopButtonThatIsReleasedBetweenTrialsLetsResetThrough) {
  const Trial t = trial();
  auto robot = laboratory::simulated_robot(t).value();
  DisturbedDevice device(*robot);
  realtime::VirtualClock clock(1e-3, 40.0);
  Session session({true, 0.0, &clock});
  const auto outcome = session.perform(device, planned(t), target_, [&](std::span<const journal::Tick> ticks) {
    if (ticks.back().time > 1.0) device.button = true;
  });
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->trip.reason, safety::Reason::stop_button);
  std::atomic<int> pressed{0}, released{0};
  const IdleWatch idle(device, [&](const IdleState& seen) {
    session.see_idle(seen);
    ++(seen.stop_button ? pressed : released);
  });
  const auto wait_for = [](const std::atomic<int>& count) {
    for (int i = 0; i < 200 && count == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return count > 0;
  };
  ASSERT_TRUE(wait_for(pressed));
  const auto refused = session.reset();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find("stop button"), std::string::npos);
  device.button = false;
  ASSERT_TRUE(wait_for(released));
  EXPECT_TRUE(session.reset());
}

TEST_F(SessionFolder, NothingBeginsWhileTheStopButtonIsPressed) {
  const Trial t = trial();
  auto robot = laboratory::simulated_robot(t).value();
  DisturbedDevice device(*robot);
  device.button = true;
  Session session;
  const auto refused = session.perform(device, planned(t), target_);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find("stop button"), std::string::npos) << refused.error().line();
  EXPECT_FALSE(fs::exists(journal_of(target_)));
}

TEST_F(SessionFolder, AnUnfinishedJournalIsRecovered) {
  const Trial t = trial();
  {
    auto writer = journal::Writer::create(journal_of(target_), journal::Header{}, 10).value();
    std::vector<journal::Tick> ticks(500);
    for (std::size_t i = 0; i < ticks.size(); ++i) ticks[i].time = 1e-3 * static_cast<double>(ticks[i].number = i);
    ASSERT_TRUE(writer.append(ticks));
  }
  const auto recovered = recover(journal_of(target_), target_);
  ASSERT_TRUE(recovered) << recovered.error().line();
  EXPECT_EQ(recovered->recording.samples(), 500);
  EXPECT_TRUE(recovered->removed);
  EXPECT_EQ(recording::read(target_, {})->metadata.at("ended"), "interrupted");
  EXPECT_FALSE(fs::exists(journal_of(target_)));
}

TEST_F(SessionFolder, RecoversAsOftenAsOneLikesAndReplacesNothingElse) {
  const auto write_journal = [&](double first) {
    fs::remove(journal_of(target_));
    auto writer = journal::Writer::create(journal_of(target_), journal::Header{}, 10).value();
    std::vector<journal::Tick> ticks(50);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      ticks[i].number = i;
      ticks[i].time = first + 1e-3 * static_cast<double>(i);
    }
    ASSERT_TRUE(writer.append(ticks));
  };
  write_journal(0.0);
  ASSERT_TRUE(recover(journal_of(target_), target_, kKeep));
  const auto made = fs::last_write_time(target_);
  EXPECT_TRUE(recover(journal_of(target_), target_, kKeep));
  EXPECT_EQ(fs::last_write_time(target_), made);
  write_journal(0.5);
  const auto refused = recover(journal_of(target_), target_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::usage);
  EXPECT_EQ(fs::last_write_time(target_), made);
  EXPECT_TRUE(fs::exists(journal_of(target_)));
}

/// A journal of 500 ticks in ten blocks; the fourth is damaged.
void write_damaged_journal(const fs::path& file) {
  {
    auto writer = journal::Writer::create(file, journal::Header{}, 10).value();
    std::vector<journal::Tick> ticks(500);
    for (std::size_t i = 0; i < ticks.size(); ++i) ticks[i].time = 1e-3 * static_cast<double>(ticks[i].number = i);
    for (std::size_t i = 0; i < ticks.size(); i += 50) ASSERT_TRUE(writer.append(std::span(ticks).subspan(i, 50)));
    ASSERT_TRUE(writer.end({journal::Ending::How::completed, "", 0, 0, 500}));
  }
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  stream.seekp(static_cast<std::streamoff>(fs::file_size(file) / 3));
  stream << "damage";
}

TEST_F(SessionFolder, AJournalThatLostTicksIsKeptAndItsRecordingSaysSo) {
  write_damaged_journal(journal_of(target_));
  const auto recovered = recover(journal_of(target_), target_);
  ASSERT_TRUE(recovered) << recovered.error().line();
  EXPECT_TRUE(recovered->incomplete);
  EXPECT_FALSE(recovered->removed);
  EXPECT_EQ(recovered->ticks, 450U);
  EXPECT_TRUE(fs::exists(journal_of(target_)));
  const auto recording = recording::read(target_, {});
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->samples(), 500);
  EXPECT_EQ(recording->metadata.at("ended"), "completed, but 50 of 500 ticks were lost");
  EXPECT_EQ(recording->metadata.at("ticks_lost"), "50");
  EXPECT_EQ(recording->find("hand_x")->values.array().isNaN().count(), 50);
  const auto made = fs::last_write_time(target_);  // NaN compares unequal to itself; the recording is still the same
  ASSERT_TRUE(recover(journal_of(target_), target_));
  EXPECT_EQ(fs::last_write_time(target_), made);
}

TEST_F(SessionFolder, ARecordingThatDiffersInOneRowOfNaNIsNotTheSame) {
  write_damaged_journal(journal_of(target_));
  ASSERT_TRUE(recover(journal_of(target_), target_));
  Recording changed = recording::read(target_, {}).value();
  for (Channel& channel : changed.channels) channel.values[7] = std::nan("");
  ASSERT_TRUE(recording::write(changed, target_, recording::Format::hdf5, true));
  const auto refused = recover(journal_of(target_), target_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::usage);
}

TEST_F(SessionFolder, WhatASessionWritesIsForItsOwnerUnlessAskedOtherwise) {
  for (const Readers readers : {Readers::owner, Readers::all}) {
    Trial t = trial();
    t.readers = readers;
    auto robot = laboratory::simulated_robot(t).value();
    fs::remove(target_);
    Session session(kFast);
    std::atomic<unsigned> seen{0};
    const auto outcome = session.perform(*robot, planned(t), target_, [&](std::span<const journal::Tick>) {
      seen = static_cast<unsigned>(fs::status(journal_of(target_)).permissions());
      session.flags().end_trial = true;
    });
    ASSERT_TRUE(outcome) << outcome.error().line();
    EXPECT_EQ(seen & 0777U, permissions(readers));
    EXPECT_EQ(static_cast<unsigned>(fs::status(target_).permissions()) & 0777U, permissions(readers));
    ASSERT_TRUE(annotate(target_, {"a note"}));
    EXPECT_EQ(static_cast<unsigned>(fs::status(target_).permissions()) & 0777U, permissions(readers));
  }
}

/// In real time: the recorder looks after its file once a second.
TEST_F(SessionFolder, AJournalThatIsRemovedOrReplacedStopsTheTrialAndLosesNothing) {
  for (const bool replaced : {false, true}) {
    const Trial t = trial();
    auto robot = laboratory::simulated_robot(t).value();
    fs::remove(target_);
    Session session({.virtual_clock = true, .speed = 1.0});
    std::uint64_t watched = 0;
    bool done = false;
    const auto outcome = session.perform(*robot, planned(t), target_, [&](std::span<const journal::Tick> ticks) {
      watched += ticks.size();
      if (done || ticks.back().time < 0.3) return;
      done = fs::remove(journal_of(target_));
      if (replaced) std::ofstream(journal_of(target_)) << "another file";
    });
    ASSERT_TRUE(outcome) << outcome.error().line();
    EXPECT_EQ(outcome->trip.reason, safety::Reason::recording_failed);
    EXPECT_NE(outcome->ending.detail.find(".journal"), std::string::npos) << outcome->ending.detail;
    EXPECT_FALSE(outcome->incomplete);
    const auto recording = recording::read(target_, {});
    ASSERT_TRUE(recording);
    EXPECT_EQ(static_cast<std::uint64_t>(recording->samples()), outcome->times.ticks);
    EXPECT_EQ(watched, outcome->times.ticks);
    EXPECT_FALSE(fs::exists(folder_ / "trial_saved.h5.journal"));
    EXPECT_EQ(fs::exists(journal_of(target_)), replaced);
    fs::remove(journal_of(target_));
  }
}

/// The disk gives something else back than was written.
TEST_F(SessionFolder, ATrialWhoseJournalIsDamagedWhileItRunsIsNotCompleted) {
  const Trial t = trial();
  auto robot = laboratory::simulated_robot(t).value();
  Session session(kFast);
  bool done = false;
  const auto outcome = session.perform(*robot, planned(t), target_, [&](std::span<const journal::Tick> ticks) {
    if (done || ticks.back().time < 3.0) return;
    std::fstream stream(journal_of(target_), std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(100'000);
    stream << "damage";
    done = stream.good();
  });
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_TRUE(outcome->incomplete);
  EXPECT_TRUE(outcome->ended.starts_with("completed, but ")) << outcome->ended;
  EXPECT_TRUE(fs::exists(outcome->journal));
  const auto recording = recording::read(target_, {});
  ASSERT_TRUE(recording);
  EXPECT_EQ(static_cast<std::uint64_t>(recording->samples()), outcome->times.ticks);
  EXPECT_EQ(recording->metadata.at("ended"), outcome->ended);
}

TEST(ExperimentFile, RefusesNames) {
  for (const char* key : {"name", "initials"}) {
    const std::string text = std::string(kExperiment) + key + " = \"Ann\"\n";
    const auto trials = read_experiment(text, "experiment.toml", laboratory::read_simulation);
    ASSERT_FALSE(trials);
    EXPECT_NE(trials.error().line().find(key), std::string::npos);
    EXPECT_NE(trials.error().line().find("line 20"), std::string::npos) << trials.error().line();
  }
}

TEST(ExperimentFile, EveryReadyPlanarScenarioIsAnExperiment) {
  for (const laboratory::ReadyScenario& one : laboratory::ready_scenarios()) {
    const auto trials = read_experiment(one.text, std::string(one.name) + ".toml", laboratory::read_simulation);
    if (trials) {
      for (const Trial& trial : *trials) EXPECT_TRUE(make_plan(trial)) << one.name;
    } else {
      const std::string said = trials.error().line();
      EXPECT_TRUE(said.find("one-axis") != std::string::npos || said.find("in space") != std::string::npos) << said;
    }
  }
}

/// Counts what the loop's thread allocates between its first and its last tick.
class CountingDevice : public device::Device {
 public:
  enum class Plant { nothing, object, matrix };
  CountingDevice(device::Device& inner, Plant plant) : inner_(&inner), plant_(plant) {}
  [[nodiscard]] const device::Facts& facts() const override { return inner_->facts(); }
  [[nodiscard]] Result<void> start() override { return inner_->start(); }
  bool read(device::State& state) noexcept override {
    if (++reads_ == 2) first_ = testing_support::allocations();  // the first one is before the loop, in another thread
    return inner_->read(state);
  }
  bool write(const device::Command& command) noexcept override {
    if (command.tick == 1000 && plant_ == Plant::object) object_ = std::make_unique<int>(3);
    if (command.tick == 1000 && plant_ == Plant::matrix) matrix_.resize(3, 3);
    const bool fine = inner_->write(command);
    last_ = testing_support::allocations();
    return fine;
  }
  void stop() noexcept override { inner_->stop(); }
  [[nodiscard]] long counted() const { return last_ - first_; }

 private:
  device::Device* inner_;
  Plant plant_;
  std::unique_ptr<int> object_;
  Eigen::MatrixXd matrix_;
  int reads_ = 0;
  long first_ = 0, last_ = 0;
};

TEST_F(SessionFolder, TheLoopDoesNotAllocateWhileItIsRecordedAndAPlantedAllocationIsSeen) {
  using Plant = CountingDevice::Plant;
  for (const Plant plant : {Plant::nothing, Plant::object, Plant::matrix}) {
    const Trial t = trial();
    auto robot = laboratory::simulated_robot(t).value();
    CountingDevice counting(*robot, plant);
    fs::remove(target_);
    Session session(kFast);
    const auto outcome = session.perform(counting, planned(t), target_);
    ASSERT_TRUE(outcome) << outcome.error().line();
    EXPECT_EQ(outcome->ended, "completed") << outcome->ending.detail;
    EXPECT_GT(outcome->times.ticks, 9000U);
    EXPECT_EQ(counting.counted(), plant == Plant::nothing ? 0 : 1);
  }
}

/// A trip on the way down neither allocates.
TEST_F(SessionFolder, ATripDoesNotAllocate) {
  const Trial t = trial();
  auto robot = laboratory::simulated_robot(t).value();
  CountingDevice counting(*robot, CountingDevice::Plant::nothing);
  Session session(kFast);
  const auto outcome = session.perform(counting, planned(t), target_, [&](std::span<const journal::Tick> ticks) {
    if (ticks.back().time > 1.5) session.flags().operator_stop = true;
  });
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->trip.reason, safety::Reason::operator_stop);
  EXPECT_EQ(counting.counted(), 0);
}

/// Memory of this process now [MiB].
double resident() {
  std::ifstream pages("/proc/self/statm");
  double all = 0.0, here = 0.0;
  pages >> all >> here;
  return here * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// Two minutes; MBK_SESSION_SECONDS=3600 makes it an hour, as with the thread sanitizer.
TEST_F(SessionFolder, MemoryStaysFlatAndNothingIsDropped) {
  const char* const asked = std::getenv("MBK_SESSION_SECONDS");
  const int seconds = asked != nullptr ? std::max(120, std::atoi(asked)) : 120;
  std::string text = kExperiment;
  text.replace(text.find("duration_s = 6"), 14, fmt::format("duration_s = {}", seconds));
  const Trial t = trial(text);
  auto robot = laboratory::simulated_robot(t).value();
  Session session(kFast);
  double early = 0.0, late = 0.0;
  const auto outcome = session.perform(*robot, planned(t), target_, [&](std::span<const journal::Tick> ticks) {
    if (early == 0.0 && ticks.back().time > 20.0) early = resident();
    if (ticks.back().time > seconds - 5.0) late = resident();
  });
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->ending.dropped, 0U);
  EXPECT_GT(late, 0.0);
  EXPECT_LT(late - early, 4.0);  // MiB; what was recorded between the two are 13
}

}  // namespace session_test
}  // namespace mbk::session
