#pragma once

#include <Eigen/Core>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/springs.h"

namespace mbk::calibration {

/// What a spring does when it is shorter than its rest length.
enum class Compression {
  slack,  ///< nothing, as an extension spring in two screw eyes
  push,   ///< −k (L − l), as eq. (D.1) reads where it is taken literally
};

/// Springs that hold the handle in a frame. With R the hand, d_i = R + h_i − R_i the line from screw eye to disc,
/// L_i = |d_i| and u_i = d_i/L_i, the force of the springs on the hand is
///   F(R) = −Σ k_i (L_i − l_i) u_i                                         [N]   (Dyck 2013, eq. D.1)
/// It is a force from the load on the hand's place, as F_h: F ≈ −K (R − R₀) about an equilibrium. h_i is the hole of
/// the spring turned by the rotation of the disc; with h_i = 0 this is (D.1) itself. Nothing here allocates.
/// A spring of length 0 has no direction: it exerts no force, and its stiffness is NaN where it would push.
class SpringArray {
 public:
  /// @fails  data: no spring; a stiffness that is not above 0, a rest length below 0, a place that is not finite.
  [[nodiscard]] static Result<SpringArray> create(std::vector<Spring> springs,
                                                  Compression compression = Compression::slack);

  /// F(R), base frame [N].   @param hand R [m]   @param disc_rotation counterclockwise [rad]
  [[nodiscard]] Eigen::Vector2d force(const Eigen::Vector2d& hand, double disc_rotation = 0.0) const;

  /// Σ h_i × F_i, of the springs on the disc about the hand, counterclockwise [N·m]; 0 where all h_i = 0.
  [[nodiscard]] double moment(const Eigen::Vector2d& hand, double disc_rotation = 0.0) const;

  /// E(R) = Σ ½ k_i (L_i − l_i)² [J], F = −∂E/∂R, moment = −∂E/∂(rotation).
  [[nodiscard]] double energy(const Eigen::Vector2d& hand, double disc_rotation = 0.0) const;

  /// K = −∂F/∂R = Σ k_i [ u_i u_iᵀ + (1 − l_i/L_i)(I − u_i u_iᵀ) ]   [N/m], symmetric   (D.3, whose lower left entry is
  /// ∂f_y/∂x, and whose sign is that of the text below it: K = −grad F). Slack springs add nothing.
  [[nodiscard]] Eigen::Matrix2d stiffness(const Eigen::Vector2d& hand, double disc_rotation = 0.0) const;

  /// L_i of spring i [m].
  [[nodiscard]] double length(std::size_t i, const Eigen::Vector2d& hand, double disc_rotation = 0.0) const;

  /// k_i (L_i − l_i) [N]; 0 where the spring is slack.
  [[nodiscard]] double tension(std::size_t i, const Eigen::Vector2d& hand, double disc_rotation = 0.0) const;

  [[nodiscard]] const std::vector<Spring>& springs() const { return springs_; }
  [[nodiscard]] Compression compression() const { return compression_; }

 private:
  SpringArray(std::vector<Spring> springs, Compression compression)
      : springs_(std::move(springs)), compression_(compression) {}

  [[nodiscard]] double tension_at(const Spring& spring, double length) const;

  std::vector<Spring> springs_;
  Compression compression_;
};

/// Largest force accepted as zero at an equilibrium [N].
inline constexpr double kEquilibriumForce = 1e-10;

/// R₀ with F(R₀) = 0 and K(R₀) positive definite, by Newton steps downhill in the energy: −(K + μI)⁻¹ with the least μ
/// that makes the matrix positive definite, halved until the energy falls.
/// @param start  start of the search [m]
/// @fails  not usable: no place with |F| ≤ 1e-10 N is found; it is not stable; a spring is slack there, or its two ends
/// coincide (each named with its number, from 1).
[[nodiscard]] Result<Eigen::Vector2d> equilibrium(const SpringArray& array, const Eigen::Vector2d& start,
                                                  double disc_rotation = 0.0);

/// The published procedure (Dyck 2013, appendix D): F on a grid, the point where |F| is smallest, and K from the
/// differences of its neighbours, one-sided on the border. The point is up to half a step (in each direction) from the
/// equilibrium, and K is that of the point, so it errs in proportion to the step. Kept to show by how much.
/// @param centre, reach the grid has a point at every multiple of `step` within centre ± reach [m]
/// @fails  usage: fewer than 3 or more than 4000 points along one side.
[[nodiscard]] Result<GridField> grid_field(const SpringArray& array, const Eigen::Vector2d& centre, double reach,
                                           double step, double disc_rotation = 0.0);

/// Over the disc |R − R₀| ≤ radius: 12 rings of 120 points; the smallest extension is exact, |d_i| − radius − l_i.
[[nodiscard]] Linearisation linearisation(const SpringArray& array, const Eigen::Vector2d& equilibrium, double radius,
                                          double disc_rotation = 0.0);

/// All of the above about the equilibrium nearest downhill from `start`.
/// @param radius of the linearisation [m]    @fails as `equilibrium`; usage: the radius is not above 0.
[[nodiscard]] Result<SpringField> spring_field(const SpringArray& array, const Eigen::Vector2d& start, double radius,
                                               double disc_rotation = 0.0);

/// Σ k_i R_i/Σ k_i: where springs of rest length 0 would hold the hand, and a good start for others.
[[nodiscard]] Eigen::Vector2d centre_of_anchors(const std::vector<Spring>& springs);

}  // namespace mbk::calibration
