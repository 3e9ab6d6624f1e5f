#pragma once

#include <memory>
#include <new>
#include <utility>

#include "mbk/base/core/linear_algebra.h"

namespace mbk {

/// The numbers of a signal, in their own memory or in an array of the caller. They are read like those of a Vector and
/// never written: copies share them.
class Samples : public Eigen::Map<const Vector> {
  using Map = Eigen::Map<const Vector>;

 public:
  Samples() : Map(nullptr, 0) {}
  Samples(Vector values)  // NOLINT(google-explicit-constructor): as a vector is a vector
      : Map(nullptr, 0), own_(std::make_shared<const Vector>(std::move(values))) {
    stand_at(own_->data(), own_->size());
  }
  /// @param at  `count` numbers that do not change    @param keeper  whatever owns them
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

 private:
  void stand_at(const double* at, Index count) { new (static_cast<Map*>(this)) Map(at, count); }

  std::shared_ptr<const Vector> own_;
  std::shared_ptr<const void> keeper_;  ///< of numbers stored elsewhere
};

}  // namespace mbk
