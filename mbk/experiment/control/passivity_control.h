#pragma once

#include "mbk/base/core/result.h"

namespace mbk::control {

/// Energy that a one-port has taken since the beginning [J]: of a wall, a teleoperator with all that is behind it, an
/// arm. Its force is held from sample to sample, so that this is exact (Ryu, Preusche, Hannaford & Hirzinger 2005;
/// Dyck 2013 §3.3.1 in continuous time):
///   E(n) = E(n−1) + f(n−1) (x(n) − x(n−1)),   E(0) = 0
/// Below zero it has given more than it ever took, which no passive one-port without initial energy does.
/// Allocation-free.
class PassivityObserver {
 public:
  /// @param position  x(n) [m]
  /// @param force  f(n) [N] on the one-port, positive with x, held until the next sample
  /// A sample that is not finite is not counted, and neither is the motion up to the next finite one.
  void step(double position, double force) noexcept;

  [[nodiscard]] double energy() const noexcept { return energy_; }              ///< E(n) [J]
  [[nodiscard]] double displacement() const noexcept { return displacement_; }  ///< x(n) − x(n−1) [m]; 0 at first

 private:
  friend class SeriesPassivityController;
  void move(double position) noexcept;
  void hold(double force) noexcept;

  double position_ = 0.0, force_ = 0.0, energy_ = 0.0, displacement_ = 0.0;
  bool begun_ = false;
};

/// A damper in series with a one-port of impedance causality, which gives forces (Hannaford & Ryu 2002, §III): what the
/// observer misses is taken back by the motion that comes,
///   f(n) + α(n) v(n),   α = min(−E(n)/(T v²), α_max) where E(n) < 0, else 0,   v(n) = (x(n) − x(n−1))/T
/// A one-port that stays passive is never altered. Where the motion goes on evenly, E falls below zero by the energy of
/// one step at most; where it slows down or turns round, or α_max binds, what is missing is made up later.
/// Allocation-free.
class SeriesPassivityController {
 public:
  /// @param sample_time  T [s] > 0
  /// @param largest_damping  α_max [N·s/m] > 0. A mass m that takes forces of one tick back loses stability above about
  /// m/T, as with any damper; so a share of that.
  /// @fails  usage: one of them is not above zero, or not finite.
  [[nodiscard]] static Result<SeriesPassivityController> create(double sample_time, double largest_damping);

  /// @param position  x(n) [m]   @param force  f(n) [N] on the one-port, positive with x
  /// @returns  the force to apply instead [N]
  [[nodiscard]] double step(double position, double force) noexcept;

  [[nodiscard]] double energy() const noexcept { return observer_.energy(); }  ///< E(n), its own damper included [J]

 private:
  SeriesPassivityController(double sample_time, double largest_damping)
      : sample_time_(sample_time), largest_damping_(largest_damping) {}
  double sample_time_, largest_damping_;
  PassivityObserver observer_;
};

/// A damper in parallel with a one-port of admittance causality, which gives velocities (Hannaford & Ryu 2002, §III):
///   E(n) = E(n−1) + T f(n) v(n),   v(n) + β(n) f(n),   β = min(−E(n)/(T f²), β_max) where E(n) < 0, else 0
/// with β's share counted in E. Velocity and force are held until the next sample; so E never falls below zero unless
/// β_max binds. A one-port that stays passive is never altered. Allocation-free.
class ParallelPassivityController {
 public:
  /// @param sample_time  T [s] > 0   @param largest_admittance  β_max [m/(N·s)] > 0
  /// @fails  usage: one of them is not above zero, or not finite.
  [[nodiscard]] static Result<ParallelPassivityController> create(double sample_time, double largest_admittance);

  /// @param force  f(n) [N] on the one-port   @param velocity  v(n) [m/s] that it gives, positive with f
  /// @returns  the velocity to give instead [m/s]. A sample that is not finite is given on and not counted.
  [[nodiscard]] double step(double force, double velocity) noexcept;

  [[nodiscard]] double energy() const noexcept { return energy_; }  ///< E(n) [J]

 private:
  ParallelPassivityController(double sample_time, double largest_admittance)
      : sample_time_(sample_time), largest_admittance_(largest_admittance) {}
  double sample_time_, largest_admittance_, energy_ = 0.0;
};

}  // namespace mbk::control
