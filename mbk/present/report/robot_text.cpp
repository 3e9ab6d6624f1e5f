#include "mbk/present/report/robot_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mbk/base/core/significant.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/present/report/force_comparison_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

const char* method_text(RobotMethod method) {
  switch (method) {
    case RobotMethod::least_squares:
      return "least squares, all joints weighted equally";
    case RobotMethod::weighted_least_squares:
      return "least squares, each joint weighted by the noise of its torque";
    case RobotMethod::instrumental_variables:
      return "instrumental variables, each joint weighted by the noise of its torque";
  }
  return "";
}

std::string instruments_text(const RobotIdentification& found) {
  switch (found.instrument_motion) {
    case InstrumentMotion::joint_reference:
      return "from the reference of the joints";
    case InstrumentMotion::hand_reference:
      return "from the reference of the hand";
    case InstrumentMotion::smoothed:
      return fmt::format("from the motion, low-passed at {:.3g} Hz", found.motion_cutoff);
    case InstrumentMotion::none:
      break;
  }
  return "none";
}

std::string percent(double vaf) {
  return std::isfinite(vaf) ? fmt::format("{:.2f}", vaf) : "–";
}

std::string how_found(const RobotIdentification& found) {
  std::string text;
  for (std::size_t k = 0; k < found.sources.size() && k < found.durations.size(); ++k) {
    text += fmt::format("{}   {:.1f} s at {:.6g} Hz   {}\n", found.sources[k].label(), found.durations[k],
                        found.rates[k], found.sources[k].format);
  }
  const Preparation& how = found.preparations.front();
  std::vector<std::vector<std::string>> rows = {{"method", method_text(found.method)}};
  if (found.method == RobotMethod::instrumental_variables) rows.push_back({"instruments", instruments_text(found)});
  rows.push_back({"window", how.window_rule});
  rows.push_back({"filters", filters_text(how)});
  rows.push_back(
      {"excitation",
       fmt::format("{} of {} coefficients identifiable ({} with any motion), condition number {}", found.rank,
                   found.coefficients.size(), found.structural_rank, significant(found.condition, 3))});
  const double delay = 1e3 * found.model.delay;
  rows.push_back({"motor delay",
                  found.delay_standard_error
                      ? with_interval(delay, 1e3 * numeric::kNormal95 * *found.delay_standard_error) + " ms, estimated"
                      : fmt::format("{:.4g} ms, given", delay)});
  for (const std::string& note : found.notes) rows.push_back({"note", note});
  return text + table(rows);
}

/// The coefficients of a free fit.
std::string free_text(const RobotIdentification& found) {
  std::string text;
  std::vector<std::vector<std::string>> rows;
  std::string nothing;
  bool combined = false;
  for (const RobotCoefficient& one : found.coefficients) {
    if (one.fixed) {
      rows.push_back({one.coefficient.name, fmt::format("{:.6g}", one.value), one.coefficient.unit, "given"});
      continue;
    }
    if (!one.identified) {
      nothing += (nothing.empty() ? "" : ", ") + one.coefficient.name;
      continue;
    }
    combined = combined || !one.together_with.empty();
    rows.push_back({one.coefficient.name, with_interval(one.value, numeric::kNormal95 * one.standard_error),
                    one.coefficient.unit, one.together_with});
  }
  text +=
      table(rows) + "  (±: half of the 95 % interval; W θ = τ + Jᵀ F; τ: motor torques, F: force of hand on robot)\n";
  if (combined) {
    text += paragraph("  ",
                      "Coefficients listed after a value are included in it: only these sums are identifiable (base "
                      "parameters), and they suffice for torque and force.");
  }
  if (!nothing.empty()) text += paragraph("  not identifiable, or without effect: ", nothing);
  return text;
}

std::string points(double lost) {
  return std::isfinite(lost) ? fmt::format("{:+.2f}", lost == 0.0 ? 0.0 : -lost) : "–";
}

/// Bodies of the links, identifiable sums, and loss of VAF against the free fit.
std::string consistent_text(const RobotIdentification& found, const ConsistentRobot& consistent) {
  std::string text;
  std::vector<std::vector<std::string>> rows;
  if (!consistent.bodies.empty()) {
    rows.push_back({"link", "mass kg", "centre mm", "inertia xx, yy, zz kg·m²", "smallest"});
    for (const ConsistentBody& one : consistent.bodies) {
      const Eigen::Vector3d c = 1e3 * one.body.centre;
      const Eigen::Matrix3d& I = one.body.inertia;
      rows.push_back({one.link, fmt::format("{:.4g}", one.body.mass),
                      fmt::format("{:.1f}, {:.1f}, {:.1f}", c[0], c[1], c[2]),
                      fmt::format("{:.3g}, {:.3g}, {:.3g}", I(0, 0), I(1, 1), I(2, 2)),
                      fmt::format("{:.2g}", one.smallest_eigenvalue)});
    }
    text += table(rows);
    text += paragraph("  ",
                      "Physically consistent bodies in the frames of their links; inertia about the centre of mass "
                      "(products of inertia: --json); smallest: eigenvalue of the pseudo-inertia in SI units. The "
                      "bodies are not unique: others with the same sums below give the same motion. Parameters that no "
                      "torque shows are closest to the description.");
    text += "\n";
  }
  rows = {{"", "consistent", "free fit", "unit", ""}};
  for (const RobotCoefficient& one : found.coefficients) {
    if (one.fixed)
      rows.push_back({one.coefficient.name, fmt::format("{:.6g}", one.value), "given", one.coefficient.unit, ""});
  }
  for (const RobotCombination& one : consistent.combinations) {
    rows.push_back({one.name, fmt::format("{:.5g}", one.value),
                    with_interval(one.free, numeric::kNormal95 * one.standard_error), one.unit, one.together_with});
  }
  text += table(rows);
  text += paragraph("  ",
                    "Torque and motion determine these sums, and they suffice for torque and force. ± is the 95 % "
                    "interval of the free fit; the constraints may narrow it.");

  rows = {{"change of VAF [percentage points]", found.held_out ? "held out" : "in sample", "in sample"}};
  for (std::size_t joint = 0; joint < consistent.vaf_lost.size(); ++joint) {
    rows.push_back({fmt::format("joint {} relative to the free fit", joint + 1), points(consistent.vaf_lost[joint]),
                    points(consistent.vaf_lost_in_sample[joint])});
  }
  if (consistent.vaf_lost.size() > 1) rows.push_back({"mean of the joints", points(consistent.mean_vaf_lost), ""});
  text += "\n" + table(rows);
  if (!consistent.pressing.empty()) {
    text += paragraph("  active consistency constraints, strongest first: ",
                      fmt::format("{}", fmt::join(consistent.pressing, ", ")));
  }
  return text;
}

/// Fit of the torque of each joint.
std::string fit_text(const RobotIdentification& found) {
  std::vector<std::vector<std::string>> rows = {
      {found.held_out ? "held out" : "in sample", "VAF %", "RMSE", "in sample", "RMSE"}};
  const bool smoothed =
      std::ranges::any_of(found.fit, [](const TorqueFit& fit) { return fit.vaf_smoothed.has_value(); });
  if (smoothed) rows.front().push_back(fmt::format("VAF %, motion smoothed at {:.3g} Hz", found.smoothed_cutoff));
  for (std::size_t joint = 0; joint < found.fit.size(); ++joint) {
    const TorqueFit& fit = found.fit[joint];
    const char* unit = found.model.mechanism->slides(static_cast<int>(joint)) ? "N" : "N·m";
    rows.push_back({fmt::format("torque of joint {}", joint + 1), percent(fit.vaf),
                    fmt::format("{:.3g} {}", fit.rmse, unit), percent(fit.vaf_in_sample),
                    fmt::format("{:.3g} {}", fit.rmse_in_sample, unit)});
    if (fit.vaf_smoothed) rows.back().push_back(percent(*fit.vaf_smoothed));
  }
  return "\n" + table(rows);
}

/// The torque relative to that of the URDF.
std::string stated_text(const RobotIdentification& found) {
  std::vector<std::vector<std::string>> rows = {{"torque relative to the URDF", "ratio"}};
  for (std::size_t joint = 0; joint < found.stated.size(); ++joint) {
    const StatedRatio& one = found.stated[joint];
    rows.push_back(
        {fmt::format("joint {}", joint + 1),
         std::isfinite(one.ratio) ? with_interval(one.ratio, numeric::kNormal95 * one.standard_error) : "–"});
  }
  return "\n" + table(rows) + "  (from inertia and weight; friction estimated freely)\n";
}

}  // namespace

std::string robot_text(const RobotIdentification& found) {
  std::string text = how_found(found) + "\n";
  if (found.consistent) {
    text += consistent_text(found, *found.consistent);
  } else {
    text += free_text(found);
  }
  text += fit_text(found);
  if (!found.stated.empty()) text += stated_text(found);
  if (found.inertia.smallest > 0.0) {
    text += fmt::format("  inertia matrix positive definite in every posture: smallest eigenvalue {:.3g}\n",
                        found.inertia.smallest);
  }
  if (!found.warnings.empty()) text += "\n" + warnings_text(found.warnings);
  if (!found.usable) text += "\n  NOT USABLE: do not use this model; see the warnings above.\n";
  return text;
}

std::string force_text(const ForceSummary& force) {
  const bool observed = force.source == ForceSource::observer;
  const bool sure = force.standard_error.size() > 0;
  std::string text;
  for (const SourceFile& source : force.sources) text += fmt::format("{}   {}\n", source.label(), source.format);
  for (const std::string& note : force.notes) text += paragraph("  ", note);
  std::vector<std::vector<std::string>> rows = {{"", "RMS", "peak"}};
  if (sure) rows.front().emplace_back("± from the robot model");
  for (Index axis = 0; axis < force.rms.size(); ++axis) {
    rows.push_back({force.rms.size() == 1 ? "F" : "F" + force.axes[static_cast<std::size_t>(axis)],
                    fmt::format("{:.3g} {}", force.rms[axis], force.unit),
                    fmt::format("{:.3g} {}", force.peak[axis], force.unit)});
    if (sure)
      rows.back().push_back(fmt::format("{:.2g} {}", numeric::kNormal95 * force.standard_error[axis], force.unit));
  }
  text += "\n" + table(rows);
  if (force.comparison) {
    text += "\n" + force_comparison_text(*force.comparison, observed ? "momentum observer" : "virtual sensor",
                                         "force sensor", force.unit);
  }
  return text;
}

}  // namespace mbk::report
