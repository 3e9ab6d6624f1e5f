#include "mbk/experiment/console/console.h"

#include <gtest/gtest.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "mbk/experiment/console/page_operator.h"
#include "mbk/experiment/session/plan.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/preprocess/perturbation_only.h"
#include "mbk/present/result/json.h"
#include "mbk/simulate/laboratory/simulation.h"
#include "tests/support/schemas.h"

namespace mbk::console {
namespace console_test {

namespace beast = boost::beast;
namespace fs = std::filesystem;
namespace http = beast::http;
namespace net = boost::asio;
using net::ip::tcp;
using Json = nlohmann::json;
using namespace std::chrono_literals;

constexpr const char* kExperiment = R"(
[recording]
condition = "relaxed"
[robot]
handle_mass_kg = 0.194
[control]
kind = "position"
[perturbation]
kind = "multisine"
duration_s = 12
moving_in_s = 2
[participant]
kind = "arm"
number = 1
)";

/// Waits until it is so; false after ten seconds.
template <class Condition>
bool soon(const Condition& condition) {
  for (int k = 0; k < 1000; ++k) {
    if (condition()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

class ConsoleOfASession : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              (std::string("mbk_console_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    const auto trials = protocol::read_experiment(kExperiment, "experiment.toml", laboratory::read_simulation).value();
    for (const protocol::Trial& trial : trials) plans_.push_back(session::make_plan(trial).value());
    open_console();
  }
  void TearDown() override {
    console_.reset();
    fs::remove_all(folder_);
  }

  void open_console(ServerTimes times = {}) {
    console_ = Console::open(
                   0, plans_, session_.flags(),
                   [&](const std::string& line) {
                     const std::scoped_lock lock(mutex_);
                     log_.push_back(line);
                   },
                   times)
                   .value();
    const std::string address = console_->address();
    port_ = address.substr(17, address.find('/', 17) - 17);
    token_ = address.substr(address.find("token=") + 6);
    const std::string viewing = console_->viewing_address();
    viewing_token_ = viewing.substr(viewing.find("token=") + 6);
  }

  [[nodiscard]] std::string host() const { return "127.0.0.1:" + port_; }

  bool logged(std::string_view what) {
    const std::scoped_lock lock(mutex_);
    return std::ranges::any_of(log_, [&](const std::string& line) { return line.find(what) != std::string::npos; });
  }

  tcp::socket connected() {
    tcp::socket socket(context_);
    socket.connect({net::ip::address_v4::loopback(), static_cast<std::uint16_t>(std::stoi(port_))});
    return socket;
  }

  http::response<http::string_body> get(const std::string& target, const std::string& named = "",
                                        const std::string& origin = "") {
    tcp::socket socket = connected();
    http::request<http::empty_body> request(http::verb::get, target, 11);
    request.set(http::field::host, named.empty() ? host() : named);
    if (!origin.empty()) request.set(http::field::origin, origin);
    http::write(socket, request);
    beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(socket, buffer, response);
    return response;
  }

  /// A page as far as the server can tell.
  struct Page {
    beast::websocket::stream<tcp::socket, false> socket;
    Json you, state, session, texts, estimate, refused;
    std::size_t frames = 0;

    void tell(const std::string& message, bool text = true) {
      socket.text(text);
      socket.write(net::buffer(message));
    }
    void read() {
      beast::flat_buffer buffer;
      socket.read(buffer);
      if (!socket.got_text()) {
        ++frames;
        return;
      }
      const std::string text = beast::buffers_to_string(buffer.data());
      EXPECT_TRUE(schemas::fits(text, "console"));
      const Json message = Json::parse(text);
      const std::string type = message.at("type");
      const std::map<std::string, Json*> kinds = {{"you", &you},     {"state", &state},       {"session", &session},
                                                  {"texts", &texts}, {"estimate", &estimate}, {"refused", &refused}};
      *kinds.at(type) = message;
    }
    template <class Condition>
    bool read_until(const Condition& condition) {
      for (int k = 0; k < 5000; ++k) {
        if (condition(*this)) return true;
        read();
      }
      return false;
    }
  };

  /// That a page was told that control is there.
  static auto control(std::string_view where) {
    return [where](Page& page) { return page.you != Json() && page.you.at("control") == where; };
  }

  std::unique_ptr<Page> open(const std::string& token, const std::string& origin) {
    auto page = std::make_unique<Page>(Page{beast::websocket::stream<tcp::socket, false>(connected())});
    page->socket.set_option(beast::websocket::stream_base::decorator(
        [&](beast::websocket::request_type& request) { request.set(http::field::origin, origin); }));
    beast::error_code error;
    page->socket.handshake(host(), "/stream?token=" + token, error);
    if (error) return nullptr;
    return page;
  }
  std::unique_ptr<Page> open(const std::string& token) { return open(token, "http://" + host()); }

  session::TrialOutcome perform(session::Session& session, const fs::path& target) {
    const session::Plan& plan = plans_.front();
    auto robot = laboratory::simulated_robot(plan.trial).value();
    console_->begin(0, session::header_of(plan, robot->facts()), target, plan.sequence.duration(0.0));
    auto outcome = session.perform(*robot, plan, target, [&](auto ticks) { console_->watch(ticks); });
    EXPECT_TRUE(outcome) << outcome.error().line();
    console_->finish(*outcome);
    return *outcome;
  }

  fs::path folder_;
  session::Session session_{session::Pace{true, 0.0}};
  std::vector<session::Plan> plans_;
  std::unique_ptr<Console> console_;
  std::string port_, token_, viewing_token_;
  net::io_context context_;
  std::mutex mutex_;
  std::vector<std::string> log_;
};

TEST_F(ConsoleOfASession, ShowsItsPagesToWhoeverHasAToken) {
#ifndef MBK_WEB
  GTEST_SKIP() << "built without the page";
#endif
  for (const std::string& token : {token_, viewing_token_}) {
    for (const char* const path : {"/", "/participant"}) {
      const auto response = get(path + ("?token=" + token));
      EXPECT_EQ(response.result(), http::status::ok);
      EXPECT_NE(response.body().find("mbk console"), std::string::npos);
      const std::string policy(response["Content-Security-Policy"]);
      EXPECT_NE(policy.find("default-src 'none'; script-src 'sha256-"), std::string::npos) << policy;
      EXPECT_EQ(policy.find("unsafe"), std::string::npos) << policy;
      EXPECT_EQ(response[http::field::cache_control], "no-store");
    }
  }
  EXPECT_EQ(get("/elsewhere?token=" + token_).result(), http::status::not_found);
  EXPECT_EQ(get("/report/1?token=" + token_).result(), http::status::not_found);
  console_->show_report("<p>the report</p>");
  EXPECT_EQ(get("/report/1?token=" + token_).body(), "<p>the report</p>");
  for (const char* const path : {"/report/2", "/report/0", "/report/-1", "/report/1x", "/report/"}) {
    EXPECT_EQ(get(path + ("?token=" + token_)).result(), http::status::not_found) << path;
  }
}

TEST_F(ConsoleOfASession, RefusesAndLogsAWrongToken) {
  for (const std::string& token : {std::string(), std::string("0"), std::string(token_.size(), '0'), token_ + "0"}) {
    const auto response = get("/?token=" + token);
    EXPECT_EQ(response.result(), http::status::forbidden) << token;
    EXPECT_EQ(response.body().find("script"), std::string::npos);
    EXPECT_EQ(open(token), nullptr) << token;
  }
  EXPECT_EQ(get("/").result(), http::status::forbidden);
  EXPECT_TRUE(logged("'/stream'"));
  EXPECT_GE(console_->status().refused, 9U);
}

TEST_F(ConsoleOfASession, RefusesAndLogsForeignHostsAndOrigins) {
  EXPECT_EQ(get("/?token=" + token_, "evil.example:" + port_).result(), http::status::forbidden);
  EXPECT_TRUE(logged("'evil.example"));
  EXPECT_EQ(get("/?token=" + token_, "", "http://evil.example").result(), http::status::forbidden);
  for (const std::string& origin : {std::string("http://evil.example"), "https://" + host(), std::string("null"),
                                    std::string(), "http://" + host() + ".evil.example"}) {
    EXPECT_EQ(open(token_, origin), nullptr) << origin;
  }
  EXPECT_TRUE(logged("'http://evil.example'"));
  EXPECT_NE(open(token_, "http://localhost:" + port_), nullptr);
}

TEST_F(ConsoleOfASession, ListensOnThisMachineOnly) {
  // 127.0.0.2 is this machine too, and a socket on every address would answer there
  tcp::socket socket(context_);
  beast::error_code error;
  socket.connect({net::ip::make_address("127.0.0.2"), static_cast<std::uint16_t>(std::stoi(port_))}, error);
  EXPECT_TRUE(error);
}

TEST_F(ConsoleOfASession, APortThatIsTakenIsSaid) {
  const auto second =
      Console::open(static_cast<std::uint16_t>(std::stoi(port_)), plans_, session_.flags(), [](const std::string&) {});
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().line().find("--port"), std::string::npos);
}

TEST_F(ConsoleOfASession, TheFirstPageControlsAndTheNextTakesOver) {
  auto first = open(token_), second = open(token_), watching = open(viewing_token_);
  EXPECT_TRUE(first->read_until(control("here")));
  EXPECT_TRUE(second->read_until(control("elsewhere")));
  EXPECT_TRUE(watching->read_until(control("elsewhere")));
  EXPECT_EQ(second->you.at("may_control"), true);
  EXPECT_EQ(watching->you.at("may_control"), false);

  for (Page* page : {second.get(), watching.get()}) {
    page->tell(R"({"command":"note","text":"mine"})");
    EXPECT_TRUE(page->read_until([](Page& one) { return !one.refused.is_null(); }));
  }
  EXPECT_TRUE(logged("'note'"));
  EXPECT_TRUE(console_->take_notes().empty());
  first.reset();
  EXPECT_TRUE(second->read_until(control("here")));
  second.reset();
  EXPECT_TRUE(soon([&] { return !console_->status().controlled; }));
  EXPECT_TRUE(watching->read_until(control("nobody")));
  EXPECT_EQ(console_->status().viewers, 1);
}

TEST_F(ConsoleOfASession, EveryPageCanStop) {
  auto first = open(token_), second = open(token_), watching = open(viewing_token_);
  EXPECT_TRUE(watching->read_until(control("elsewhere")));
  for (Page* page : {first.get(), second.get(), watching.get()}) {
    session_.flags().operator_stop = false;
    page->tell(R"({"command":"stop"})");
    EXPECT_TRUE(soon([&] { return session_.flags().operator_stop.load(); }));
  }
}

TEST_F(ConsoleOfASession, APageWithTheOperatorsTokenTakesControl) {
  auto first = open(token_), second = open(token_), watching = open(viewing_token_);
  EXPECT_TRUE(first->read_until(control("here")));
  watching->tell(R"({"command":"control"})");
  EXPECT_TRUE(soon([&] { return logged("'control'"); }));
  second->tell(R"({"command":"control"})");
  EXPECT_TRUE(second->read_until(control("here")));
  EXPECT_TRUE(first->read_until(control("elsewhere")));
  first->tell(R"({"command":"note","text":"mine"})");
  EXPECT_TRUE(first->read_until([](Page& one) { return !one.refused.is_null(); }));
  second->tell(R"({"command":"note","text":"mine"})");
  EXPECT_TRUE(soon([&] { return console_->take_notes().size() == 1; }));
}

TEST_F(ConsoleOfASession, APageThatIsLoadedAgainKeepsControl) {
  auto first = open(token_ + "&page=1"), second = open(token_ + "&page=2");
  EXPECT_TRUE(first->read_until(control("here")));
  first.reset();
  EXPECT_TRUE(second->read_until(control("kept")));
  EXPECT_TRUE(console_->status().controlled);
  auto again = open(token_ + "&page=1");
  EXPECT_TRUE(again->read_until(control("here")));
  EXPECT_TRUE(second->read_until(control("elsewhere")));
  again.reset();
  EXPECT_TRUE(second->read_until(control("kept")));
  second->tell(R"({"command":"control"})");  // need not wait
  EXPECT_TRUE(second->read_until(control("here")));
}

TEST_F(ConsoleOfASession, WhatIsExcludedIsShownAndTakenOnceWithItsWindows) {
  auto page = open(token_);
  page->tell(R"({"command":"exclude","attempt":1,"text":"coughed"})");
  EXPECT_TRUE(page->read_until([](Page& one) { return !one.refused.is_null(); }));
  EXPECT_NE(page->refused.at("why").get<std::string>().find("trial"), std::string::npos);
  const auto outcome = perform(session_, folder_ / "trial.h5");
  console_->judge({Grade::poor, "the model explains 40 % of the force in x", {40.0, 91.0}});
  const auto attempt = [](Page& one) { return one.session.at("attempts").at(0); };
  EXPECT_TRUE(page->read_until([&](Page& one) {
    return one.session != Json() && !one.session.at("attempts").empty() && attempt(one).at("grade") == "poor";
  }));
  EXPECT_EQ(attempt(*page).at("vaf"), Json({40.0, 91.0}));
  EXPECT_TRUE(console_->take_exclusions().empty());

  page->tell(R"({"command":"exclude","attempt":1,"text":"spoke; laughed","from_s":1.5,"to_s":4})");
  page->tell(R"({"command":"exclude","attempt":1,"text":"coughed"})");
  EXPECT_TRUE(page->read_until([&](Page& one) { return attempt(one).at("excluded") == "coughed"; }));
  EXPECT_EQ(attempt(*page).at("windows").at(0), Json({{"from_s", 1.5}, {"to_s", 4.0}, {"why", "spoke; laughed"}}));
  auto taken = console_->take_exclusions();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].recording, outcome.recording);
  EXPECT_EQ(taken[0].excluded, "coughed");
  EXPECT_EQ(taken[0].excluded_windows, "1.5-4 s: spoke; laughed");
  EXPECT_TRUE(console_->take_exclusions().empty());

  page->refused = {};
  page->tell(R"({"command":"exclude","attempt":1,"text":"late","from_s":1,"to_s":1000})");
  EXPECT_TRUE(page->read_until([](Page& one) { return !one.refused.is_null(); }));
  page->tell(R"({"command":"include","attempt":1})");
  EXPECT_TRUE(page->read_until([&](Page& one) { return attempt(one).at("excluded") == ""; }));
  taken = console_->take_exclusions();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].excluded + taken[0].excluded_windows, "");
}

TEST_F(ConsoleOfASession, AnExclusionStandsInTheRecordingAndGoesAgain) {
  PageOperator conductor(*console_, true, {});
  auto page = open(token_);
  const auto outcome = perform(session_, folder_ / "trial.h5");
  const auto metadata = [&] { return recording::read(outcome.recording, {}).value().metadata; };
  const auto tell_and_keep = [&](const std::string& command) {
    page->tell(command);
    ASSERT_TRUE(soon([&] {
      EXPECT_TRUE(conductor.keep_notes());
      return metadata().contains("excluded") == (command.find("exclude") != std::string::npos);
    }));
  };
  tell_and_keep(R"({"command":"exclude","attempt":1,"text":"coughed\ntwice"})");
  EXPECT_EQ(metadata().at("excluded"), "coughed twice");
  EXPECT_FALSE(metadata().contains("excluded_windows"));
  tell_and_keep(R"({"command":"include","attempt":1})");
}

TEST_F(ConsoleOfASession, WhatTheParticipantsPageSaysReachesThePageThatComesLater) {
  console_->show_texts(find_texts("de", {}).value());
  auto page = open(viewing_token_);
  EXPECT_TRUE(page->read_until([](Page& one) { return one.texts != Json(); }));
  EXPECT_EQ(page->texts.at("language"), "de");
  EXPECT_EQ(page->texts.at("sentences").at("wait"), "Bitte warten.");
}

TEST_F(ConsoleOfASession, MalformedMessagesAreRefusedLoggedAndAtLastEndTheConnection) {
  auto page = open(token_);
  page->tell("{]");
  EXPECT_TRUE(page->read_until([](Page& one) { return !one.refused.is_null(); }));
  EXPECT_NE(page->refused.at("why").get<std::string>().find("JSON"), std::string::npos);
  page->tell("stop", false);
  EXPECT_TRUE(soon([&] { return logged("text"); }));
  page->tell(R"({"command":"a \" b"})");
  EXPECT_TRUE(page->read_until(
      [](Page& one) { return one.refused.at("why").get<std::string>().find("'a \" b'") != std::string::npos; }));
  EXPECT_THROW(
      {
        for (int k = 0; k < 100; ++k) {
          page->tell("{]");
          page->read();
          std::this_thread::sleep_for(1ms);
        }
      },
      boost::system::system_error);
  auto talkative = open(token_);
  beast::error_code ignored;  // it is cut off in the middle
  talkative->socket.write(net::buffer(std::string(100'000, ' ')), ignored);
  EXPECT_TRUE(soon([&] { return logged("long"); }));
  EXPECT_EQ(get("/elsewhere?token=" + token_).result(), http::status::not_found);  // it lives
}

TEST_F(ConsoleOfASession, WhatIsNotAskedForIsRefused) {
  auto page = open(token_);
  for (const char* const command : {"start", "repeat", "next", "abort", "reset", "end"}) {
    page->refused = {};
    page->tell(R"({"command":")" + std::string(command) + R"("})");
    EXPECT_TRUE(page->read_until([](Page& one) { return !one.refused.is_null(); })) << command;
  }
}

TEST_F(ConsoleOfASession, AResetTakesTwoSteps) {
  auto page = open(token_);
  Action decided = Action::stop;
  std::thread asking([&] { decided = console_->ask(Question::reset); });
  EXPECT_TRUE(page->read_until([](Page& one) { return one.state != Json() && one.state.at("question") == "reset"; }));
  page->tell(R"({"command":"reset","code":"0-0"})");
  EXPECT_TRUE(page->read_until([](Page& one) { return !one.refused.is_null(); }));
  page->tell(R"({"command":"reset"})");
  EXPECT_TRUE(page->read_until([](Page& one) { return one.state.at("reset_code") != ""; }));
  page->tell(Json{{"command", "reset"}, {"code", page->state.at("reset_code")}}.dump());
  asking.join();
  EXPECT_EQ(decided, Action::reset);
}

TEST_F(ConsoleOfASession, AStopWhileNothingRunsHoldsWhatComesNext) {
  auto page = open(token_);
  std::thread asking([&] { EXPECT_EQ(console_->ask(Question::begin), Action::abort); });
  EXPECT_TRUE(page->read_until([](Page& one) { return one.state != Json() && one.state.at("question") == "begin"; }));
  page->tell(R"({"command":"stop"})");
  EXPECT_TRUE(page->read_until([](Page& one) { return one.state.at("safety").at("tripped") == true; }));
  page->tell(R"({"command":"start"})");
  EXPECT_TRUE(page->read_until([](Page& one) { return !one.refused.is_null(); }));
  page->tell(R"({"command":"abort"})");
  asking.join();
}

TEST_F(ConsoleOfASession, AStopBetweenTrialsIsResetBeforeAnythingElse) {
  auto page = open(token_);
  page->tell(R"({"command":"stop"})");
  ASSERT_TRUE(soon([&] { return session_.flags().operator_stop.load(); }));
  std::thread asking([&] { EXPECT_EQ(console_->ask(Question::after), Action::abort); });
  EXPECT_TRUE(page->read_until([](Page& one) { return one.state != Json() && one.state.at("question") == "reset"; }));
  page->tell(R"({"command":"abort"})");
  asking.join();
}

TEST_F(ConsoleOfASession, TheLastEstimateIsThatOfTheRecording) {
  const auto outcome = perform(session_, folder_ / "trial.h5");
  auto page = open(viewing_token_);
  ASSERT_TRUE(
      page->read_until([](Page& one) { return one.estimate.contains("final") && one.estimate["final"] == true; }));
  const Recording perturbed = preprocess::perturbation_only(recording::read(outcome.recording, {}).value());
  const Json offline = Json::parse(result::to_json(measurement::measure({&perturbed, 1}, {}).value()));
  const Json& live = page->estimate.at("result");
  EXPECT_NEAR(page->estimate.at("perturbed_s").get<double>(), 12.0, 0.01);
  for (const char* const part : {"method", "model", "standard_error", "fit", "estimation", "usable"}) {
    EXPECT_EQ(live.at(part), offline.at(part)) << part;  // to the bit
  }
}

TEST_F(ConsoleOfASession, AStopFromThePageTripsTheGateAndIsSaidWithItsReason) {
  console_.reset();
  session_ = session::Session(session::Pace{true, 1.0});
  open_console();
  session::TrialOutcome outcome;
  auto page = open(token_);
  std::thread trial([&] { outcome = perform(session_, folder_ / "trial.h5"); });
  EXPECT_TRUE(page->read_until([](Page& one) { return one.frames > 30; }));
  page->tell(R"({"command":"stop"})");
  EXPECT_TRUE(page->read_until([](Page& one) { return one.state.at("safety").at("tripped") == true; }));
  EXPECT_EQ(page->state.at("safety").at("reason"), "operator-stop");
  EXPECT_NE(page->state.at("safety").at("sentence").get<std::string>().find("operator"), std::string::npos);
  trial.join();
  EXPECT_EQ(outcome.trip.reason, safety::Reason::operator_stop);
  EXPECT_EQ(outcome.motors.state, safety::MotorsOff::State::confirmed);
  // the ramp, and what the robot takes to confirm that its motors are off
  const auto confirming = static_cast<std::uint64_t>(std::lround(1e3 * outcome.motors.after));
  EXPECT_EQ(outcome.times.ticks, outcome.trip.tick + safety::kRampTicks - 1 + confirming);
  EXPECT_LT(confirming, 60U);
}

TEST_F(ConsoleOfASession, ATripIsSaidBeforeTheNextBeat) {
  console_.reset();
  open_console({.beat = 24h});
  const session::Plan& plan = plans_.front();
  auto robot = laboratory::simulated_robot(plan.trial).value();
  console_->begin(0, session::header_of(plan, robot->facts()), folder_ / "trial.h5", 1.0);
  auto page = open(viewing_token_);
  constexpr int kTrips = 400;
  journal::Tick tick;
  for (int k = 0; k < kTrips; ++k) {
    tick.number = static_cast<std::uint64_t>(k);
    tick.reason = static_cast<decltype(tick.reason)>(k % 2 == 0 ? safety::Reason::operator_stop : safety::Reason::none);
    console_->watch({&tick, 1});
    ASSERT_TRUE(page->read_until([&](Page& one) { return one.state != Json() && one.state.at("ticks") == k + 1; }));
    ASSERT_EQ(page->state.at("safety").at("tripped"), k % 2 == 0);
  }
}

TEST_F(ConsoleOfASession, AStuckViewerCostsABoundedRoomAndHoldsNobodyUp) {
  auto stuck = open(viewing_token_);  // never reads
  ASSERT_TRUE(soon([&] { return console_->status().viewers == 1; }));
  const session::Plan& plan = plans_.front();
  auto robot = laboratory::simulated_robot(plan.trial).value();
  console_->begin(0, session::header_of(plan, robot->facts()), folder_ / "trial.h5", 1.0);
  std::vector<journal::Tick> ticks(8192);
  std::uint64_t number = 0;
  // 8192 samples are 426 kB: the buffers of both sockets are full after some ten of them
  EXPECT_TRUE(soon([&] {
    for (journal::Tick& tick : ticks) tick.number = number++;
    console_->watch(ticks);
    return console_->status().dropped_frames > 100;
  }));
  auto page = open(token_);
  EXPECT_TRUE(page->read_until(
      [](Page& one) { return one.state != Json() && one.state.at("dropped_frames").get<int>() > 100; }));
  EXPECT_EQ(page->state.at("dropped_ticks"), 0);
}

TEST_F(ConsoleOfASession, SamplesThatAreTooManyForAFrameAreLeftOutAndCounted) {
  const session::Plan& plan = plans_.front();
  auto robot = laboratory::simulated_robot(plan.trial).value();
  console_->begin(0, session::header_of(plan, robot->facts()), folder_ / "trial.h5", 1.0);
  std::vector<journal::Tick> ticks(1'000'000);
  for (std::size_t k = 0; k < ticks.size(); ++k) ticks[k].number = k + 5;
  console_->watch(ticks);
  const Json state = Json::parse(console_->state());
  EXPECT_GE(state.at("skipped_samples"), 1'000'000 - 8192);
  EXPECT_EQ(state.at("dropped_ticks"), 5);
}

TEST_F(ConsoleOfASession, LongSentencesAreCutInTheState) {
  std::string words;
  while (words.size() < 1'000'000) words += "Zu großer Weg. ";
  console_->say(words);
  console_->show_report("", words);
  RobotStatus robot;
  robot.sentence = words;
  console_->show_robot(robot);
  const std::string state = console_->state();
  EXPECT_LT(state.size(), 8'000U);
  EXPECT_EQ(state.find("\xEF\xBF\xBD"), std::string::npos);  // no character was cut in two
  EXPECT_NE(Json::parse(state).at("said").get<std::string>().find("Zu großer Weg. "), std::string::npos);
}

TEST_F(ConsoleOfASession, TheLastReportsAreKept) {
  for (int k = 1; k <= 40; ++k) console_->show_report("<p>report " + std::to_string(k));
  EXPECT_EQ(get("/report/1?token=" + token_).result(), http::status::not_found);
  EXPECT_EQ(get("/report/40?token=" + token_).body(), "<p>report 40");
  EXPECT_EQ(Json::parse(console_->state()).at("trials").at(0).at("report"), 40);
}

TEST_F(ConsoleOfASession, TheRobotsStateIsShownAtOnceFromAnyThread) {
  auto page = open(viewing_token_);
  ASSERT_TRUE(page->read_until([](Page& one) { return !one.state.is_null(); }));
  const Json nothing = {{"motors", "unknown"},  {"confirmed_off", nullptr},
                        {"stop_button", false}, {"link", true},
                        {"fault", 0},           {"sentence", ""}};
  EXPECT_EQ(page->state.at("robot"), nothing);
  std::vector<std::thread> others;
  for (int k = 0; k < 4; ++k) {
    others.emplace_back([&, k] {
      for (int i = 0; i < 200; ++i) {
        RobotStatus robot;
        robot.fault = 200 * k + i;
        console_->show_robot(robot);
      }
    });
  }
  for (std::thread& other : others) other.join();
  constexpr int kLast = 4242;  // none of the others
  RobotStatus robot;
  robot.motors = RobotStatus::Motors::on;
  robot.confirmed_off = false;
  robot.stop_button = true;
  robot.link = false;
  robot.fault = kLast;
  robot.sentence = "the drives still report 3 N·m";
  console_->show_robot(robot);
  EXPECT_TRUE(page->read_until([](Page& one) { return one.state.at("robot").at("fault") == kLast; }));
  const Json all = {{"motors", "on"}, {"confirmed_off", false}, {"stop_button", true},
                    {"link", false},  {"fault", kLast},         {"sentence", "the drives still report 3 N·m"}};
  EXPECT_EQ(page->state.at("robot"), all);
  robot.confirmed_off = true;
  console_->show_robot(robot);
  EXPECT_TRUE(page->read_until([](Page& one) { return one.state.at("robot").at("confirmed_off") == true; }));
}

TEST_F(ConsoleOfASession, ATrialForgetsWhatTheRobotSaidBefore) {
  RobotStatus off;
  off.motors = RobotStatus::Motors::off;
  off.confirmed_off = true;
  console_->show_robot(off);
  console_->begin(0, {}, "trial.h5", 10.0);
  const auto robot = [&] { return Json::parse(console_->state()).at("robot"); };
  EXPECT_EQ(robot().at("motors"), "unknown");
  EXPECT_TRUE(robot().at("confirmed_off").is_null());
  journal::Tick tick;
  tick.enabled = 1;
  console_->watch({&tick, 1});
  EXPECT_TRUE(Json::parse(console_->state()).at("safety").at("enabled"));
  EXPECT_EQ(robot().at("motors"), "unknown");
}

TEST_F(ConsoleOfASession, ANoteNeverTakesThePlaceOfAnAnswer) {
  auto page = open(token_);
  const auto asks = [](const char* question) {
    return [=](Page& one) { return !one.state.is_null() && one.state["question"] == question; };
  };
  ASSERT_TRUE(page->read_until(control("here")));
  for (int k = 0; k < 20; ++k) {
    Action decided = Action::stop;
    std::thread asking([&] { decided = console_->ask(Question::begin); });
    EXPECT_TRUE(page->read_until(asks("begin")));
    page->tell(R"({"command":"start"})");
    page->tell(R"({"command":"note","text":"begun"})");
    asking.join();
    ASSERT_EQ(decided, Action::start) << k;
    ASSERT_TRUE(page->read_until(asks("")));
    // Else a note that is still on its way answers the next question.
    ASSERT_TRUE(soon([&] { return !console_->take_notes().empty(); }));
  }
}

TEST_F(ConsoleOfASession, ThePageConductsAnExperiment) {
  auto page = open(token_);
  const auto asks = [](const char* question) {
    return [=](Page& one) { return !one.state.is_null() && one.state["question"] == question; };
  };
  ASSERT_TRUE(page->read_until(control("here")));
  std::vector<std::string> warned;
  PageOperator conductor(*console_, true, [&](const std::string& warning) { warned.push_back(warning); });
  const session::Experiment experiment{plans_, folder_ / "trial.h5"};
  session::Conclusion conclusion;
  std::thread conducting([&] {
    ASSERT_TRUE(conductor.may_begin(session_, experiment));
    conclusion = session::conduct(experiment, session_, conductor, {});
  });
  EXPECT_TRUE(page->read_until(asks("begin")));
  page->tell(R"({"command":"start"})");
  EXPECT_TRUE(page->read_until(asks("after")));
  page->tell(R"({"command":"note","text":"born 1.2.1984"})");
  EXPECT_TRUE(soon([&] { return recording::read(folder_ / "trial.h5", {})->metadata.contains("notes"); }));
  page->tell(R"({"command":"stop"})");  // holds what comes next
  EXPECT_TRUE(page->read_until([](Page& one) { return one.state["question"] == "reset"; }));
  page->tell(R"({"command":"reset"})");
  EXPECT_TRUE(page->read_until([](Page& one) { return one.state.at("reset_code") != ""; }));
  page->tell(Json{{"command", "reset"}, {"code", page->state.at("reset_code")}}.dump());
  EXPECT_TRUE(page->read_until(asks("after")));
  page->tell(R"({"command":"repeat"})");
  EXPECT_TRUE(page->read_until(asks("")));
  EXPECT_TRUE(page->read_until(asks("after")));
  page->tell(R"({"command":"abort"})");
  conducting.join();
  EXPECT_FALSE(conclusion.completed);
  EXPECT_FALSE(conclusion.failure);
  EXPECT_EQ(conductor.recording(), folder_ / "trial_2.h5");
  ASSERT_EQ(warned.size(), 1U);
  EXPECT_NE(warned.front().find("note"), std::string::npos) << warned.front();
}

TEST_F(ConsoleOfASession, NotesOfARecordingAreBoundedAndTheRefusalIsSaid) {
  auto page = open(token_);
  ASSERT_TRUE(page->read_until(control("here")));
  const std::string text(1800, 'a');
  const std::size_t fit = kMaxNoteBytes / text.size();
  for (std::size_t i = 0; i <= fit; ++i) page->tell(Json{{"command", "note"}, {"text", text}}.dump());
  ASSERT_TRUE(page->read_until([](Page& one) { return !one.refused.is_null(); }));
  EXPECT_NE(page->refused.at("why").get<std::string>().find("note"), std::string::npos);
  EXPECT_EQ(console_->take_notes().size(), fit);
  EXPECT_LT(console_->state().size(), 16'000U);
}

TEST_F(ConsoleOfASession, NotesReachTheRecording) {
  auto page = open(token_);
  page->tell(R"({"command":"note","text":"the participant talked"})");
  page->tell(R"({"command":"note","text":"ä second\none"})");
  std::vector<std::string> notes;
  EXPECT_TRUE(soon([&] {
    for (std::string& note : console_->take_notes()) notes.push_back(std::move(note));
    return notes.size() == 2;
  }));
  const auto outcome = perform(session_, folder_ / "trial.h5");
  const auto before = recording::read(outcome.recording, {}).value();
  for (const std::string& note : notes) {
    const auto ok = session::annotate(outcome.recording, {note});
    ASSERT_TRUE(ok) << ok.error().line();
  }
  const auto after = recording::read(outcome.recording, {}).value();
  EXPECT_EQ(after.metadata.at("notes"), "the participant talked | ä second one");
  ASSERT_EQ(after.channels.size(), before.channels.size());
  for (std::size_t k = 0; k < before.channels.size(); ++k) {
    EXPECT_EQ(after.channels[k].name, before.channels[k].name);
    EXPECT_EQ(after.channels[k].values, before.channels[k].values);
  }
  EXPECT_EQ(after.events.size(), before.events.size());
}

}  // namespace console_test
}  // namespace mbk::console
