#include <fmt/format.h>

#include <algorithm>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "mbk/base/core/printable.h"
#include "mbk/experiment/console/server_parts.h"

namespace mbk::console {
namespace {

namespace websocket = beast::websocket;

constexpr auto kPageTime = 30s;     // for a page to its holder, who may sit at the end of a slow tunnel
constexpr int kMaxTurnedAway = 64;  // at once, where there is no descriptor for them
constexpr std::size_t kLongestRequest = 16 << 10;

/// In a time that says nothing of where they differ.
bool same(std::string_view one, std::string_view other) {
  if (one.size() != other.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    difference |= static_cast<unsigned>(one[i]) ^ static_cast<unsigned>(other[i]);
  }
  return difference == 0;
}

/// What a query gives for a key, "token="; nothing where that is there twice.
std::string_view value_in(std::string_view query, std::string_view key) {
  std::string_view found;
  int times = 0;
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    if (part.starts_with(key)) {
      found = part.substr(key.size());
      ++times;
    }
    query.remove_prefix(std::min(part.size() + 1, query.size()));
  }
  return times == 1 ? found : std::string_view();
}

struct Target {
  std::string_view path, token, page;
};

/// "/report/1?token=…", "/stream?token=…&page=…"
Target split(std::string_view target) {
  const std::string_view path = target.substr(0, target.find('?'));
  const std::string_view query = target.substr(std::min(path.size() + 1, target.size()));
  constexpr std::size_t kLongestKey = 64;
  return {path, value_in(query, "token="), value_in(query, "page=").substr(0, kLongestKey)};
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

  /// Logs input that is not HTTP. Browsers also open connections in advance without sending anything.
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
        server_.open_page(std::move(stream_), rights, std::move(place), split(view(request.target())).page, request);
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
  http::response<http::span_body<const char>> response_;
};

void Server::Implementation::welcome(tcp::socket socket) {
  if (strangers_.size() >= capacity_.strangers) {
    strangers_.front()->close();
    refuse(Refusal::crowd, fmt::format("the oldest of {} connections that have shown no token", capacity_.strangers));
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

Server::Implementation::Rights Server::Implementation::rights(std::string_view token) const {
  if (same(token, token_)) return Rights::control;
  return same(token, viewing_token_) ? Rights::watch : Rights::none;
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
  static const Page kWrong = sentence_page("This address is not right. Open the one that mbk run printed.");
  if (rights == Rights::none) return {http::status::forbidden, kWrong};
  if (!placed) {
    refuse(Refusal::crowd, fmt::format("a page behind {} with the same token", capacity_.holders));
    return {http::status::service_unavailable,
            sentence_page("Too many pages are open. Close one, and load this again.")};
  }
  if (request.method() != http::verb::get) {
    return {http::status::method_not_allowed, sentence_page("Only GET is answered here.")};
  }
  if (Page page = handlers_.page(split(view(request.target())).path); page.html)
    return {http::status::ok, std::move(page)};
  return {http::status::not_found, sentence_page("This page does not exist.")};
}

}  // namespace mbk::console
