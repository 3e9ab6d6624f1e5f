#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/experiment/console/command.h"
#include "mbk/experiment/console/outbox.h"
#include "mbk/experiment/console/page.h"

namespace mbk::console {

struct ServerTimes {
  std::chrono::milliseconds control_kept = std::chrono::seconds(10);  ///< for a page that has gone
  /// From one beat to the next: half of what screens need for a picture, so that there is something new for each.
  std::chrono::nanoseconds beat{1'000'000'000 / 120};
};

/// Pages and a stream of messages over HTTP and WebSocket, for browsers on this machine: it listens on 127.0.0.1 and
/// nowhere else. Whoever wants anything shows one of two tokens, which are made anew for each server: the operator's,
/// or that of viewers who only watch. The first page with the operator's token controls, until another one that has the
/// token takes control. When it goes, control is kept for the same page for a while, for it may only be loaded again;
/// then the next one with the token has it. A stop is taken from every page, whichever token it has.
///   Refused: a Host that is not this machine (a foreign name that was pointed here) or not named exactly once, an
///   Origin
/// that is not this server, a target that is no path, a wrong token, an unknown command. Refusals are counted and
/// logged as in Refusals.
///   Strangers, who have shown no token, cannot take what its holders need: a whole request has to come within 2 s;
///   where
/// there are too many of them, the oldest is closed for the newest; holders of each token have places of their own.
/// Together they are at most half of the descriptors that the process may have, and each costs a bounded room. A viewer
/// that takes nothing costs its Outbox and a buffer of the operating system; one that gives no sign of life is closed,
/// as is one that floods; no stop is lost for what else a page sends. Everything happens on
/// one thread, which no exception ends.
class Server {
 public:
  struct Handlers {
    std::function<Page(std::string_view path)> page;
    std::function<Result<void>(const Command&)> command;  ///< from a page that may give it
    std::function<void()> beat;                           ///< 120 times a second, or as ServerTimes says
    std::function<void(const std::string&)> log;          ///< one line about what was refused
  };

  /// @param port  0: any that is free
  /// @fails  usage: the port is taken.
  [[nodiscard]] static Result<std::unique_ptr<Server>> listen(std::uint16_t port, Handlers handlers,
                                                              ServerTimes times = {});
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  /// Closes what is open and returns when no handler will be called any more.
  void stop();

  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] const std::string& token() const;          ///< of the operator
  [[nodiscard]] const std::string& viewing_token() const;  ///< of those who watch

  /// Calls the handler `beat` as soon as it can be, on the server's thread. From any thread.
  void beat();

  /// To every viewer, and to those who come later. From `beat` and the other handlers only.
  void send(Topic topic, Message message);
  /// To every viewer. From the handlers only.
  void send_frame(const Message& frame);

  struct Status {
    int viewers = 0;
    bool controlled = false;           ///< a page controls, or control is kept for it
    std::uint64_t dropped_frames = 0;  ///< of viewers that did not take them, of all since the start
    std::uint64_t refused = 0;
  };
  /// From any thread.
  [[nodiscard]] Status status() const;

 private:
  class Implementation;
  explicit Server(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace mbk::console
