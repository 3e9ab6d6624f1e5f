#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <list>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "mbk/experiment/console/refusals.h"
#include "mbk/experiment/console/server.h"

/// What the sources of the server share: server.cpp listens and keeps time, server_connection.cpp finds out who asks,
/// server_viewer.cpp speaks with pages. For them only.
namespace mbk::console {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
using boost::system::error_code;
using net::ip::tcp;
using namespace std::chrono_literals;

inline constexpr auto kRequestTime = 2s;  // for a whole request, and for the answer to a stranger
inline constexpr std::size_t kMaxStrangers = 256;
inline constexpr std::size_t kMaxHolders = 24;  // connections with the operator's token; as many with that of viewers
inline constexpr std::size_t kLongestMessage = 8 << 10;  // [bytes]

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
struct Capacity {
  std::size_t strangers = kMaxStrangers, holders = kMaxHolders;
};

class Server::Implementation {
 public:
  Implementation(Handlers handlers, ServerTimes times);
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;
  ~Implementation();

  void stop();
  Result<void> open(std::uint16_t port);

  /// What there is goes out.
  void beat();
  void beat_soon();  ///< from any thread

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

  void accept();
  void welcome(tcp::socket socket);
  bool make_room();
  void wait_for_beat();

  void refuse(Refusal kind, const std::string& why);
  /// What was refused and not said.
  void sum_up(bool last = false);

  /// Does it and logs exceptions.   @returns  false if it threw
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
  void failed(const char* what) noexcept;

  [[nodiscard]] bool known(std::string_view host) const { return std::ranges::find(hosts_, host) != hosts_.end(); }

  /// What the request may: nothing, watch, or control.
  enum class Rights { none, watch, control };
  [[nodiscard]] Rights rights(std::string_view token) const;

  /// The place of a connection that has shown a token; it is given back when it goes.
  struct GiveBack {
    void operator()(std::size_t* taken) const { --*taken; }
  };
  using Place = std::unique_ptr<std::size_t, GiveBack>;
  /// Null where none is left.
  [[nodiscard]] Place place(Rights rights) {
    std::size_t& taken = rights == Rights::control ? controlling_ : watching_;
    if (taken >= capacity_.holders) return nullptr;
    return Place(&++taken);
  }

  Rights admit(const Request& request);
  [[nodiscard]] std::pair<http::status, Page> page_for(const Request& request, Rights rights, bool placed);
  /// The connection becomes one of a page.
  void open_page(beast::tcp_stream stream, Rights rights, Place place, std::string_view key, const Request& request);
  void add(const std::shared_ptr<Viewer>& viewer);
  void remove(Viewer& viewer);
  void choose_controller();
  void give_control(Viewer& viewer);
  /// Who controls, as the viewer is told: "here", "elsewhere", "kept", "nobody".
  [[nodiscard]] std::string_view control_for(const Viewer& viewer) const;
  void receive(Viewer& viewer, std::string_view text, bool is_text);

  Handlers handlers_;
  ServerTimes times_;
  std::string token_, viewing_token_;
  // outlive the connections, which end with the context
  Capacity capacity_;
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
  Viewer* controller_ = nullptr;                // one of them
  std::string kept_for_;                        // key of the page that controlled last; empty: control is not kept
  std::chrono::steady_clock::time_point kept_until_;
  std::array<Message, kTopics> newest_;
  std::atomic<int> viewer_count_{0};
  std::atomic<bool> controlled_{false};
  std::atomic<std::uint64_t> dropped_{0}, refused_{0};
  std::thread thread_;
};

}  // namespace mbk::console
