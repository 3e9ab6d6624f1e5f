#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace mbk::realtime {

/// Items from one thread to one other, in order, without lock or allocation after it is made. What does not fit is
/// dropped and counted: the producer never waits.
template <class Item>
class BoundedRing {
  static_assert(std::is_trivially_copyable_v<Item>);

 public:
  explicit BoundedRing(std::size_t capacity) : queue_(capacity), capacity_(capacity) {}

  /// For the producer. False if the ring is full: the item is dropped and counted.
  bool push(const Item& item) noexcept {
    if (queue_.push(item)) return true;
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }

  /// By the consumer: moves up to `most` items out.   @returns how many
  std::size_t pop(Item* items, std::size_t most) noexcept { return queue_.pop(items, most); }

  /// By the producer: how many items fit now.
  [[nodiscard]] std::size_t room() const noexcept { return queue_.write_available(); }

  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  boost::lockfree::spsc_queue<Item> queue_;
  std::size_t capacity_;
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace mbk::realtime
