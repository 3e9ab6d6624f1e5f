#include "mbk/experiment/control/passivity_control.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mbk::control {
namespace {

Result<void> check(double sample_time, double limit, const char* name) {
  if (!(sample_time > 0.0 && std::isfinite(sample_time))) {
    return bad_usage(fmt::format("sample time {:g} s is not above zero", sample_time));
  }
  if (!(limit > 0.0 && std::isfinite(limit))) return bad_usage(fmt::format("{} {:g} is not above zero", name, limit));
  return {};
}

}  // namespace

void PassivityObserver::move(double position) noexcept {
  displacement_ = begun_ ? position - position_ : 0.0;
  energy_ += force_ * displacement_;
  position_ = position;
  begun_ = true;
}

void PassivityObserver::hold(double force) noexcept {
  force_ = force;
}

void PassivityObserver::step(double position, double force) noexcept {
  if (!std::isfinite(position) || !std::isfinite(force)) {
    begun_ = false;
    return;
  }
  move(position);
  hold(force);
}

Result<SeriesPassivityController> SeriesPassivityController::create(double sample_time, double largest_damping) {
  MBK_TRY(check(sample_time, largest_damping, "largest damping"));
  return SeriesPassivityController(sample_time, largest_damping);
}

double SeriesPassivityController::step(double position, double force) noexcept {
  if (!std::isfinite(position) || !std::isfinite(force)) {
    observer_.step(position, force);
    return force;
  }
  observer_.move(position);
  const double moved = observer_.displacement(), energy = observer_.energy();
  double out = force;
  if (energy < 0.0 && moved != 0.0) {
    const double velocity = moved / sample_time_;
    // where the motion is so slow that v² vanishes, the ratio is infinite and the limit counts
    out += std::min(-energy / (sample_time_ * velocity * velocity), largest_damping_) * velocity;
  }
  observer_.hold(out);
  return out;
}

Result<ParallelPassivityController> ParallelPassivityController::create(double sample_time, double largest_admittance) {
  MBK_TRY(check(sample_time, largest_admittance, "largest admittance"));
  return ParallelPassivityController(sample_time, largest_admittance);
}

double ParallelPassivityController::step(double force, double velocity) noexcept {
  if (!std::isfinite(force) || !std::isfinite(velocity)) return velocity;
  const double energy = energy_ + sample_time_ * force * velocity;
  if (energy >= 0.0 || force == 0.0) {
    energy_ = energy;
    return velocity;
  }
  const double beta = std::min(-energy / (sample_time_ * force * force), largest_admittance_);
  energy_ = energy + sample_time_ * beta * force * force;
  return velocity + beta * force;
}

}  // namespace mbk::control
