#include "mbk/experiment/console/server.h"

#include <fmt/format.h>
#include <sys/random.h>
#include <sys/resource.h>

#include <algorithm>
#include <boost/asio/post.hpp>

#include "mbk/base/core/printable.h"
#include "mbk/base/realtime/signal_stack.h"
#include "mbk/experiment/console/server_parts.h"

namespace mbk::console {
namespace {

constexpr auto kNoDescriptor = 100ms;  // until it is tried again

Capacity capacity() {
  Capacity capacity;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return capacity;
  const auto descriptors = static_cast<std::size_t>(limit.rlim_cur);
  capacity.strangers = std::clamp<std::size_t>(descriptors / 4, 1, kMaxStrangers);
  capacity.holders = std::clamp<std::size_t>(descriptors / 8, 2, kMaxHolders);
  return capacity;
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

}  // namespace

Server::Implementation::Implementation(Handlers handlers, ServerTimes times)
    : handlers_(std::move(handlers)), times_(times), token_(random_token()), viewing_token_(random_token()) {}

Server::Implementation::~Implementation() {
  stop();
}

void Server::Implementation::stop() {
  context_.stop();
  if (thread_.joinable()) thread_.join();
  (void)guarded([this] { sum_up(true); });
}

Result<void> Server::Implementation::open(std::uint16_t port) {
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
  capacity_ = capacity();
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

void Server::Implementation::beat_soon() {
  net::post(context_, [this] { (void)guarded([this] { beat(); }); });
}

void Server::Implementation::refuse(Refusal kind, const std::string& why) {
  ++refused_;
  if (refusals_.take(kind, std::chrono::steady_clock::now())) handlers_.log("refused: " + printable(why));
}

void Server::Implementation::sum_up(bool last) {
  if (const auto line = refusals_.summary(std::chrono::steady_clock::now(), last)) handlers_.log("refused: " + *line);
}

void Server::Implementation::failed(const char* what) noexcept {
  try {
    refuse(Refusal::failure, fmt::format("{}: {}", word_of(Refusal::failure), what));
  } catch (...) {  // without memory there is no line either; it is counted
  }
}

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

void Server::Implementation::wait_for_beat() {
  next_beat_ = std::max(next_beat_ + times_.beat, std::chrono::steady_clock::now());
  timer_.expires_at(next_beat_);
  timer_.async_wait([this](error_code error) {
    if (error) return;
    wait_for_beat();
    (void)guarded([this] { beat(); });
  });
}

Server::Server(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Server::~Server() = default;

Result<std::unique_ptr<Server>> Server::listen(std::uint16_t port, Handlers handlers, ServerTimes times) {
  auto implementation = std::make_unique<Implementation>(std::move(handlers), times);
  MBK_TRY(implementation->open(port));
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
