#include "mbk/experiment/session/conduct.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "mbk/files/recording/read.h"
#include "mbk/simulate/laboratory/simulation.h"

namespace mbk::session {
namespace {

using protocol::Trial;
using safety::MotorsOff;
using safety::Reason;
using testing::ElementsAre;
using testing::HasSubstr;

namespace fs = std::filesystem;

/// Two trials of ten seconds, named "first" and "second".   @param more  keys of the first
std::string experiment_text(const std::string& more = "") {
  return R"(
[robot]
handle_mass_kg = 0.194
[session]
soft_start_s = 0.3
shortest_move_s = 0.3
settle_s = 0.1
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = 10
moving_in_s = 2
[participant]
kind = "arm"
number = 1
[[trial]]
name = "first"
)" + more +
         R"(
[[trial]]
name = "second"
)";
}

/// The person does more than the perturbation brings about.
constexpr const char* kDrowned = "[trial.perturbation]\npeak_deg = 0.1\n[trial.participant.remnant]\nfloor_N = 1\n";

/// What happened, and answers that were given beforehand.
class Script : public Operator {
 public:
  /// Seen with the ticks of each attempt.
  std::function<void(const Attempt&, std::span<const journal::Tick>)> watched;
  /// What comes next; empty: as nobody decides.
  std::function<Next(Session&, const Performed&)> answer;

  std::vector<std::string> recordings, told;
  std::vector<bool> poor;
  std::optional<MotorsOff::State> motors_state;
  std::uint64_t ticks = 0;

  std::unique_ptr<Watcher> begin(const Attempt& attempt) override {
    told.push_back("begin " + attempt.plan.trial.name);
    return std::make_unique<Seeing>(*this, attempt);
  }
  void motors(const MotorsOff& motors) override {
    told.emplace_back("motors");
    motors_state = motors.state;
  }
  void recorded(const session::TrialOutcome& outcome) override {
    told.emplace_back("recorded");
    recordings.push_back(outcome.recording.filename().string());
  }
  Result<void> judged(const Performed& performed) override {
    told.emplace_back(performed.measured ? "measured" : "not measured");
    poor.push_back(performed.poor());
    return {};
  }
  Next next(Session& session, const Performed& performed) override {
    told.emplace_back("next");
    return answer ? answer(session, performed) : Operator::next(session, performed);
  }

 private:
  class Seeing : public Watcher {
   public:
    Seeing(Script& script, const Attempt& attempt) : script_(script), attempt_(attempt) {}
    Seeing(const Seeing&) = delete;
    Seeing& operator=(const Seeing&) = delete;
    ~Seeing() override { script_.told.emplace_back("at rest"); }
    void watch(std::span<const journal::Tick> came) override {
      script_.ticks += came.size();
      if (script_.watched) script_.watched(attempt_, came);
    }

   private:
    Script& script_;
    const Attempt& attempt_;
  };
};

class Conducted : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              (std::string("mbk_conduct_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::vector<Trial> trials(const std::string& text = experiment_text()) {
    auto read = protocol::read_experiment(text, "experiment.toml", laboratory::read_simulation);
    EXPECT_TRUE(read) << read.error().line();
    return read.value();
  }

  [[nodiscard]] Experiment planned(const std::vector<Trial>& trials) const {
    auto experiment = plan_experiment(trials, folder_ / "p07.h5", "experiment.toml");
    EXPECT_TRUE(experiment) << experiment.error().line();
    return experiment.value();
  }

  fs::path folder_;
  Session session_{session::Pace{true, 0.0}};
  Script script_;
};

TEST_F(Conducted, TrialsArePerformedInTheirOrderRecordedAndMeasured) {
  const Conclusion conclusion = conduct(planned(trials()), session_, script_);
  EXPECT_TRUE(conclusion.completed);
  EXPECT_FALSE(conclusion.failure);
  EXPECT_EQ(conclusion.trip.reason, Reason::none);
  EXPECT_THAT(script_.told, ElementsAre("begin first", "at rest", "motors", "recorded", "measured", "next",  //
                                        "begin second", "at rest", "motors", "recorded", "measured", "next"));
  EXPECT_THAT(script_.recordings, ElementsAre("p07_first.h5", "p07_second.h5"));
  EXPECT_THAT(script_.poor, ElementsAre(false, false));
  EXPECT_EQ(script_.motors_state, MotorsOff::State::confirmed);
  Index samples = 0;
  for (const std::string& name : script_.recordings) samples += recording::read(folder_ / name, {})->samples();
  EXPECT_EQ(static_cast<Index>(script_.ticks), samples);
}

TEST_F(Conducted, PoorDataAreNoticedAndARepeatedTrialGetsANameOfItsOwn) {
  script_.answer = [attempts = 0](Session&, const Performed& performed) mutable {
    return performed.poor() && ++attempts < 3 ? Next::repeat : Next::go_on;
  };
  const Conclusion conclusion = conduct(planned(trials(experiment_text(kDrowned))), session_, script_);
  EXPECT_TRUE(conclusion.completed);
  EXPECT_THAT(script_.recordings, ElementsAre("p07_first.h5", "p07_first_2.h5", "p07_first_3.h5", "p07_second.h5"));
  EXPECT_THAT(script_.poor, ElementsAre(true, true, true, false));
}

TEST_F(Conducted, ARepeatedTrialIsTheSameTrial) {
  script_.answer = [attempts = 0](Session&, const Performed&) mutable {
    return ++attempts < 2 ? Next::repeat : Next::end;
  };
  const Conclusion conclusion = conduct(planned(trials()), session_, script_);
  EXPECT_FALSE(conclusion.completed);
  EXPECT_FALSE(conclusion.failure);
  ASSERT_THAT(script_.recordings, ElementsAre("p07_first.h5", "p07_first_2.h5"));
  const auto one = recording::read(folder_ / "p07_first.h5", {}),
             other = recording::read(folder_ / "p07_first_2.h5", {});
  EXPECT_EQ(one->find("hand_x")->values, other->find("hand_x")->values);  // the plan was left as it was made
}

TEST_F(Conducted, WhatCannotBeMeasuredIsPoor) {
  const Measure never = [](const Recording&) -> Result<Measurement> { return bad_data("the fit failed"); };
  EXPECT_TRUE(conduct(planned(trials()), session_, script_, never).completed);
  EXPECT_THAT(script_.poor, ElementsAre(true, true));
}

TEST_F(Conducted, WhoeverMeasuresGetsThePerturbationAndWhatTheTrialSaysOfItself) {
  const Measure looking = [](const Recording& recording) -> Result<Measurement> {
    EXPECT_EQ(recording.metadata.at("handle_mass_kg"), "0.194");
    EXPECT_NEAR(recording.time[recording.samples() - 1] - recording.time[0], 10.0, 0.01);  // of the trial's 11.3 s
    return bad_data("only looked at");
  };
  EXPECT_TRUE(conduct(planned(trials()), session_, script_, looking).completed);
}

TEST_F(Conducted, ANoteOfTheTrialIsInTheFileThatWasMeasured) {
  class Noting : public Operator {
    std::vector<std::string> notes() override { return {"the chair moved"}; }
  } noting;
  std::string measured;
  const Measure looking = [&](const Recording& recording) -> Result<Measurement> {
    measured = recording.sources.front().sha256;
    return bad_data("only looked at");
  };
  EXPECT_TRUE(conduct(planned({trials().front()}), session_, noting, looking).completed);
  const auto there = recording::read(folder_ / "p07.h5", {});
  EXPECT_EQ(there->metadata.at("notes"), "the chair moved");
  EXPECT_EQ(there->sources.front().sha256, measured);  // nobody wrote it again
}

TEST_F(Conducted, WithoutAMeasureTrialsAreOnlyRecorded) {
  EXPECT_TRUE(conduct(planned(trials(experiment_text(kDrowned))), session_, script_, {}).completed);
  EXPECT_EQ(std::ranges::count(script_.told, "not measured"), 2);
  EXPECT_THAT(script_.poor, ElementsAre(false, false));
}

TEST_F(Conducted, AfterAStopOfTheOperatorNoTrialFollowsAndNothingIsMeasured) {
  script_.watched = [&](const Attempt&, std::span<const journal::Tick> ticks) {
    if (ticks.back().time > 2.0) session_.flags().operator_stop = true;
  };
  const Conclusion conclusion = conduct(planned(trials()), session_, script_);
  EXPECT_FALSE(conclusion.completed);
  EXPECT_FALSE(conclusion.failure);
  EXPECT_EQ(conclusion.trip.reason, Reason::operator_stop);
  EXPECT_EQ(conclusion.motors.state, MotorsOff::State::confirmed);
  EXPECT_THAT(script_.told, ElementsAre("begin first", "at rest", "motors", "recorded", "not measured", "next"));
  EXPECT_EQ(recording::read(folder_ / "p07_first.h5", {})->metadata.at("ended"), "safety stop");
}

TEST_F(Conducted, AStoppedTrialIsRepeatedOnceTheGateIsReset) {
  bool stopped = false;
  script_.watched = [&](const Attempt&, std::span<const journal::Tick> ticks) {
    if (stopped || ticks.back().time < 2.0) return;
    stopped = true;
    session_.flags().operator_stop = true;
  };
  script_.answer = [](Session& session, const Performed& performed) {
    return performed.stopped() && session.reset() ? Next::repeat : Next::go_on;
  };
  const Conclusion conclusion = conduct(planned(trials()), session_, script_);
  EXPECT_TRUE(conclusion.completed);
  EXPECT_EQ(conclusion.trip.reason, Reason::none);
  EXPECT_THAT(script_.recordings, ElementsAre("p07_first.h5", "p07_first_2.h5", "p07_second.h5"));
}

TEST_F(Conducted, WithoutAResetNoTrialFollowsAStop) {
  script_.watched = [&](const Attempt&, std::span<const journal::Tick>) { session_.flags().operator_stop = true; };
  script_.answer = [](Session&, const Performed&) { return Next::go_on; };
  const Conclusion conclusion = conduct(planned(trials()), session_, script_);
  ASSERT_TRUE(conclusion.failure);
  EXPECT_THAT(conclusion.failure->line(), HasSubstr("the gate is tripped"));
  EXPECT_FALSE(fs::exists(folder_ / "p07_second.h5"));
}

TEST_F(Conducted, ARequestToEndIsObeyedBeforeATrialAndAfterIt) {
  script_.watched = [&](const Attempt&, std::span<const journal::Tick>) { session_.flags().end_session = true; };
  const Experiment experiment = planned(trials());
  EXPECT_FALSE(conduct(experiment, session_, script_).completed);
  EXPECT_THAT(script_.told, ElementsAre("begin first", "at rest", "motors", "recorded", "not measured"));
  script_.told.clear();
  EXPECT_FALSE(conduct(experiment, session_, script_).completed);
  EXPECT_TRUE(script_.told.empty());
}

TEST_F(Conducted, NoTrialFollowsOneWhoseTicksWereLost) {
  bool done = false;
  script_.watched = [&](const Attempt& attempt, std::span<const journal::Tick> ticks) {
    if (done || ticks.back().time < 3.0) return;
    std::fstream stream(session::journal_of(attempt.target), std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(100'000);
    stream << "damage";
    done = stream.good();
  };
  const Conclusion conclusion = conduct(planned(trials()), session_, script_, {});
  ASSERT_TRUE(conclusion.failure);
  EXPECT_EQ(conclusion.failure->kind, ErrorKind::data);
  EXPECT_THAT(conclusion.failure->line(), HasSubstr("ticks were lost"));
  EXPECT_THAT(script_.told, ElementsAre("begin first", "at rest", "motors", "recorded", "not measured"));
}

TEST_F(Conducted, AFailureOfWhoeverIsToldIsTheLastWord) {
  class Full : public Operator {
    Result<void> judged(const Performed&) override { return bad_data("the disk is full"); }
  } full;
  const Conclusion conclusion = conduct(planned(trials()), session_, full, {});
  ASSERT_TRUE(conclusion.failure);
  EXPECT_EQ(conclusion.failure->message, "the disk is full");
  EXPECT_FALSE(fs::exists(folder_ / "p07_second.h5"));
}

/// A robot that says that its motors are on, whatever it is told.
class StuckOn : public device::Device {
 public:
  explicit StuckOn(std::unique_ptr<device::Device> inner) : inner_(std::move(inner)) {}
  [[nodiscard]] const device::Facts& facts() const override { return inner_->facts(); }
  [[nodiscard]] Result<void> start() override { return inner_->start(); }
  bool read(device::State& state) noexcept override {
    const bool fine = inner_->read(state);
    state.motors = device::Motors::on;
    return fine;
  }
  bool write(const device::Command& command) noexcept override { return inner_->write(command); }
  void stop() noexcept override { inner_->stop(); }

 private:
  std::unique_ptr<device::Device> inner_;
};

class SimulatesStuckOn : public protocol::Simulation {
 public:
  [[nodiscard]] Result<std::unique_ptr<device::Device>> robot(const Trial& trial) const override {
    return std::unique_ptr<device::Device>(std::make_unique<StuckOn>(laboratory::simulated_robot(of(trial)).value()));
  }
  [[nodiscard]] std::map<std::string, std::string> metadata(const Trial& trial) const override {
    return inner_->metadata(trial);
  }
  explicit SimulatesStuckOn(std::shared_ptr<const protocol::Simulation> inner) : inner_(std::move(inner)) {}

 private:
  [[nodiscard]] Trial of(Trial trial) const {
    trial.simulation = inner_;
    return trial;
  }
  std::shared_ptr<const protocol::Simulation> inner_;
};

TEST_F(Conducted, MotorsThatStayOnAreToldAtOnceAndConcludeTheExperiment) {
  std::vector<Trial> stuck = trials();
  for (Trial& trial : stuck) trial.simulation = std::make_shared<SimulatesStuckOn>(trial.simulation);
  const Conclusion conclusion = conduct(planned(stuck), session_, script_);
  EXPECT_EQ(conclusion.motors.state, MotorsOff::State::missing);
  EXPECT_EQ(conclusion.trip.reason, Reason::motors_on);
  EXPECT_EQ(script_.motors_state, MotorsOff::State::missing);
  EXPECT_THAT(script_.told, ElementsAre("begin first", "at rest", "motors", "recorded", "not measured", "next"));
}

TEST_F(Conducted, NothingBeginsWhereATrialBreaksALimitOrItsRecordingIsThere) {
  const auto refusal = [&](const std::vector<Trial>& trials) {
    const auto experiment = plan_experiment(trials, folder_ / "p07.h5", "study.toml");
    EXPECT_FALSE(experiment);
    return experiment ? std::string() : experiment.error().line();
  };
  EXPECT_THAT(refusal(trials(experiment_text("[trial.safety]\nspeed_mm_per_s = 20\n"))),
              testing::AllOf(HasSubstr("study.toml"), HasSubstr("speed_mm_per_s")));
  std::ofstream(folder_ / "p07_second.h5") << "a recording";
  EXPECT_THAT(refusal(trials()), HasSubstr("p07_second.h5"));
}

TEST_F(Conducted, ATrialIsRecordedUnderTheNameThatWasGivenOrTheProtocols) {
  const std::vector<Trial> both = trials();
  EXPECT_EQ(planned({both.front()}).target(0), folder_ / "p07.h5");
  EXPECT_EQ(planned(both).target(1), folder_ / "p07_second.h5");
  Experiment unnamed = planned({both.front()});
  unnamed.out.clear();
  EXPECT_EQ(unnamed.target(0), "experiment.h5");
  EXPECT_EQ(next_free(folder_ / "a.b.h5"), folder_ / "a.b.h5");
  for (const char* name : {"a.b.h5", "a.b_2.h5"}) std::ofstream(folder_ / name) << "a recording";
  EXPECT_EQ(next_free(folder_ / "a.b.h5"), folder_ / "a.b_3.h5");
}

TEST(TrialMeasurement, AModelIsPoorWhereAnAxisIsExplainedByLessThanHalf) {
  Identification identification;
  identification.usable = true;
  identification.fit.vaf = Eigen::Vector2d(99.0, 50.0);
  EXPECT_FALSE(poor(identification));
  identification.fit.vaf[1] = 49.9;
  EXPECT_TRUE(poor(identification));
  identification.fit.vaf[1] = 99.0;
  identification.usable = false;
  EXPECT_TRUE(poor(identification));
}

}  // namespace
}  // namespace mbk::session
