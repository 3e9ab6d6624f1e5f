#include "mbk/present/report/robot_description_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/units.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

std::string limits_text(const robot::Mechanism& mechanism, int joint) {
  const robot::JointRange range = mechanism.joint_range(joint);
  if (!std::isfinite(range.high - range.low)) return "unlimited";
  const bool slides = mechanism.slides(joint);
  const double unit = slides ? kMillimetres : kDegrees;
  return fmt::format("{:.5g} … {:.5g}{}", unit * range.low, unit * range.high, slides ? " mm" : "°");
}

std::string hand_text(const robot::Mechanism& mechanism) {
  const robot::HandVector place = mechanism.hand_position(robot::JointVector::Zero(mechanism.joints()));
  std::vector<std::string> numbers;
  for (const double metres : place) {
    numbers.push_back(fmt::format("{:.2f}", std::round(1e2 * kMillimetres * metres) / 1e2 + 0.0));
  }
  return fmt::format("{} {}, with all joints at 0", fmt::join(numbers, ", "),
                     mechanism.hand_turns() ? "·10⁻³ rad" : "mm");
}

std::string drives_text(const robot::DynamicModel& model) {
  const robot::DriveTerms& drive = model.drive;
  std::vector<std::string> words;
  const std::pair<const char*, bool> terms[] = {
      {"motor inertia", drive.motor_inertia}, {"viscous", drive.viscous}, {"Coulomb", drive.coulomb},
      {"Stribeck", drive.stribeck},           {"cable", drive.cable},     {"offset", drive.offset}};
  for (const auto& [word, expected] : terms) {
    if (expected) words.emplace_back(word);
  }
  std::string text =
      words.empty() ? "no motor inertia, friction, cable or offset" : fmt::format("{}", fmt::join(words, ", "));
  if (drive.coulomb || drive.stribeck) {
    text += drive.smoothing > 0.0
                ? fmt::format("; the sign of friction is smoothed over {:.4g} rad/s or m/s", drive.smoothing)
                : "; the sign of friction is not smoothed";
  }
  if (drive.stribeck) text += fmt::format("; Stribeck velocity {:.4g} rad/s or m/s", drive.stribeck_velocity);
  return text;
}

/// What coefficient j adds to the identifiable ones: "adds 0.04·fore.mass to upper.inertia_yy, −0.2·fore.mass to …".
std::string part_of(const numeric::IndependentColumns& base, Index j, const std::vector<robot::Coefficient>& names) {
  constexpr double kNone = 1e-6;
  std::string text;
  for (std::size_t k = 0; k < base.kept.size(); ++k) {
    const double factor = base.combination(static_cast<Index>(k), j);
    if (std::abs(factor) < kNone) continue;
    text += text.empty() ? "adds " : ", ";
    if (factor < 0.0) text += "−";
    if (std::abs(std::abs(factor) - 1.0) >= kNone) text += fmt::format("{:.4g}·", std::abs(factor));
    text += fmt::format("{} to {}", names[static_cast<std::size_t>(j)].name,
                        names[static_cast<std::size_t>(base.kept[k])].name);
  }
  return text.empty() ? "no effect" : text;
}

}  // namespace

std::string robot_description_text(const robot::RobotDescription& description,
                                   const numeric::IndependentColumns& base) {
  const robot::DynamicModel& model = description.model;
  const robot::Mechanism& mechanism = *model.mechanism;
  std::string text = printable(description.source) + "\n\n";
  std::vector<std::vector<std::string>> rows = {{"joint", "name", "", "limits"}};
  for (int joint = 0; joint < mechanism.joints(); ++joint) {
    rows.push_back({fmt::format("{}", joint + 1), printable(mechanism.joint_name(joint)),
                    mechanism.slides(joint) ? "slides" : "turns", limits_text(mechanism, joint)});
  }
  text += table(rows) + "\n";
  text += table({{"hand", hand_text(mechanism)},
                 {"drives", drives_text(model)},
                 {"motor delay", fmt::format("{:.4g} ms", 1e3 * model.delay)}});

  const std::vector<robot::Coefficient> coefficients = model.coefficients();
  rows = {{"coefficient", "value", "unit", ""}};
  for (std::size_t j = 0; j < coefficients.size(); ++j) {
    const auto& [name, unit] = coefficients[j];
    const bool stated = std::ranges::find(description.unstated, name) == description.unstated.end();
    const bool kept = std::ranges::find(base.kept, static_cast<Index>(j)) != base.kept.end();
    rows.push_back({printable(name),
                    stated ? fmt::format("{:.6g}", model.parameters[static_cast<Index>(j)] + 0.0) : "not stated", unit,
                    kept ? "" : printable(part_of(base, static_cast<Index>(j), coefficients))});
  }
  text += "\n" + table(rows);
  const std::size_t all = coefficients.size(), apart = base.kept.size();
  text += paragraph(
      "  ", apart == all
                ? fmt::format("A sufficiently rich motion identifies all {} coefficients.", all)
                : fmt::format("A sufficiently rich motion identifies {} of {} coefficients; "
                              "the others have an effect only as part of those listed with them, or none at all.",
                              apart, all));
  for (const std::string& one : description.impossible) {
    text += paragraph("  ! ", printable(one) +
                                  ": each principal moment is at most the sum of the other two. 'robot identify' does "
                                  "not use it; 'robot force' needs it corrected or identified.");
  }
  return text;
}

}  // namespace mbk::report
