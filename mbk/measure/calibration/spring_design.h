#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/springs.h"

namespace mbk::calibration {

/// Screw eyes of the published frame: plywood of 15.5″ × 15.5″ with its eight eyes at the corners and the middles of
/// the sides of a rectangle of 350 × 366 mm (Dyck 2013, appendix D), anticlockwise from the middle of the +x side.
/// @param centre of the frame, base frame [m]
[[nodiscard]] std::vector<Eigen::Vector2d> frame_eyes(const Eigen::Vector2d& centre);

/// Default position of the frame: the equilibria of tables 3.1 and 5.1, 332 … 448 mm by −61 … 61 mm, lie
/// about this point [m].
inline const Eigen::Vector2d kFrameCentre{0.390, 0.0};

/// Radius of the circle of holes in the published disc [m].
inline constexpr double kDiscRadius = 0.0225 / 2.0;

/// The hole of the disc that faces a screw eye, of eight at 45°, from the hand [m].
[[nodiscard]] Eigen::Vector2d facing_hole(const Eigen::Vector2d& eye, const Eigen::Vector2d& frame_centre);

/// What is target of the springs, and what there is to make it from.
struct SpringRequest {
  Eigen::Matrix2d K = Eigen::Matrix2d::Zero();                   ///< symmetric positive definite [N/m]
  Eigen::Vector2d equilibrium = kFrameCentre;                    ///< base frame [m]
  std::vector<Eigen::Vector2d> eyes = frame_eyes(kFrameCentre);  ///< screw eyes, base frame [m]; at most 12
  std::vector<Eigen::Vector2d> holes;                            ///< one for each eye [m]; empty: all at the hand
  std::pair<double, double> stiffness = {20.0, 400.0};           ///< of the springs that can be had [N/m]
  std::pair<double, double> rest_length = {0.060, 0.160};        ///< of the springs that can be had [m]
  double travel = 0.030;         ///< radius of the circle in which every spring must stay in tension [m]
  double min_extension = 0.002;  ///< of every spring in that circle [m]
  int max_springs = 8;
  std::optional<double> payload;  ///< mass on the disc, for the natural frequencies [kg]
};

/// Springs whose analytic K and equilibrium are exactly the target ones and whose force is as straight as can be.
///
/// With the equilibrium fixed, force and stiffness are linear in k_i and the rest force m_i = k_i l_i,
///   F = −Σ k_i d_i + Σ m_i u_i = 0,   K = Σ k_i I − Σ (m_i/L_i)(I − u_i u_iᵀ),
/// and so is the deviation from straightness, F(R₀ + δ) + K δ = Σ m_i [u_i(δ) − u_i − (I − u_i u_iᵀ) δ/L_i]. So the
/// springs with the least mean square deviation over the circle are the solution of a convex quadratic program in
/// (k, m) with the bounds on k_i and l_i = m_i/k_i, and not one of several local answers. Every choice of screw eyes,
/// from 3 to `max_springs`, is tried and the best taken.
/// @fails  usage: K is not symmetric positive definite; a bound is empty; too few or too many eyes. not usable: no
/// choice gives K there within the bounds (the nearest K is reported).
[[nodiscard]] Result<SpringDesign> design_springs(const SpringRequest& request);

}  // namespace mbk::calibration
