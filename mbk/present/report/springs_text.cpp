#include "mbk/present/report/springs_text.h"

#include <fmt/format.h>

#include <cmath>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

/// Millimetres with as many decimals as asked, and never "-0".
std::string in_mm(double metres, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return fmt::format("{:.{}f}", std::round(kMillimetres * metres * unit) / unit + 0.0, decimals);
}

std::string place(const Eigen::Vector2d& p) {
  return in_mm(p.x(), 2) + ", " + in_mm(p.y(), 2);
}

std::vector<std::string> matrix_row(const std::string& name, const Eigen::Matrix2d& K) {
  const auto number = [](double value) { return fmt::format("{:.3f}", std::round(1e3 * value) / 1e3 + 0.0); };
  return {name, number(K(0, 0)), number(K(0, 1)), number(K(1, 0)), number(K(1, 1)), "N/m"};
}

std::string linearity(const Linearisation& line) {
  std::string text =
      fmt::format("the force is at most {:.2f} N and deviates from −K (x − x0) by at most {:.2g} N, {:.2g} % of that; ",
                  line.largest_force, line.largest_error, 100.0 * line.relative_error());
  text +=
      line.smallest_extension > 0.0
          ? fmt::format("every spring stays extended by at least {} mm", in_mm(line.smallest_extension, 1))
          : fmt::format("a spring is shorter than its rest length by up to {} mm", in_mm(-line.smallest_extension, 1));
  return text;
}

std::string grid_words(const SpringField& field, const GridField& grid) {
  std::string text =
      fmt::format("published procedure: K at the point of a {:g} mm grid with the smallest force, {:.2g} N",
                  kMillimetres * grid.step, grid.residual);
  if (grid.at_border) return text + "; the point is on the edge of the grid and may not be an equilibrium";
  text += fmt::format("; error of the point {:.2g} mm, of K at most {:.2g} N/m",
                      kMillimetres * (grid.equilibrium - field.equilibrium).norm(),
                      (grid.K - field.K).cwiseAbs().maxCoeff());
  const double beside = std::abs(field.K(0, 1));
  if (beside > 0.0) {
    text += fmt::format(
        ", of the off-diagonal elements {:.2g} %",
        100.0 * std::max(std::abs(grid.K(0, 1) - field.K(0, 1)), std::abs(grid.K(1, 0) - field.K(0, 1))) / beside);
  }
  return text;
}

std::string plus_minus(double value, double standard_error, double scale = 1.0) {
  return with_interval(scale * value, scale * numeric::kNormal95 * standard_error);
}

std::string constant_text(const SpringConstant& constant) {
  std::string text;
  for (const SourceFile& source : constant.sources) text += source.label() + "\n";
  const auto row = [](const char* name, const SpringLine& line) {
    return std::vector<std::string>{name,
                                    plus_minus(line.stiffness, line.stiffness_error),
                                    plus_minus(line.rest, line.rest_error, kMillimetres),
                                    fmt::format("{:.6f}", line.r_squared),
                                    fmt::format("{:.3g}", line.rmse),
                                    fmt::format("{:.2f} to {:.2f}", line.tension_from, line.tension_to)};
  };
  text += table({{"", "k in N/m", "rest in mm", "R²", "RMSE in N", "N"},
                 row("straight part", constant.straight),
                 row("whole range", constant.whole)});
  text += paragraph("  straight part  ", constant.rule);
  if (constant.hooks) {
    const HookFit& hooks = *constant.hooks;
    text += paragraph(
        "  hooks          ",
        fmt::format("yield by {} mm in total, 63 % of it below {:.2f} N; without them k is {} N/m (RMSE {:.3g} N)",
                    plus_minus(hooks.deflection, hooks.deflection_error, kMillimetres), hooks.force,
                    plus_minus(hooks.stiffness, hooks.stiffness_error), hooks.rmse));
    text += paragraph(
        "  bias           ",
        fmt::format("a line through the whole range is {:.1f} % {} than the straight part",
                    100.0 * std::abs(constant.bias_of_whole()), constant.bias_of_whole() < 0.0 ? "softer" : "stiffer"));
  }
  for (const std::string& note : constant.notes) text += paragraph("  note           ", note);
  return text;
}

}  // namespace

std::string spring_option(const Spring& spring) {
  std::string text = fmt::format("k={:.4f},l={}mm,anchor={}:{}", spring.stiffness, in_mm(spring.rest_length, 4),
                                 in_mm(spring.anchor.x(), 4), in_mm(spring.anchor.y(), 4));
  if (!spring.hole.isZero(0.0)) {
    text += fmt::format(",hole={}:{}", in_mm(spring.hole.x(), 4), in_mm(spring.hole.y(), 4));
  }
  return text;
}

std::string spring_field_text(const SpringField& field) {
  const impedance::Ellipse principal = impedance::ellipse(field.K);
  std::string text =
      fmt::format("equilibrium  x {}, y {} mm", in_mm(field.equilibrium.x(), 4), in_mm(field.equilibrium.y(), 4));
  text += fmt::format("; {:.1g} N left", field.residual);
  if (field.disc_rotation != 0.0) text += fmt::format(", disc turned by {:g}°", kDegrees * field.disc_rotation);
  if (field.moment != 0.0) text += fmt::format(", moment {:.3g} N·m on the disc", field.moment);
  text += "\n\n";
  std::vector<std::vector<std::string>> rows = {{"", "xx", "xy", "yx", "yy", ""}, matrix_row("stiffness K", field.K)};
  if (field.grid) rows.push_back(matrix_row("on the grid", field.grid->K));
  text += table(rows);
  constexpr double kRound = 1e-6;  // difference of the principal values that no figure shows
  text += principal.lambda_max - principal.lambda_min <= kRound * principal.lambda_max
              ? fmt::format("  principal    {:.3f} N/m in every direction\n", principal.lambda_max)
              : fmt::format("  principal    {:.3f} N/m at {:.1f}°, {:.3f} N/m perpendicular\n", principal.lambda_max,
                            kDegrees * principal.orientation, principal.lambda_min);
  if (field.grid) text += paragraph("  grid         ", grid_words(field, *field.grid));
  text += paragraph(fmt::format("  {:<13}", fmt::format("within {} mm", in_mm(field.linearisation.radius, 0))),
                    linearity(field.linearisation)) +
          "\n";
  rows = {{"spring", "k in N/m", "rest in mm", "screw eye in mm", "hole in mm", "length in mm", "tension in N"}};
  for (std::size_t i = 0; i < field.springs.size(); ++i) {
    const Spring& spring = field.springs[i];
    rows.push_back({std::to_string(i + 1), fmt::format("{:.3f}", spring.stiffness), in_mm(spring.rest_length, 3),
                    place(spring.anchor), place(spring.hole), in_mm(field.lengths[i], 3),
                    fmt::format("{:.3f}", field.tensions[i])});
  }
  return text + table(rows);
}

std::string spring_design_text(const SpringDesign& design) {
  std::string text = spring_field_text(design.field);
  if (design.payload) {
    text += fmt::format("\nwith {:g} kg  natural frequencies {:.2f} and {:.2f} Hz\n", *design.payload,
                        design.natural_frequency[0], design.natural_frequency[1]);
  }
  text += "\nmbk springs field";
  for (const Spring& spring : design.field.springs) text += " \\\n  --spring " + spring_option(spring);
  text += "\n";
  for (const Spring& spring : design.field.springs) {
    text += fmt::format("\n[[rig.spring]]\nstiffness_N_per_m = {:.4f}\nrest_length_mm = {}\nanchor_mm = [{}, {}]\n",
                        spring.stiffness, in_mm(spring.rest_length, 4), in_mm(spring.anchor.x(), 4),
                        in_mm(spring.anchor.y(), 4));
    if (!spring.hole.isZero(0.0)) {
      text += fmt::format("hole_mm = [{}, {}]\n", in_mm(spring.hole.x(), 4), in_mm(spring.hole.y(), 4));
    }
  }
  return text;
}

std::string spring_constants_text(const std::vector<SpringConstant>& constants) {
  std::string text;
  for (const SpringConstant& constant : constants) text += constant_text(constant) + "\n";
  return text + "(±: half of the 95 % interval)\n";
}

}  // namespace mbk::report
