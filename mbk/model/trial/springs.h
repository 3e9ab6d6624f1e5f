#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mbk/model/trial/recording.h"

namespace mbk {

/// An extension spring between a screw eye on the frame and the disc on the handle.
struct Spring {
  double stiffness = 0.0;               ///< k [N/m] > 0
  double rest_length = 0.0;             ///< l, start of the linear range of its force [m] ≥ 0
  Eigen::Vector2d anchor = {0.0, 0.0};  ///< its end on the frame, base frame [m]
  Eigen::Vector2d hole = {0.0, 0.0};    ///< its end on the disc, from the hand, at disc rotation 0 [m]
};

/// Deviation of a spring array from M ẍ + K (x − x₀) = −F_h within a circle about its equilibrium.
struct Linearisation {
  double radius = 0.0;              ///< of the circle [m]
  double largest_error = 0.0;       ///< max |F + K (x − x₀)| in it [N]
  double largest_force = 0.0;       ///< max |F| in it [N]
  double smallest_extension = 0.0;  ///< min |R − R_i| − l_i in it, over all springs [m]; negative: a spring goes slack
  [[nodiscard]] double relative_error() const { return largest_error / largest_force; }
};

/// Equilibrium and stiffness from forces on a grid (the procedure of Dyck 2013, appendix D).
struct GridField {
  double step = 0.0;                                   ///< of the grid [m]
  Eigen::Vector2d equilibrium = {0.0, 0.0};            ///< the grid point with the smallest force [m]
  double residual = 0.0;                               ///< |F| there [N]
  Eigen::Matrix2d K = Eigen::Matrix2d::Constant(0.0);  ///< −∂F/∂x by differences of neighbours [N/m]
  bool at_border = false;  ///< the smallest force is on the edge of the grid, so it may not be an equilibrium
};

/// Behaviour of a spring array about its equilibrium, base frame.
struct SpringField {
  std::vector<Spring> springs;
  double disc_rotation = 0.0;                          ///< [rad]
  Eigen::Vector2d equilibrium = {0.0, 0.0};            ///< x₀ [m]
  double residual = 0.0;                               ///< |F(x₀)| [N]
  double moment = 0.0;                                 ///< of the springs on the disc about the hand, at x₀ [N·m]
  Eigen::Matrix2d K = Eigen::Matrix2d::Constant(0.0);  ///< −∂F/∂x at x₀, symmetric [N/m]
  std::vector<double> lengths, tensions;               ///< of each spring at x₀ [m], [N]
  Linearisation linearisation;
  std::optional<GridField> grid;  ///< if requested
};

/// Springs for a target stiffness.
struct SpringDesign {
  SpringField field;                        ///< of the springs that were found
  std::vector<int> eyes;                    ///< of each spring: number of its screw eye, from 1
  Eigen::Matrix2d target_K;                 ///< [N/m]
  Eigen::Vector2d target_equilibrium;       ///< [m]
  std::optional<double> payload;            ///< [kg]
  Eigen::Vector2d natural_frequency{0, 0};  ///< √(λ/m)/2π of payload and principal stiffnesses, low, high [Hz]
};

/// A straight line T = k (s − s₀) through tensions.
struct SpringLine {
  double stiffness = 0.0, stiffness_error = 0.0;  ///< k and its standard error [N/m]
  double rest = 0.0, rest_error = 0.0;  ///< s₀, the position where the line meets zero, and its standard error [m]
  double r_squared = 0.0;
  double rmse = 0.0;          ///< of the tension [N]
  double tension_from = 0.0;  ///< smallest fitted tension [N]
  double tension_to = 0.0;    ///< largest fitted tension [N]
  Index samples = 0;
};

/// A spring whose hooks yield at first:  s = s₀ + T/k + s_h (1 − exp(−T/F_h)).
struct HookFit {
  double stiffness = 0.0, stiffness_error = 0.0;    ///< k beyond the hooks, and its standard error [N/m]
  double rest = 0.0;                                ///< s₀, position at zero tension [m]
  double deflection = 0.0, deflection_error = 0.0;  ///< s_h, total yield of the hooks [m]
  double force = 0.0;                               ///< F_h, tension at which 63 % of it is reached [N]
  double rmse = 0.0;                                ///< of the tension [N]
};

/// The constant of one spring from a slow stretch.
struct SpringConstant {
  std::vector<SourceFile> sources;
  std::string rule;                ///< how the linear range was chosen, in words
  SpringLine straight;             ///< the result: a line through the linear range
  SpringLine whole;                ///< a line through all data
  std::optional<HookFit> hooks;    ///< absent if the data show none
  double hac_lag_s = 0.0;          ///< length of the residual correlation used in the standard errors
  std::vector<std::string> notes;  ///< notes for the user, in words
  /// k of `whole` over that of `straight`, minus 1.
  [[nodiscard]] double bias_of_whole() const { return whole.stiffness / straight.stiffness - 1.0; }
};

}  // namespace mbk
