#include "mbk/console/server.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <list>
#include <thread>

#include "mbk/core/printable.h"

namespace mbk::console {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using boost::system::error_code;
using net::ip::tcp;
using namespace std::chrono_literals;

// twice as often as screens are drawn, so that there is something new for every picture
constexpr auto kBeat = std::chrono::nanoseconds(1'000'000'000 / 120);
constexpr auto kRequestTime = 10s;       // for a request, and for its answer
constexpr auto kSilence = 20s;           // of a viewer, after which it is gone
constexpr std::size_t kMostFrames = 60;  // half a second
constexpr int kSendBuffer = 256 << 10;   // [bytes] of the operating system
constexpr std::size_t kMostConnections = 32;
constexpr std::size_t kLongestMessage = 8 << 10;  // [bytes]
constexpr int kMostMalformed = 20;                // messages of one viewer

/// 128 random bits as hexadecimal digits.
std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  while (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
  }
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

/// In a time that says nothing of where they differ.
bool same(std::string_view one, std::string_view other) {
  if (one.size() != other.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    difference |= static_cast<unsigned>(one[i]) ^ static_cast<unsigned>(other[i]);
  }
  return difference == 0;
}

struct Target {
  std::string_view path, token;
};

/// "/report/1?token=…"
Target split(std::string_view target) {
  const std::size_t question = target.find('?');
  if (question == std::string_view::npos) return {target, {}};
  constexpr std::string_view kKey = "token=";
  std::string_view query = target.substr(question + 1);
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    if (part.starts_with(kKey)) return {target.substr(0, question), part.substr(kKey.size())};
    query.remove_prefix(std::min(part.size() + 1, query.size()));
  }
  return {target.substr(0, question), {}};
}

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

}  // namespace

class Server::Implementation {
 public:
  explicit Implementation(Handlers handlers)
      : handlers_(std::move(handlers)), token_(random_token()), viewing_token_(random_token()) {}
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  ~Implementation() { stop(); }

  void stop() {
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }

  Result<void> open(std::uint16_t port) {
    error_code error;
    const tcp::endpoint here(net::ip::address_v4::loopback(), port);
    acceptor_.open(here.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(here, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (error) {
      return bad_usage(fmt::format("the console cannot listen on 127.0.0.1:{}: {}", port, error.message()),
                       "choose another --port, or leave it away");
    }
    port_ = acceptor_.local_endpoint().port();
    hosts_ = {fmt::format("127.0.0.1:{}", port_), fmt::format("localhost:{}", port_)};
    accept();
    next_beat_ = std::chrono::steady_clock::now();
    wait_for_beat();
    thread_ = std::thread([this] { context_.run(); });
    return {};
  }

  /// What there is goes out.
  void beat();
  void beat_soon() {
    net::post(context_, [this] { beat(); });
  }

  void send(Topic topic, Message message);
  void send_frame(const Message& frame);

  [[nodiscard]] Status status() const { return {viewer_count_, controlled_, dropped_, refused_}; }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] const std::string& token() const { return token_; }
  [[nodiscard]] const std::string& viewing_token() const { return viewing_token_; }

 private:
  class Connection;
  class Viewer;
  using Request = http::request<http::string_body>;
  using Response = http::response<http::string_body>;

  void accept();
  void wait_for_beat();
  void refuse(const std::string& why) {
    ++refused_;
    handlers_.log("refused: " + why);
  }

  [[nodiscard]] bool known(std::string_view host) const { return std::ranges::find(hosts_, host) != hosts_.end(); }

  /// What the request may: nothing, watch, or control.
  enum class Rights { none, watch, control };
  [[nodiscard]] Rights rights(std::string_view token) const {
    if (same(token, token_)) return Rights::control;
    return same(token, viewing_token_) ? Rights::watch : Rights::none;
  }

  Rights admit(const Request& request);
  [[nodiscard]] Response answer(const Request& request, Rights rights);
  void add(const std::shared_ptr<Viewer>& viewer);
  void remove(const Viewer& viewer);
  void choose_controller();
  void receive(Viewer& viewer, std::string_view text, bool is_text);

  Handlers handlers_;
  std::string token_, viewing_token_;
  std::size_t connections_ = 0;  // outlives them, as they end with the context
  net::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  net::steady_timer timer_{context_};
  std::chrono::steady_clock::time_point next_beat_;
  std::uint16_t port_ = 0;
  std::array<std::string, 2> hosts_;
  std::list<std::shared_ptr<Viewer>> viewers_;  // in the order in which they came
  std::array<Message, kTopics> newest_;
  std::atomic<int> viewer_count_{0};
  std::atomic<bool> controlled_{false};
  std::atomic<std::uint64_t> dropped_{0}, refused_{0};
  std::thread thread_;
};

/// A page that is open: the stream of messages to it, and its commands.
class Server::Implementation::Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(Implementation& server, beast::tcp_stream stream, Rights rights)
      : server_(server), socket_(std::move(stream)), rights_(rights) {}
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  ~Viewer() { --server_.connections_; }

  void run(const Request& request) {
    beast::get_lowest_layer(socket_).expires_never();
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = kRequestTime;
    timeout.idle_timeout = kSilence;
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(kLongestMessage);
    error_code ignored;
    beast::get_lowest_layer(socket_).socket().set_option(net::socket_base::send_buffer_size(kSendBuffer), ignored);
    beast::get_lowest_layer(socket_).socket().set_option(tcp::no_delay(true), ignored);
    socket_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->server_.add(self);
      self->read();
    });
  }

  void put(Topic topic, Message message) {
    outbox_.put(topic, std::move(message));
    write();
  }

  /// @returns  frames that had to make room
  std::uint64_t put_frame(const Message& frame) {
    const std::uint64_t before = outbox_.dropped();
    outbox_.put_frame(frame);
    write();
    return outbox_.dropped() - before;
  }

  /// Says who it is, where that has changed or frames were dropped.
  void introduce() {
    if (said_ && said_controls_ == controls && said_dropped_ == outbox_.dropped()) return;
    said_ = true;
    said_controls_ = controls;
    said_dropped_ = outbox_.dropped();
    put(Topic::you,
        std::make_shared<std::string>(fmt::format(R"({{"type":"you","controls":{},"may_stop":{},"dropped_frames":{}}})",
                                                  controls, rights_ == Rights::control, said_dropped_)));
  }

  void close() { beast::get_lowest_layer(socket_).close(); }

  [[nodiscard]] Rights rights() const { return rights_; }
  bool controls = false;
  int malformed = 0;

 private:
  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) {
        if (error == websocket::error::message_too_big) self->server_.refuse("a message that is too long");
        self->server_.remove(*self);
        return;
      }
      const auto data = self->buffer_.cdata();
      self->server_.receive(*self, {static_cast<const char*>(data.data()), data.size()}, self->socket_.got_text());
      self->buffer_.consume(self->buffer_.size());
      self->read();
    });
  }

  void write() {
    if (sending_) return;
    auto outgoing = outbox_.take();
    if (!outgoing) return;
    sending_ = std::move(outgoing->message);
    socket_.binary(outgoing->binary);
    socket_.async_write(net::buffer(*sending_), [self = shared_from_this()](error_code error, std::size_t) {
      self->sending_ = nullptr;
      if (error) return self->close();
      self->write();
    });
  }

  Implementation& server_;
  websocket::stream<beast::tcp_stream> socket_;
  Rights rights_;
  beast::flat_buffer buffer_;
  Outbox outbox_{kMostFrames};
  Message sending_;
  bool said_ = false, said_controls_ = false;
  std::uint64_t said_dropped_ = 0;
};

/// A connection until it is known what it wants.
class Server::Implementation::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Implementation& server, tcp::socket socket) : server_(server), stream_(std::move(socket)) {
    ++server_.connections_;
    parser_.header_limit(kLongestMessage);
    parser_.body_limit(kLongestMessage);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() {
    if (!handed_over_) --server_.connections_;
  }

  void run() {
    stream_.expires_after(kRequestTime);
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->serve();
    });
  }

 private:
  void serve() {
    const Request& request = parser_.get();
    const Rights rights = server_.admit(request);
    if (rights != Rights::none && websocket::is_upgrade(request)) {
      handed_over_ = true;
      std::make_shared<Viewer>(server_, std::move(stream_), rights)->run(request);
      return;
    }
    response_ = server_.answer(request, rights);
    stream_.expires_after(kRequestTime);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  Implementation& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  Response response_;
  bool handed_over_ = false;
};

void Server::Implementation::accept() {
  acceptor_.async_accept([this](error_code error, tcp::socket socket) {
    if (error == net::error::operation_aborted) return;
    if (!error && connections_ < kMostConnections) {
      std::make_shared<Connection>(*this, std::move(socket))->run();
    } else if (!error) {
      refuse(fmt::format("more than {} connections", kMostConnections));
    }
    accept();
  });
}

void Server::Implementation::beat() {
  handlers_.beat();
  for (const auto& viewer : viewers_) viewer->introduce();
}

void Server::Implementation::wait_for_beat() {
  next_beat_ = std::max(next_beat_ + kBeat, std::chrono::steady_clock::now());
  timer_.expires_at(next_beat_);
  timer_.async_wait([this](error_code error) {
    if (error) return;
    beat();
    wait_for_beat();
  });
}

Server::Implementation::Rights Server::Implementation::admit(const Request& request) {
  const std::string_view host = view(request[http::field::host]);
  const std::string_view origin = view(request[http::field::origin]);
  const bool upgrade = websocket::is_upgrade(request);
  const Target target = split(view(request.target()));
  if (!known(host)) {
    refuse(fmt::format("the host '{:.80}'", printable(std::string(host))));
    return Rights::none;
  }
  constexpr std::string_view kScheme = "http://";
  const bool foreign = !origin.starts_with(kScheme) || !known(origin.substr(kScheme.size()));
  if (foreign && (upgrade || !origin.empty())) {
    refuse(fmt::format("the origin '{:.80}'", printable(std::string(origin))));
    return Rights::none;
  }
  const Rights found = rights(target.token);
  if (found == Rights::none) refuse(fmt::format("a wrong token for '{:.80}'", printable(std::string(target.path))));
  return found;
}

Server::Implementation::Response Server::Implementation::answer(const Request& request, Rights rights) {
  Response response(http::status::ok, request.version());
  response.set(http::field::content_type, "text/html; charset=utf-8");
  response.set(http::field::cache_control, "no-store");
  response.set("Referrer-Policy", "no-referrer");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Content-Security-Policy",
               fmt::format("default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
                           "img-src data: blob:; connect-src ws://{} ws://{}; base-uri 'none'; form-action 'none'; "
                           "frame-ancestors 'none'",
                           hosts_[0], hosts_[1]));
  response.keep_alive(false);
  const auto say = [&](http::status status, std::string_view what) {
    response.result(status);
    response.body() = fmt::format(
        "<!doctype html><html lang=\"en\"><title>mbk</title><main style=\"font:1.4rem sans-serif;margin:3rem\">"
        "<h1>{}</h1></main></html>\n",
        what);
  };
  if (rights == Rights::none) {
    say(http::status::forbidden, "This address is not right. Open the one that mbk run printed.");
  } else if (request.method() != http::verb::get) {
    say(http::status::method_not_allowed, "Only GET is answered here.");
  } else if (auto page = handlers_.page(split(view(request.target())).path)) {
    response.body() = std::move(*page);
  } else {
    say(http::status::not_found, "There is no such page.");
  }
  response.prepare_payload();
  return response;
}

void Server::Implementation::add(const std::shared_ptr<Viewer>& viewer) {
  viewers_.push_back(viewer);
  viewer_count_ = static_cast<int>(viewers_.size());
  choose_controller();
  viewer->introduce();
  for (std::size_t topic = 0; topic < kTopics; ++topic) {
    if (newest_[topic]) viewer->put(static_cast<Topic>(topic), newest_[topic]);
  }
}

void Server::Implementation::remove(const Viewer& viewer) {
  std::erase_if(viewers_, [&](const auto& other) { return other.get() == &viewer; });
  viewer_count_ = static_cast<int>(viewers_.size());
  choose_controller();
}

void Server::Implementation::choose_controller() {
  const auto controls = [](const auto& viewer) { return viewer->controls; };
  const auto found = std::ranges::find_if(viewers_, controls);
  if (found == viewers_.end()) {
    const auto next =
        std::ranges::find_if(viewers_, [](const auto& viewer) { return viewer->rights() == Rights::control; });
    if (next != viewers_.end()) (*next)->controls = true;
  }
  controlled_ = std::ranges::any_of(viewers_, controls);
}

void Server::Implementation::receive(Viewer& viewer, std::string_view text, bool is_text) {
  const auto refusal = [&](const std::string& why) {
    refuse(why);
    std::string quoted;
    for (const char c : why) quoted += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    viewer.put(Topic::refusal,
               std::make_shared<std::string>(fmt::format(R"({{"type":"refused","why":"{}"}})", quoted)));
  };
  auto command = is_text ? parse_command(text) : bad_usage("a message is no text", "reload the page");
  if (!command) {
    refusal(command.error().message);
    if (++viewer.malformed > kMostMalformed) viewer.close();
    return;
  }
  const bool may = viewer.controls || (viewer.rights() == Rights::control && command->action == Action::stop);
  if (!may) return refusal(fmt::format("'{}' from a page that only watches", console::text(command->action)));
  if (auto done = handlers_.command(*command); !done) refusal(done.error().line());
}

void Server::Implementation::send(Topic topic, Message message) {
  for (const auto& viewer : viewers_) viewer->put(topic, message);
  newest_[static_cast<std::size_t>(topic)] = std::move(message);
}

void Server::Implementation::send_frame(const Message& frame) {
  for (const auto& viewer : viewers_) dropped_ += viewer->put_frame(frame);
}

Server::Server(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Server::~Server() = default;

Result<std::unique_ptr<Server>> Server::listen(std::uint16_t port, Handlers handlers) {
  auto implementation = std::make_unique<Implementation>(std::move(handlers));
  if (auto ok = implementation->open(port); !ok) return tl::unexpected(ok.error());
  return std::unique_ptr<Server>(new Server(std::move(implementation)));
}

void Server::stop() {
  implementation_->stop();
}
std::uint16_t Server::port() const {
  return implementation_->port();
}
const std::string& Server::token() const {
  return implementation_->token();
}
const std::string& Server::viewing_token() const {
  return implementation_->viewing_token();
}
void Server::beat() {
  implementation_->beat_soon();
}
void Server::send(Topic topic, Message message) {
  implementation_->send(topic, std::move(message));
}
void Server::send_frame(const Message& frame) {
  implementation_->send_frame(frame);
}
Server::Status Server::status() const {
  return implementation_->status();
}

}  // namespace mbk::console
