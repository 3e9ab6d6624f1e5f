#include "mbk/experiment/console/server.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <ctime>
#include <list>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace mbk::console {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using net::ip::tcp;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Waits until it is so; false after so long.
template <class Condition>
bool soon(const Condition& condition, std::chrono::seconds patience = 20s) {
  for (const auto end = Clock::now() + patience; Clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

class FloodedServer : public testing::Test {
 protected:
  using Stream = websocket::stream<tcp::socket, false>;

  void SetUp() override { open(); }
  void TearDown() override {
    strangers_.clear();
    server_.reset();
  }

  void open(ServerTimes times = {}) {
    Server::Handlers handlers;
    handlers.page = [this](std::string_view path) {
      if (throws_) throw std::runtime_error("no page today");
      return path == "/" ? make_page("<p>a page") : Page{};
    };
    handlers.command = [this](const Command& command) -> Result<void> {
      if (throws_) throw std::runtime_error("no command today");
      (command.action == Action::stop ? stops_ : others_) += 1;
      return {};
    };
    handlers.beat = [this] {
      ++beats_;
      if (throws_) throw 7;
    };
    handlers.log = [this](const std::string& line) {
      const std::scoped_lock lock(mutex_);
      log_.push_back(line);
    };
    server_ = Server::listen(0, std::move(handlers), times).value();
  }

  [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(server_->port()); }
  [[nodiscard]] std::string page() const { return "/?token=" + server_->token(); }

  tcp::socket connected() {
    tcp::socket socket(context_);
    socket.connect({net::ip::address_v4::loopback(), server_->port()});
    return socket;
  }
  /// As long as it lets itself; a stranger that says `words`.
  void stranger(std::string_view words = "") {
    beast::error_code ignored;
    tcp::socket socket(context_);
    socket.connect({net::ip::address_v4::loopback(), server_->port()}, ignored);
    if (!words.empty() && !ignored) net::write(socket, net::buffer(words), ignored);
    strangers_.push_back(std::move(socket));
  }

  /// The status of the answer to these words; 0: none came.
  unsigned answer_to(const std::string& words) {
    tcp::socket socket = connected();
    timeval patience{20, 0};
    setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    beast::error_code error;
    net::write(socket, net::buffer(words), error);
    beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(socket, buffer, response, error);
    return error ? 0U : response.result_int();
  }
  unsigned get(const std::string& target) {
    return answer_to("GET " + target + " HTTP/1.1\r\nHost: " + host() + "\r\n\r\n");
  }

  std::unique_ptr<Stream> stream(const std::string& token) {
    auto made = std::make_unique<Stream>(connected());
    made->set_option(websocket::stream_base::decorator(
        [&](websocket::request_type& request) { request.set(http::field::origin, "http://" + host()); }));
    beast::error_code error;
    made->handshake(host(), "/stream?token=" + token, error);
    return error ? nullptr : std::move(made);
  }

  std::size_t lines(std::string_view what = "") {
    const std::scoped_lock lock(mutex_);
    return static_cast<std::size_t>(
        std::ranges::count_if(log_, [&](const std::string& line) { return line.find(what) != std::string::npos; }));
  }

  net::io_context context_;
  std::atomic<int> stops_{0}, others_{0}, beats_{0};
  std::atomic<bool> throws_{false};
  std::mutex mutex_;
  std::vector<std::string> log_;
  std::list<tcp::socket> strangers_;
  std::unique_ptr<Server> server_;
};

TEST_F(FloodedServer, HalfOpenConnectionsDoNotKeepThePageFromItsHolder) {
  for (int k = 0; k < 400; ++k) stranger();
  EXPECT_EQ(get(page()), 200U);
  EXPECT_NE(stream(server_->token()), nullptr);
  EXPECT_NE(stream(server_->viewing_token()), nullptr);
}

TEST_F(FloodedServer, RequestsThatNeverEndDoNotEither) {
  for (int k = 0; k < 400; ++k) stranger("GET / HTTP/1.1\r\nHost: " + host() + "\r\nX-Slow: ");
  EXPECT_EQ(get(page()), 200U);
  EXPECT_NE(stream(server_->token()), nullptr);
}

TEST_F(FloodedServer, WhoSendsNoWholeRequestIsClosedEvenIfItKeepsTalking) {
  tcp::socket slow = connected();
  beast::error_code error;
  net::write(slow, net::buffer(std::string_view("GET / HTTP/1.1\r\n")));
  const auto begin = Clock::now();
  while (!error && Clock::now() - begin < 20s) {
    net::write(slow, net::buffer(std::string_view("X: y\r\n")), error);
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_TRUE(error);
}

TEST_F(FloodedServer, ABurstOfConnectionsDoesNotHoldTheHolderUp) {
  std::atomic<bool> over{false};
  std::thread burst([&] {
    for (int k = 0; k < 10'000 && !over; ++k) {
      beast::error_code ignored;
      net::io_context context;
      tcp::socket socket(context);
      socket.connect({net::ip::address_v4::loopback(), server_->port()}, ignored);
    }
  });
  for (int k = 0; k < 10; ++k) EXPECT_EQ(get(page()), 200U);
  over = true;
  burst.join();
}

TEST_F(FloodedServer, StreamsWithTheViewersTokenLeaveRoomForTheOperator) {
  std::vector<std::unique_ptr<Stream>> viewers;
  for (int k = 0; k < 60; ++k) viewers.push_back(stream(server_->viewing_token()));
  EXPECT_EQ(get("/?token=" + server_->viewing_token()), 503U);
  EXPECT_LT(server_->status().viewers, 60);
  EXPECT_EQ(get(page()), 200U);
  EXPECT_NE(stream(server_->token()), nullptr);
  viewers.clear();
  EXPECT_TRUE(soon([&] { return get("/?token=" + server_->viewing_token()) == 200U; }));
}

TEST_F(FloodedServer, ThousandsOfWrongTokensAreCountedAndFewLinesAreSaid) {
  for (int k = 0; k < 2000; ++k) EXPECT_EQ(get("/?token=0123"), 403U);
  EXPECT_EQ(server_->status().refused, 2000U);
  const auto refused_in_total = [&] {
    const std::scoped_lock lock(mutex_);
    std::size_t all = 0;
    for (const std::string& line : log_) {
      all += line.find(" × ") == std::string::npos ? 1 : std::stoul(line.substr(line.find(' ') + 1));
    }
    return all;
  };
  server_->stop();  // says what is left to say
  EXPECT_EQ(refused_in_total(), 2000U);
  EXPECT_LE(lines(), 100U);  // 12 for each 10 s, however slow the machine is
}

TEST_F(FloodedServer, ARequestThatCanBeReadInTwoWaysIsRefused) {
  const std::string token = server_->token();
  const std::string begin = "GET /?token=" + token + " HTTP/1.1\r\n", host_line = "Host: " + host() + "\r\n";
  const std::string origin = "Origin: http://" + host() + "\r\n";
  EXPECT_EQ(answer_to(begin + host_line + origin + "\r\n"), 200U);
  EXPECT_EQ(answer_to(begin + host_line + host_line + "\r\n"), 403U);
  EXPECT_EQ(answer_to(begin + host_line + "Host: evil.example\r\n\r\n"), 403U);
  EXPECT_EQ(answer_to(begin + "Host: evil.example\r\n" + host_line + "\r\n"), 403U);
  EXPECT_EQ(answer_to(begin + "\r\n"), 403U);
  EXPECT_EQ(answer_to(begin + "Host: " + host() + ", evil.example\r\n\r\n"), 403U);
  EXPECT_EQ(answer_to(begin + host_line + origin + origin + "\r\n"), 403U);
  EXPECT_EQ(answer_to(begin + host_line + origin + "Origin: http://evil.example\r\n\r\n"), 403U);
  EXPECT_EQ(answer_to(begin + host_line + "Origin:\r\n\r\n"), 403U);
  EXPECT_EQ(answer_to("GET http://" + host() + "/?token=" + token + " HTTP/1.1\r\n" + host_line + "\r\n"), 403U);
  EXPECT_EQ(answer_to("GET /?token=" + token + "&token=0 HTTP/1.1\r\n" + host_line + "\r\n"), 403U);
  EXPECT_EQ(answer_to("GET /?token=0&token=" + token + " HTTP/1.1\r\n" + host_line + "\r\n"), 403U);
  EXPECT_EQ(answer_to("POST /?token=" + token + " HTTP/1.1\r\n" + host_line + "\r\n"), 405U);
  EXPECT_GT(lines("2 hosts"), 0U);
}

TEST_F(FloodedServer, HugeHeadersAndGarbageAreCutOff) {
  const std::string begin = "GET " + page() + " HTTP/1.1\r\nHost: " + host() + "\r\n";
  EXPECT_EQ(answer_to(begin + "X: " + std::string(1 << 20, 'x') + "\r\n\r\n"), 0U);
  EXPECT_EQ(answer_to(std::string(1 << 16, '\xff')), 0U);
  EXPECT_EQ(answer_to("GET / HTTP/9.9\r\n\r\n"), 0U);
  EXPECT_GT(lines("request"), 0U);
  // behind a request there may be anything: it is not looked at
  EXPECT_EQ(answer_to(begin + "\r\n" + std::string(100, '\xff')), 200U);
  EXPECT_EQ(get(page()), 200U);
}

TEST_F(FloodedServer, ControlIsKeptForAWhileAndGoesToTheNextPageThen) {
  open({.control_kept = 200ms});
  auto first = stream(server_->token() + "&page=1");
  ASSERT_TRUE(soon([&] { return server_->status().controlled; }));
  first.reset();
  ASSERT_TRUE(soon([&] { return server_->status().viewers == 0; }));
  EXPECT_TRUE(soon([&] { return !server_->status().controlled; }));  // nobody came in time
  auto second = stream(server_->token() + "&page=2");
  EXPECT_TRUE(soon([&] { return server_->status().controlled; }));
  second->write(net::buffer(std::string(R"({"command":"end"})")));
  EXPECT_TRUE(soon([&] { return others_ == 1; }));
}

TEST_F(FloodedServer, EveryStopOfAPageIsObeyedWhateverElseItSends) {
  auto operators = stream(server_->token());
  ASSERT_NE(operators, nullptr);
  std::thread reading([&] {  // the bytes alone: a WebSocket is not for two threads
    std::array<char, 4096> bytes{};
    beast::error_code error;
    while (!error) operators->next_layer().read_some(net::buffer(bytes), error);
  });
  const std::string note = R"({"command":"note","text":")" + std::string(1000, 'n') + R"("})";
  for (int k = 0; k < 1000; ++k) {
    operators->write(net::buffer(note));
    if (k % 10 == 0) operators->write(net::buffer(std::string(R"({"command":"stop"})")));
  }
  EXPECT_TRUE(soon([&] { return stops_ == 100; })) << stops_;
  EXPECT_LT(others_, 1000);  // notes that come by the thousand are refused
  beast::error_code ignored;
  operators->next_layer().shutdown(tcp::socket::shutdown_both, ignored);
  reading.join();
}

TEST_F(FloodedServer, AViewerThatFloodsWithPingsOrMessagesIsClosed) {
  for (const bool pings : {true, false}) {
    auto viewer = stream(server_->viewing_token());
    ASSERT_NE(viewer, nullptr);
    ASSERT_TRUE(soon([&] { return server_->status().viewers == 1; }));
    beast::error_code error;
    for (int k = 0; k < 20'000 && !error; ++k) {
      if (pings) {
        viewer->ping({}, error);
      } else {
        viewer->write(net::buffer(std::string(R"({"command":"note","text":"n"})")), error);
      }
    }
    EXPECT_TRUE(soon([&] { return server_->status().viewers == 0; })) << pings;
  }
  EXPECT_EQ(others_, 0);
  EXPECT_GT(lines("pings"), 0U);
}

TEST_F(FloodedServer, ARefusalIsOneLineOfJsonWhateverTheMessageWas) {
  auto one = stream(server_->token());
  ASSERT_NE(one, nullptr);
  one->write(net::buffer(std::string(R"({"command":"a\nb\u0001\"\\"})")));
  beast::flat_buffer buffer;
  std::string message;
  for (int k = 0; k < 10 && message.find("refused") == std::string::npos; ++k) {
    buffer.clear();
    one->read(buffer);
    message = beast::buffers_to_string(buffer.data());
  }
  EXPECT_TRUE(message.starts_with(R"({"type":"refused","why":")")) << message;
  EXPECT_NE(message.find(R"('a?b?\"\\')"), std::string::npos) << message;
  EXPECT_EQ(lines("\n"), 0U);
}

TEST_F(FloodedServer, NoExceptionEndsIt) {
  auto before = stream(server_->token());
  ASSERT_NE(before, nullptr);
  throws_ = true;
  EXPECT_EQ(get(page()), 0U);
  before->write(net::buffer(std::string(R"({"command":"end"})")));
  EXPECT_TRUE(soon([&] { return server_->status().viewers == 0; }));  // which page it was cannot be trusted any more
  const int beats = beats_;
  EXPECT_TRUE(soon([&] { return beats_ > beats + 20; }));
  throws_ = false;
  EXPECT_EQ(get(page()), 200U);
  auto after = stream(server_->token());
  ASSERT_NE(after, nullptr);
  after->write(net::buffer(std::string(R"({"command":"stop"})")));
  EXPECT_TRUE(soon([&] { return stops_ == 1; }));
  EXPECT_GT(lines("no page today"), 0U);
  EXPECT_LE(lines("today"), 100U);
}

/// Takes all descriptors that there are; they are back when it goes.
class Descriptors {
 public:
  explicit Descriptors(rlim_t most) {
    getrlimit(RLIMIT_NOFILE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = most;
    setrlimit(RLIMIT_NOFILE, &limit);
  }
  Descriptors(const Descriptors&) = delete;
  Descriptors& operator=(const Descriptors&) = delete;
  ~Descriptors() {
    leave(0);
    setrlimit(RLIMIT_NOFILE, &before_);
  }
  void take() {
    for (int one = dup(0); one >= 0; one = dup(0)) taken_.push_back(one);
  }
  void leave(std::size_t some) {
    for (; taken_.size() > some; taken_.pop_back()) close(taken_.back());
  }
  [[nodiscard]] std::size_t taken() const { return taken_.size(); }

 private:
  rlimit before_{};
  std::vector<int> taken_;
};

TEST_F(FloodedServer, OutOfDescriptorsItWaitsAndGoesOnAfterwards) {
  Descriptors descriptors(128);
  // clients first: their descriptors are of this process too
  std::list<tcp::socket> clients;
  for (int k = 0; k < 5; ++k) clients.emplace_back(context_, tcp::v4());
  descriptors.take();
  beast::error_code error;
  for (tcp::socket& client : clients) {
    client.connect({net::ip::address_v4::loopback(), server_->port()}, error);
    EXPECT_FALSE(error) << error.message();
  }
  const std::clock_t before = std::clock();
  std::this_thread::sleep_for(1s);
  const double busy = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  EXPECT_LT(busy, 0.3);  // of a second; an accept that is tried again at once takes all of it
  EXPECT_TRUE(soon([&] { return lines("Too many open files") > 0; }));
  EXPECT_LE(lines("Too many open files"), 10U);
  // who waits is turned away rather than left alone
  char nothing = 0;
  clients.front().read_some(net::buffer(&nothing, 1), error);
  EXPECT_TRUE(error);
  descriptors.leave(0);
  clients.clear();
  EXPECT_EQ(get(page()), 200U);
}

TEST_F(FloodedServer, OfFewDescriptorsItLeavesSomeToTheRecording) {
  Descriptors descriptors(64);
  server_.reset();
  open();
  for (int k = 0; k < 30; ++k) stranger();  // each has two descriptors here: its own, and the server's
  EXPECT_TRUE(soon([&] { return lines("token") > 0; }));
  EXPECT_EQ(lines("Too many open files"), 0U);
  const int free = dup(0);
  EXPECT_GE(free, 0);
  close(free);
  EXPECT_EQ(get(page()), 200U);
}

}  // namespace
}  // namespace mbk::console
