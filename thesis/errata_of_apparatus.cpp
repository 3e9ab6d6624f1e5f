// Errata of the appendices about the robot, its springs and its force sensor.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "mbk/measure/calibration/spring_array.h"
#include "mbk/model/robot/dynamics.h"
#include "mbk/model/robot/workspace.h"
#include "thesis/errata.h"

namespace mbk::thesis {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kStep = 1e-6;  // of central differences [rad or m]
constexpr std::array<const char*, 2> kAxes = {"x", "y"};

/// A posture in the middle of the workspace, in motion.
const Vector2d kTheta(0.4, 0.9), kThetaRate(1.2, -0.7);

/// Column k: the derivative of `function` by its k-th argument, by central differences.
template <typename Function>
Matrix2d differences(const Function& function, const Vector2d& at) {
  Matrix2d result;
  for (Index k = 0; k < 2; ++k) {
    Vector2d step = Vector2d::Zero();
    step[k] = kStep;
    result.col(k) = (function(Vector2d(at + step)) - function(Vector2d(at - step))) / (2.0 * kStep);
  }
  return result;
}

}  // namespace

Result<void> jacobian_in_one_column(Workbench& /*bench*/, Draft& exhibit) {
  exhibit.commands = {"mbk robot workspace --at 300,-50      # the posture there"};
  exhibit.related = {"erratum-9", "figure-A.2"};
  const robot::Geometry geometry;
  const Matrix2d J = robot::jacobian(geometry, kTheta);
  const Matrix2d numerical =
      differences([&](const Vector2d& theta) { return robot::hand_position(geometry, theta); }, kTheta);
  const Vector2d printed(-geometry.d1 * std::sin(kTheta[0]) + geometry.d2 * std::cos(kTheta[1]),
                         geometry.d1 * std::cos(kTheta[0]) + geometry.d2 * std::sin(kTheta[1]));
  ReproducedTable table = computed_table("erratum-8", "derivative",
                                         {{"by differences", "m", 5}, {"J", "m", 5}, {"its row as printed", "m", 5}});
  for (Index row = 0; row < 2; ++row) {
    for (Index column = 0; column < 2; ++column) {
      table.rows.push_back({fmt::format("∂h_{}/∂θ{}", kAxes[static_cast<std::size_t>(row)], column + 1),
                            {cell(numerical(row, column)), cell(J(row, column)), cell(printed[row])}});
    }
  }
  table.rows.push_back({"determinant [m²]",
                        {cell(numerical(0, 0) * numerical(1, 1) - numerical(0, 1) * numerical(1, 0)),
                         cell(-geometry.d1 * geometry.d2 * std::cos(kTheta[0] - kTheta[1])), words("none")}});
  exhibit.tables = {std::move(table)};
  return {};
}

namespace {

/// C with the sign that is printed in its lower left.
Matrix2d printed_coriolis(const robot::Inertia& inertia, const Vector2d& theta, const Vector2d& rate) {
  Matrix2d C = inertia.coriolis(theta, rate);
  C(1, 0) = -C(1, 0);
  return C;
}

/// ½ θ̇ᵀ(İ − 2C)θ̇ over one turn of joint 1, joint 2 going to and fro.
Chart power_chart(const robot::Inertia& inertia) {
  Chart chart;
  chart.x = {"time", "s"};
  chart.y = {"½ θ̇ᵀ(İ − 2C)θ̇", "W"};
  ChartSeries printed{"C as printed", {}, {}, {}, ChartSeries::Drawn::line};
  ChartSeries right{"C", {}, {}, {}, ChartSeries::Drawn::line};
  constexpr double kOmega = 2.0 * std::numbers::pi, kSwing = 0.35;  // 1 Hz, ±20°
  for (int i = 0; i <= 100; ++i) {
    const double t = i / 100.0;
    const auto theta = [&](double at) {
      return Vector2d(kSwing * std::sin(kOmega * at), 0.9 + kSwing * std::cos(kOmega * at));
    };
    const Vector2d rate = kSwing * kOmega * Vector2d(std::cos(kOmega * t), -std::sin(kOmega * t));
    const Matrix2d I_rate = (inertia.matrix(theta(t + kStep)) - inertia.matrix(theta(t - kStep))) / (2.0 * kStep);
    const auto power = [&](const Matrix2d& C) { return 0.5 * rate.dot((I_rate - 2.0 * C) * rate); };
    printed.x.push_back(t);
    printed.y.push_back(power(printed_coriolis(inertia, theta(t), rate)));
    right.x.push_back(t);
    right.y.push_back(power(inertia.coriolis(theta(t), rate)));
  }
  chart.series = {std::move(printed), std::move(right)};
  return chart;
}

}  // namespace

Result<void> coriolis_sign(Workbench& /*bench*/, Draft& exhibit) {
  exhibit.commands = {"mbk robot describe examples/robots/thesis.toml"};
  exhibit.related = {"erratum-8", "table-A.1"};
  const robot::Inertia inertia;
  const Matrix2d I_rate =
      (inertia.matrix(kTheta + kStep * kThetaRate) - inertia.matrix(kTheta - kStep * kThetaRate)) / (2.0 * kStep);
  ReproducedTable table = computed_table(
      "erratum-9", "C", {{"N₁₁", "N·m·s", 6}, {"N₁₂ + N₂₁", "N·m·s", 6}, {"N₂₂", "N·m·s", 6}, {"½ θ̇ᵀNθ̇", "W", 6}});
  for (const auto& [name, C] : {std::pair{"as printed", printed_coriolis(inertia, kTheta, kThetaRate)},
                                {"with −½ α₂ cos(θ₁ − θ₂) θ̇₁", inertia.coriolis(kTheta, kThetaRate)}}) {
    const Matrix2d N = I_rate - 2.0 * C;
    table.rows.push_back(
        {name, {cell(N(0, 0)), cell(N(0, 1) + N(1, 0)), cell(N(1, 1)), cell(0.5 * kThetaRate.dot(N * kThetaRate))}});
  }
  const robot::Geometry geometry;
  constexpr double kPayload = 1.5;  // [kg]
  const Matrix2d J = robot::jacobian(geometry, kTheta);
  const Matrix2d requested = inertia.matrix(kTheta) + kPayload * J.transpose() * J;
  const Matrix2d got = inertia.with_payload(geometry, kPayload).matrix(kTheta);
  ReproducedTable payload =
      computed_table("erratum-9 payload", "entry", {{"I + m JᵀJ", "kg·m²", 6}, {"I with the changed α", "kg·m²", 6}});
  for (const auto& [name, row, column] : {std::tuple{"I₁₁", 0, 0}, {"I₁₂", 0, 1}, {"I₂₂", 1, 1}}) {
    payload.rows.push_back({name, {cell(requested(row, column)), cell(got(row, column))}});
  }
  exhibit.tables = {std::move(table), std::move(payload)};
  exhibit.charts = {power_chart(inertia)};
  return {};
}

Result<void> gradient_of_springs(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {
      "mbk springs field --spring k=120,l=90,anchor=565:183 --spring k=120,l=90,anchor=565:-183 --spring "
      "k=150,l=80,anchor=215:0 --grid-step 0.15"};
  exhibit.related = {"table-3.1", "table-5.1", "erratum-4"};
  const Given& given = bench.given();
  const double d1 = given.number("setup", "frame d1, m"), d2 = given.number("setup", "frame d2, m");
  const auto array = MBK_TRY(calibration::SpringArray::create({{120.0, 0.09, {d2, d1}, {0.0, 0.0}},
                                                               {80.0, 0.08, {-d2, d1}, {0.0, 0.0}},
                                                               {150.0, 0.1, {-d2, -d1}, {0.0, 0.0}},
                                                               {60.0, 0.07, {d2, 0.0}, {0.0, 0.0}}}));
  const auto table_of = [](const char* id, const Matrix2d& gradient, const Matrix2d& K) {
    ReproducedTable table =
        computed_table(id, "entry", {{"K", "N/m", 2}, {"−grad F", "N/m", 2}, {"(D.3), as printed", "N/m", 2}});
    for (Index row = 0; row < 2; ++row) {
      for (Index column = 0; column < 2; ++column) {
        const double printed = row == 1 && column == 0 ? gradient(0, 1) : gradient(row, column);
        table.rows.push_back(
            {fmt::format("k_{}{}", kAxes[static_cast<std::size_t>(row)], kAxes[static_cast<std::size_t>(column)]),
             {cell(K(row, column)), cell(-gradient(row, column)), cell(printed)}});
      }
    }
    return table;
  };
  const Vector2d hand(0.02, -0.03);
  const Matrix2d of_springs = differences([&](const Vector2d& R) { return array.force(R); }, hand);
  Matrix2d K = model_of(arm_of(given.sinusoidal, "P1")).K;
  const double k_a = antisymmetric_stiffness(given);
  K(0, 1) += k_a;
  K(1, 0) -= k_a;
  const Matrix2d of_arm = differences([&](const Vector2d& x) { return Vector2d(-K * x); }, hand);
  exhibit.tables = {table_of("erratum-10", of_springs, array.stiffness(hand)), table_of("erratum-10 arm", of_arm, K)};
  return {};
}

Result<void> majority_of_the_workspace(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {"mbk robot workspace --at 300,-50      # its area"};
  exhibit.related = {"table-A.1", "figure-A.2", "statements"};
  const robot::Geometry geometry;
  const auto workspace = MBK_TRY(robot::workspace(geometry));
  // |cos| is largest, and symmetric, about θ₁ = θ₂: ∫∫ cos(θ₁ − θ₂) over a square of side r is 2 (1 − cos r).
  const auto swept = [&](double range) { return geometry.d1 * geometry.d2 * 2.0 * (1.0 - std::cos(range)); };
  const double range = bench.given().number("setup", "joint range of appendix A, °") * std::numbers::pi / 180.0;
  const double half = std::acos(1.0 - 0.25 * workspace.area / (geometry.d1 * geometry.d2));
  ReproducedTable table = computed_table("erratum-20", "", {{"area", "m²", 4}, {"of the workspace", "%", 1}});
  const auto add = [&](std::string name, double area) {
    table.rows.push_back({std::move(name), {cell(area), cell(100.0 * area / workspace.area)}});
  };
  exhibit.values = {{"swept", 100.0 * swept(range) / workspace.area}};
  add("the workspace", workspace.area);
  add("40° of each joint", swept(range));
  add(fmt::format("{:.0f}° of each joint", half * 180.0 / std::numbers::pi), swept(half));
  exhibit.tables = {std::move(table)};
  return {};
}

}  // namespace mbk::thesis
