#include <fmt/format.h>

#include <algorithm>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>

#include "mbk/base/core/printable.h"
#include "mbk/experiment/console/messages.h"
#include "mbk/experiment/console/server_parts.h"

namespace mbk::console {
namespace {

namespace websocket = beast::websocket;

constexpr auto kSilence = 20s;          // of a viewer, after which it is gone
constexpr std::size_t kMaxFrames = 60;  // half a second
constexpr int kSendBuffer = 256 << 10;  // [bytes] of the operating system
constexpr int kMaxMalformed = 20;       // messages of one viewer

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

}  // namespace

/// A page that is open: the stream of messages to it, and its commands.
class Server::Implementation::Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  /// @param key  by which the page is known when it is loaded again; may be empty
  Viewer(Implementation& server, beast::tcp_stream stream, Rights rights, Place place, std::string_view key)
      : server_(server), place_(std::move(place)), socket_(std::move(stream)), rights_(rights), key_(key) {}
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

  /// Says who controls, where that has changed or frames were dropped.
  void introduce() {
    const std::string_view control = server_.control_for(*this);
    if (said_control_ == control && said_dropped_ == outbox_.dropped()) return;
    said_control_ = control;
    said_dropped_ = outbox_.dropped();
    put(Topic::you, message(You{control, rights_ == Rights::control, said_dropped_}));
  }

  void close() { beast::get_lowest_layer(socket_).close(); }

  [[nodiscard]] Rights rights() const { return rights_; }
  [[nodiscard]] const std::string& key() const { return key_; }
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
  websocket::stream<beast::tcp_stream, false> socket_;  // uncompressed
  Rights rights_;
  std::string key_;
  beast::flat_buffer buffer_;
  Outbox outbox_{kMaxFrames};
  Message sending_;
  std::string_view said_control_;  // empty: nothing was said
  std::uint64_t said_dropped_ = 0;
  Bucket pings_{kPings};
};

void Server::Implementation::beat() {
  handlers_.beat();
  choose_controller();
  for (const auto& viewer : viewers_) viewer->introduce();
  sum_up();
  spare_.take();
}

void Server::Implementation::open_page(beast::tcp_stream stream, Rights rights, Place place, std::string_view key,
                                       const Request& request) {
  std::make_shared<Viewer>(*this, std::move(stream), rights, std::move(place), key)->run(request);
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
  if (controller_ == &viewer) {
    controller_ = nullptr;
    kept_until_ = std::chrono::steady_clock::now() + times_.control_kept;
  }
  std::erase_if(viewers_, [&](const auto& other) { return other.get() == &viewer; });
  viewer_count_ = static_cast<int>(viewers_.size());
  choose_controller();
}

void Server::Implementation::choose_controller() {
  if (controller_ != nullptr) return;
  if (std::chrono::steady_clock::now() >= kept_until_) kept_for_.clear();
  const auto next = std::ranges::find_if(viewers_, [&](const auto& viewer) {
    return viewer->rights() == Rights::control && (kept_for_.empty() || viewer->key() == kept_for_);
  });
  if (next != viewers_.end()) give_control(**next);
  controlled_ = controller_ != nullptr || !kept_for_.empty();
}

void Server::Implementation::give_control(Viewer& viewer) {
  controller_ = &viewer;
  kept_for_ = viewer.key();
  controlled_ = true;
}

std::string_view Server::Implementation::control_for(const Viewer& viewer) const {
  if (controller_ != nullptr) return controller_ == &viewer ? "here" : "elsewhere";
  return kept_for_.empty() ? "nobody" : "kept";
}

void Server::Implementation::receive(Viewer& viewer, std::string_view text, bool is_text) {
  const auto refusal = [&](Refusal kind, const std::string& why) {
    refuse(kind, why);
    viewer.put(Topic::refusal, message(Refused{printable(why)}));
  };
  const bool in_time = viewer.messages.take();
  auto command = is_text ? parse_command(text) : bad_usage("a message is no text", "reload the page");
  if (!command) {
    refusal(Refusal::message, command.error().message);
    if (++viewer.malformed > kMaxMalformed) viewer.close();
    return;
  }
  const bool stop = command->action == Action::stop;
  if (!in_time && !stop) {
    refusal(Refusal::haste, fmt::format("more than {} messages a second", kMessages.per_second));
    // a page of the operator's stays: a stop may be among what comes next
    if (viewer.rights() != Rights::control && ++viewer.malformed > kMaxMalformed) viewer.close();
    return;
  }
  if (command->action == Action::control && viewer.rights() == Rights::control) return give_control(viewer);
  if (!stop && controller_ != &viewer) {
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

}  // namespace mbk::console
