#include "mbk/experiment/console/server.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <unistd.h>

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
#include <exception>
#include <list>
#include <thread>

#include "mbk/base/core/printable.h"
#include "mbk/base/realtime/signal_stack.h"
#include "mbk/experiment/console/refusals.h"

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
constexpr auto kRequestTime = 2s;       // for a whole request, and for the answer to a stranger
constexpr auto kPageTime = 30s;         // for a page to its holder, who may sit at the end of a slow tunnel
constexpr auto kSilence = 20s;          // of a viewer, after which it is gone
constexpr auto kNoDescriptor = 100ms;   // until it is tried again
constexpr std::size_t kMaxFrames = 60;  // half a second
constexpr int kSendBuffer = 256 << 10;  // [bytes] of the operating system
constexpr int kMaxTurnedAway = 64;      // in that time
constexpr std::size_t kMaxStrangers = 256;
constexpr std::size_t kMaxHolders = 24;           // connections with the operator's token; as many with that of viewers
constexpr std::size_t kLongestMessage = 8 << 10;  // [bytes]
constexpr std::size_t kLongestRequest = 16 << 10;
constexpr int kMaxMalformed = 20;  // messages of one viewer

/// So many at once, and so many a second.
struct Allowance {
  double burst, per_second;
};
constexpr Allowance kMessages = {60.0, 20.0}, kPings = {20.0, 5.0};

/// What is left of an allowance.
class Bucket {
 public:
  explicit Bucket(Allowance allowance) : allowance_(allowance), left_(allowance.burst) {}

  /// @returns  false where nothing is left
  bool take() {
    const auto now = std::chrono::steady_clock::now();
    const double passed = std::chrono::duration<double>(now - last_).count();
    left_ = std::min(allowance_.burst, left_ + allowance_.per_second * passed);
    last_ = now;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  Allowance allowance_;
  double left_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// A descriptor that is held for the moment when there is no other.
class Spare {
 public:
  Spare() { take(); }
  Spare(const Spare&) = delete;
  Spare& operator=(const Spare&) = delete;
  ~Spare() { give(); }

  void take() {
    if (descriptor_ < 0) descriptor_ = open("/dev/null", O_RDONLY | O_CLOEXEC);
  }
  void give() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }

 private:
  int descriptor_ = -1;
};

/// How many connections there may be of each sort, so that the recording always finds a descriptor.
struct Most {
  std::size_t strangers = kMaxStrangers, holders = kMaxHolders;
};

Most max_connections() {
  Most most;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return most;
  const auto descriptors = static_cast<std::size_t>(limit.rlim_cur);
  most.strangers = std::clamp<std::size_t>(descriptors / 4, 1, kMaxStrangers);
  most.holders = std::clamp<std::size_t>(descriptors / 8, 2, kMaxHolders);
  return most;
}

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

/// "/report/1?token=…". A token that is there twice is none.
Target split(std::string_view target) {
  Target found{target.substr(0, target.find('?')), {}};
  constexpr std::string_view kKey = "token=";
  std::string_view query = target.substr(std::min(found.path.size() + 1, target.size()));
  int tokens = 0;
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    if (part.starts_with(kKey)) {
      found.token = part.substr(kKey.size());
      ++tokens;
    }
    query.remove_prefix(std::min(part.size() + 1, query.size()));
  }
  if (tokens > 1) found.token = {};
  return found;
}

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

/// What a field says that is there exactly once; else nothing.
template <class Request>
std::string_view only(const Request& request, http::field name) {
  return request.count(name) == 1 ? view(request[name]) : std::string_view();
}

/// A page of one sentence.
Page sentence_page(std::string_view what) {
  return make_page(
      fmt::format("<!doctype html><html lang=\"en\"><title>mbk</title>"
                  "<style>main{{font:1.4rem sans-serif;margin:3rem}}</style><main><h1>{}</h1></main></html>\n",
                  what));
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
    (void)guarded([this] { sum_up(true); });
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
                       "choose another --port, or omit it");
    }
    port_ = acceptor_.local_endpoint().port();
    hosts_ = {fmt::format("127.0.0.1:{}", port_), fmt::format("localhost:{}", port_)};
    max_ = max_connections();
    accept();
    next_beat_ = std::chrono::steady_clock::now();
    wait_for_beat();
    thread_ = std::thread([this] {
      const realtime::SignalStack stack;
      // what a handler throws leaves run(), which goes on with the others when it is called again
      while (!guarded([this] { context_.run(); })) {
      }
    });
    return {};
  }

  /// What there is goes out.
  void beat();
  void beat_soon() {
    net::post(context_, [this] { (void)guarded([this] { beat(); }); });
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
  using Response = http::response<http::span_body<const char>>;

  void accept();
  void welcome(tcp::socket socket);
  bool make_room();
  void wait_for_beat();

  void refuse(Refusal kind, const std::string& why) {
    ++refused_;
    if (refusals_.take(kind, std::chrono::steady_clock::now())) handlers_.log("refused: " + printable(why));
  }
  /// What was refused and not said.
  void sum_up(bool last = false) {
    if (const auto line = refusals_.summary(std::chrono::steady_clock::now(), last)) handlers_.log("refused: " + *line);
  }

  /// Does it; what it throws is said.   @returns  false where it threw
  template <class Work>
  bool guarded(const Work& work) noexcept {
    try {
      work();
      return true;
    } catch (const std::exception& error) {
      failed(error.what());
    } catch (...) {
      failed("an exception");
    }
    return false;
  }
  void failed(const char* what) noexcept {
    try {
      refuse(Refusal::failure, fmt::format("{}: {}", word_of(Refusal::failure), what));
    } catch (...) {  // without memory there is no line either; it is counted
    }
  }

  [[nodiscard]] bool known(std::string_view host) const { return std::ranges::find(hosts_, host) != hosts_.end(); }

  /// What the request may: nothing, watch, or control.
  enum class Rights { none, watch, control };
  [[nodiscard]] Rights rights(std::string_view token) const {
    if (same(token, token_)) return Rights::control;
    return same(token, viewing_token_) ? Rights::watch : Rights::none;
  }

  /// The place of a connection that has shown a token; it is given back when it goes.
  struct GiveBack {
    void operator()(std::size_t* taken) const { --*taken; }
  };
  using Place = std::unique_ptr<std::size_t, GiveBack>;
  /// Null where none is left.
  [[nodiscard]] Place place(Rights rights) {
    std::size_t& taken = rights == Rights::control ? controlling_ : watching_;
    if (taken >= max_.holders) return nullptr;
    return Place(&++taken);
  }

  Rights admit(const Request& request);
  [[nodiscard]] std::pair<http::status, Page> page_for(const Request& request, Rights rights, bool placed);
  void add(const std::shared_ptr<Viewer>& viewer);
  void remove(Viewer& viewer);
  void choose_controller();
  void receive(Viewer& viewer, std::string_view text, bool is_text);

  Handlers handlers_;
  std::string token_, viewing_token_;
  // outlive the connections, which end with the context
  Most max_;
  std::size_t controlling_ = 0, watching_ = 0;  // connections that have shown a token
  std::list<Connection*> strangers_;            // the others, oldest first
  Refusals refusals_;
  Spare spare_;
  net::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  net::steady_timer timer_{context_}, retry_{context_};
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
  Viewer(Implementation& server, beast::tcp_stream stream, Rights rights, Place place)
      : server_(server), place_(std::move(place)), socket_(std::move(stream)), rights_(rights) {}
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  void run(const Request& request) {
    beast::get_lowest_layer(socket_).expires_never();
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = kRequestTime;
    timeout.idle_timeout = kSilence;
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(kLongestMessage);
    // browsers do not ping by themselves; every ping takes an answer
    socket_.control_callback([this](websocket::frame_type kind, beast::string_view) {
      if (kind != websocket::frame_type::ping || pings_.take()) return;
      server_.refuse(Refusal::haste, "a page that floods with pings");
      close();
    });
    error_code ignored;
    beast::get_lowest_layer(socket_).socket().set_option(net::socket_base::send_buffer_size(kSendBuffer), ignored);
    beast::get_lowest_layer(socket_).socket().set_option(tcp::no_delay(true), ignored);
    socket_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->work([&] {
        self->server_.add(self);
        self->read();
      });
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
  Bucket messages{kMessages};

 private:
  /// Does it; the page goes where that throws.
  template <class Work>
  void work(const Work& work) {
    if (server_.guarded(work)) return;
    close();
    (void)server_.guarded([this] { server_.remove(*this); });
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      self->work([&] {
        if (error) {
          if (error == websocket::error::message_too_big) {
            self->server_.refuse(Refusal::too_long, "a message that is too long");
          }
          self->server_.remove(*self);
          return;
        }
        const auto data = self->buffer_.cdata();
        self->server_.receive(*self, {static_cast<const char*>(data.data()), data.size()}, self->socket_.got_text());
        self->buffer_.consume(self->buffer_.size());
        self->read();
      });
    });
  }

  void write() {
    if (sending_) return;
    auto outgoing = outbox_.take();
    if (!outgoing) return;
    sending_ = std::move(outgoing->message);
    socket_.binary(outgoing->binary);
    socket_.async_write(net::buffer(*sending_), [self = shared_from_this()](error_code error, std::size_t) {
      self->work([&] {
        self->sending_ = nullptr;
        if (error) return self->close();
        self->write();
      });
    });
  }

  Implementation& server_;
  Place place_;
  websocket::stream<beast::tcp_stream> socket_;
  Rights rights_;
  beast::flat_buffer buffer_;
  Outbox outbox_{kMaxFrames};
  Message sending_;
  bool said_ = false, said_controls_ = false;
  std::uint64_t said_dropped_ = 0;
  Bucket pings_{kPings};
};

/// A connection until it is known what it wants: a stranger, until it has shown a token.
class Server::Implementation::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Implementation& server, tcp::socket socket)
      : server_(server), stream_(std::move(socket)), at_(server.strangers_.insert(server.strangers_.end(), this)) {
    parser_.header_limit(kLongestMessage);
    parser_.body_limit(kLongestMessage);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { leave_strangers(); }

  void run() {
    stream_.expires_after(kRequestTime);
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t) {
      (void)self->server_.guarded([&] { error ? self->complain(error) : self->serve(); });
    });
  }

  void close() {
    leave_strangers();
    stream_.close();
  }

 private:
  void leave_strangers() {
    if (stranger_) server_.strangers_.erase(at_);
    stranger_ = false;
  }

  /// Said is what is no HTTP. Browsers connect without a word too, to be quicker when there is one.
  void complain(error_code error) {
    if (error == http::error::end_of_stream || error == http::error::partial_message ||
        error.category() != http::make_error_code(http::error::end_of_stream).category()) {
      return;
    }
    server_.refuse(Refusal::request, "a request that is not understood: " + error.message());
  }

  void serve() {
    const Request& request = parser_.get();
    const Rights rights = server_.admit(request);
    Place place;
    if (rights != Rights::none) {
      leave_strangers();
      place = server_.place(rights);
      if (place && websocket::is_upgrade(request)) {
        std::make_shared<Viewer>(server_, std::move(stream_), rights, std::move(place))->run(request);
        return;
      }
    }
    place_ = std::move(place);
    auto [status, page] = server_.page_for(request, rights, place_ != nullptr);
    html_ = std::move(page.html);
    response_.result(status);
    response_.version(request.version());
    response_.set(http::field::content_type, "text/html; charset=utf-8");
    response_.set(http::field::cache_control, "no-store");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set("Content-Security-Policy",
                  fmt::format("default-src 'none'; {}; img-src data: blob:; connect-src ws://{} ws://{}; "
                              "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
                              page.sources, server_.hosts_[0], server_.hosts_[1]));
    response_.keep_alive(false);
    response_.body() = {html_->data(), html_->size()};
    response_.prepare_payload();
    if (place_)
      stream_.expires_after(kPageTime);
    else
      stream_.expires_after(kRequestTime);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  Implementation& server_;
  Place place_;
  beast::tcp_stream stream_;
  std::list<Connection*>::iterator at_;
  bool stranger_ = true;
  beast::flat_buffer buffer_{kLongestRequest};
  http::request_parser<http::string_body> parser_;
  Message html_;
  Response response_;
};

void Server::Implementation::accept() {
  acceptor_.async_accept([this](error_code error, tcp::socket socket) {
    if (error == net::error::operation_aborted) return;
    bool go_on = error == net::error::connection_aborted;
    (void)guarded([&] {
      if (!error) {
        go_on = true;
        welcome(std::move(socket));
      } else if (!go_on) {
        go_on = make_room();
        refuse(Refusal::descriptors, "a connection: " + error.message());
      }
    });
    if (go_on) return accept();
    retry_.expires_after(kNoDescriptor);
    retry_.async_wait([this](error_code stopped) {
      if (!stopped) accept();
    });
  });
}

void Server::Implementation::welcome(tcp::socket socket) {
  if (strangers_.size() >= max_.strangers) {
    strangers_.front()->close();
    refuse(Refusal::crowd, fmt::format("the oldest of {} connections that have shown no token", max_.strangers));
  }
  std::make_shared<Connection>(*this, std::move(socket))->run();
}

/// Out of descriptors.   @returns  whether one is free now
bool Server::Implementation::make_room() {
  if (!strangers_.empty()) {
    strangers_.front()->close();
    return true;
  }
  // whoever waits learns that it is in vain
  spare_.give();
  error_code error;
  acceptor_.non_blocking(true, error);
  for (int k = 0; k < kMaxTurnedAway && !error; ++k) {
    tcp::socket refused(context_);
    acceptor_.accept(refused, error);
  }
  spare_.take();
  return false;
}

void Server::Implementation::beat() {
  handlers_.beat();
  for (const auto& viewer : viewers_) viewer->introduce();
  sum_up();
  spare_.take();
}

void Server::Implementation::wait_for_beat() {
  next_beat_ = std::max(next_beat_ + kBeat, std::chrono::steady_clock::now());
  timer_.expires_at(next_beat_);
  timer_.async_wait([this](error_code error) {
    if (error) return;
    wait_for_beat();
    (void)guarded([this] { beat(); });
  });
}

Server::Implementation::Rights Server::Implementation::admit(const Request& request) {
  const std::string_view host = only(request, http::field::host);
  const std::string_view origin = only(request, http::field::origin);
  const std::string_view asked = view(request.target());
  if (!known(host)) {
    const std::size_t named = request.count(http::field::host);
    refuse(Refusal::host, named == 1 ? fmt::format("the host '{:.80}'", printable(std::string(host)))
                                     : fmt::format("a request that names {} hosts", named));
    return Rights::none;
  }
  constexpr std::string_view kScheme = "http://";
  const bool foreign = !origin.starts_with(kScheme) || !known(origin.substr(kScheme.size()));
  if (foreign && (websocket::is_upgrade(request) || request.count(http::field::origin) > 0)) {
    refuse(Refusal::origin, fmt::format("the origin '{:.80}'", printable(std::string(origin))));
    return Rights::none;
  }
  if (!asked.starts_with('/')) {
    refuse(Refusal::request, fmt::format("'{:.80}' instead of a path", printable(std::string(asked))));
    return Rights::none;
  }
  const Target target = split(asked);
  const Rights found = rights(target.token);
  if (found == Rights::none) {
    refuse(Refusal::token, fmt::format("a wrong token for '{:.80}'", printable(std::string(target.path))));
  }
  return found;
}

std::pair<http::status, Page> Server::Implementation::page_for(const Request& request, Rights rights, bool placed) {
  static const Page wrong = sentence_page("This address is not right. Open the one that mbk run printed.");
  if (rights == Rights::none) return {http::status::forbidden, wrong};
  if (!placed) {
    refuse(Refusal::crowd, fmt::format("a page behind {} with the same token", max_.holders));
    return {http::status::service_unavailable,
            sentence_page("Too many pages are open. Close one, and load this again.")};
  }
  if (request.method() != http::verb::get) {
    return {http::status::method_not_allowed, sentence_page("Only GET is answered here.")};
  }
  if (Page page = handlers_.page(split(view(request.target())).path); page.html)
    return {http::status::ok, std::move(page)};
  return {http::status::not_found, sentence_page("There is no such page.")};
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

void Server::Implementation::remove(Viewer& viewer) {
  std::erase_if(viewers_, [&](const auto& other) { return other.get() == &viewer; });
  viewer.controls = false;
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
  const auto refusal = [&](Refusal kind, const std::string& why) {
    refuse(kind, why);
    std::string quoted;
    for (const char c : printable(why)) quoted += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    viewer.put(Topic::refusal,
               std::make_shared<std::string>(fmt::format(R"({{"type":"refused","why":"{}"}})", quoted)));
  };
  const bool in_time = viewer.messages.take();
  auto command = is_text ? parse_command(text) : bad_usage("a message is no text", "reload the page");
  if (!command) {
    refusal(Refusal::message, command.error().message);
    if (++viewer.malformed > kMaxMalformed) viewer.close();
    return;
  }
  const bool stop = command->action == Action::stop;
  if (!in_time && !(stop && viewer.rights() == Rights::control)) {
    refusal(Refusal::haste, fmt::format("more than {} messages a second", kMessages.per_second));
    // a page of the operator's stays: a stop may be among what comes next
    if (viewer.rights() != Rights::control && ++viewer.malformed > kMaxMalformed) viewer.close();
    return;
  }
  const bool may = viewer.controls || (viewer.rights() == Rights::control && stop);
  if (!may) {
    return refusal(Refusal::command, fmt::format("'{}' from a page that only watches", word_of(command->action)));
  }
  if (auto done = handlers_.command(*command); !done) refusal(Refusal::command, done.error().line());
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
