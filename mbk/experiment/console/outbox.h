#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

namespace mbk::console {

/// Bytes that several viewers share.
using Message = std::shared_ptr<const std::string>;

/// Messages of which only the newest counts.
enum class Topic { you, texts, state, session, estimate, refusal };
inline constexpr std::size_t kTopics = 6;

/// What still has to go to one viewer, in a room that does not grow: of each topic the newest message, and so many
/// frames of samples. Where one too many comes, the oldest frame is dropped and counted.
class Outbox {
 public:
  explicit Outbox(std::size_t max_frames) : max_frames_(max_frames) {}

  void put(Topic topic, Message message) { newest_[static_cast<std::size_t>(topic)] = std::move(message); }
  void put_frame(Message frame);

  struct Outgoing {
    Message message;
    bool binary = false;
  };
  /// The next one to send: topics before frames. Nothing where there is none.
  [[nodiscard]] std::optional<Outgoing> take();

  [[nodiscard]] std::size_t frames() const { return frames_.size(); }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  std::size_t max_frames_;
  std::array<Message, kTopics> newest_;
  std::deque<Message> frames_;
  std::uint64_t dropped_ = 0;
};

}  // namespace mbk::console
