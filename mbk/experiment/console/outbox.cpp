#include "mbk/experiment/console/outbox.h"

#include <utility>

namespace mbk::console {

void Outbox::put_frame(Message frame) {
  if (frames_.size() == max_frames_) {
    frames_.pop_front();
    ++dropped_;
  }
  frames_.push_back(std::move(frame));
}

std::optional<Outbox::Outgoing> Outbox::take() {
  for (Message& newest : newest_) {
    if (newest) return Outgoing{std::exchange(newest, nullptr), false};
  }
  if (frames_.empty()) return std::nullopt;
  Outgoing outgoing{std::move(frames_.front()), true};
  frames_.pop_front();
  return outgoing;
}

}  // namespace mbk::console
