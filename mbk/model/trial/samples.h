#pragma once

#include <atomic>
#include <memory>
#include <new>
#include <utility>

#include "mbk/base/core/linear_algebra.h"

namespace mbk {

/// The numbers of a signal, in memory of their own or where they stand already: in an array of whoever measures it. To
/// be read as a Vector is; copies share the numbers, and what is written goes to memory that nobody else has.
class Samples : public Eigen::Map<const Vector> {
  using Map = Eigen::Map<const Vector>;

 public:
  Samples() : Map(nullptr, 0) {}
  Samples(Vector values)  // NOLINT(google-explicit-constructor): as a vector is a vector
      : Map(nullptr, 0), own_(std::make_shared<Vector>(std::move(values))) {
    stand_at(own_->data(), own_->size());
  }
  template <class Derived>
  Samples(const Eigen::DenseBase<Derived>& values)  // NOLINT(google-explicit-constructor): the same
      : Samples(Vector(values)) {}
  /// @param at  `count` numbers that stay as they are    @param keeper  whatever owns them
  Samples(const double* at, Index count, std::shared_ptr<const void> keeper)
      : Map(at, count), keeper_(std::move(keeper)) {}
  Samples(const Samples& other) noexcept : Map(other.data(), other.size()), own_(other.own_), keeper_(other.keeper_) {}
  Samples(Samples&& other) noexcept
      : Map(other.data(), other.size()), own_(std::move(other.own_)), keeper_(std::move(other.keeper_)) {
    other.stand_at(nullptr, 0);
  }
  Samples& operator=(Samples other) noexcept {
    stand_at(other.data(), other.size());
    own_ = std::move(other.own_);
    keeper_ = std::move(other.keeper_);
    return *this;
  }
  ~Samples() = default;

  /// Whether they stand in memory that nobody else has.
  [[nodiscard]] bool is_alone() const {
    if (own_.use_count() != 1) return false;
    std::atomic_thread_fence(std::memory_order_acquire);  // after what another thread did before it let go
    return true;
  }

  /// To write to, in memory that nobody else has: what is shared is copied first.
  [[nodiscard]] Eigen::Map<Vector> edit() {
    if (!is_alone()) *this = Samples(Vector(*this));
    return {own_->data(), own_->size()};
  }
  using Map::operator[];
  double& operator[](Index i) {
    if (!is_alone()) *this = Samples(Vector(*this));
    return (*own_)[i];
  }

  /// Memory of its own, not set to anything; what has that size already stays as it is.
  void resize(Index count) {
    if (count != size()) *this = Samples(Vector(count));
  }
  Samples& setConstant(double value) { return *this = Samples(Vector::Constant(size(), value)); }
  Samples& setZero() { return setConstant(0.0); }

  /// The numbers as a vector, without a copy where nobody else has them. Nothing is left here.
  [[nodiscard]] Vector take() {
    Vector values = is_alone() ? std::move(*own_) : Vector(*this);
    *this = Samples();
    return values;
  }

 private:
  void stand_at(const double* at, Index count) { new (static_cast<Map*>(this)) Map(at, count); }

  std::shared_ptr<Vector> own_;
  std::shared_ptr<const void> keeper_;  ///< of numbers that stand elsewhere
};

}  // namespace mbk
