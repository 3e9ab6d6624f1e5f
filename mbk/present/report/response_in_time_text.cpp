#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/model/trial/identification.h"
#include "mbk/present/report/exploration_parts_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace response_in_time {

std::string vaf(const ExplainedForce& one) {
  return with_interval(one.vaf, one.vaf_half_width) + " %";
}

/// " x", " y", " z", or nothing where there is one axis.
std::string axis_name(std::size_t axis, int axes) {
  return axes == 1 ? "" : fmt::format(" {}", kAxisNames[axis]);
}

std::string p_text(double p) {
  return p < 1e-12 ? "p < 1e-12" : fmt::format("p = {:.1g}", p);
}

/// One line for each matrix: its entries row by row.
void add_model(const ResponseModel& model, Motion motion, std::vector<std::vector<std::string>>& rows) {
  if (!model.identifiable) {
    rows.push_back({"M, B, K", "not identifiable: the motion does not excite enough directions"});
    return;
  }
  const Units units = units_of(motion);
  const auto add = [&](const char* name, const Matrix& value, const Matrix& half, bool identifiable,
                       const std::string& unit) {
    std::string cell;
    for (Index i = 0; i < value.rows(); ++i) {
      for (Index j = 0; j < value.cols(); ++j) {
        cell += (cell.empty() ? "" : ", ") + with_interval(value(i, j), half(i, j));
      }
    }
    rows.push_back({name, cell + " " + unit + (identifiable ? "" : ": not identifiable")});
  };
  add("M", model.M, model.M_half_width, model.M_identifiable, units.inertia);
  add("B", model.B, model.B_half_width, model.B_identifiable, units.damping);
  add("K", model.K, model.K_half_width, model.K_identifiable, units.stiffness);
}

/// A direction of stretch, in words.
std::string direction_name(const Vector& direction) {
  if (direction.size() == 0) return "both directions";
  if (direction.size() == 1) return direction[0] > 0.0 ? "positive" : "negative";
  if (direction.size() == 3) return fmt::format("({:.2f}, {:.2f}, {:.2f})", direction[0], direction[1], direction[2]);
  return fmt::format("{:.0f}°", kDegrees * std::atan2(direction[1], direction[0]));
}

/// Numbers for the axes, "0.93" or "0.93, 0.88".
std::string list_of(const Vector& values) {
  std::string list;
  for (const double value : values) list += (list.empty() ? "" : ", ") + fmt::format("{:.2f}", value);
  return list;
}

void add_emg_path(const EmgPath& emg, const ParallelCascadeEstimate& found, Motion motion,
                  std::vector<std::vector<std::string>>& rows) {
  rows.push_back({"EMG", (emg.explains ? "explains force: " : "not shown to explain force: ") + emg.why});
  for (std::size_t i = 0; i < emg.shares.size(); ++i) {
    const EmgShares& one = emg.shares[i];
    const bool reflex = found.found == DelayedResponse::reflex;
    rows.push_back({"VAF" + axis_name(i, found.axes),
                    fmt::format("intrinsic and EMG {}{}; EMG path {}", vaf(one.intrinsic_and_emg),
                                reflex ? fmt::format(", with reflex {}", vaf(one.all)) : "", vaf(one.emg_path))});
  }
  for (const EmgMuscle& muscle : emg.muscles) {
    if (muscle.gain.empty()) continue;
    std::string gains;
    for (const Margin& one : muscle.gain) {
      gains += (gains.empty() ? "" : ", ") + with_interval(one.value, one.half_width);
    }
    rows.push_back(
        {muscle.channel, fmt::format("F {} {} at an EMG of 1 {}", gains, units_of(motion).force, muscle.unit)});
  }
  for (const CoherenceBand& band : emg.coherence) {
    rows.push_back({fmt::format("{:g} to {:g} Hz", band.from_hz, band.to_hz),
                    fmt::format("coherence with motion {}, with motion and EMG {}", list_of(band.motion),
                                list_of(band.motion_and_emg))});
  }
}

}  // namespace response_in_time

std::string impulse_response_text(const ImpulseResponseEstimate& found, Motion motion) {
  using namespace response_in_time;
  std::string text = "impulse response\n";
  std::vector<std::vector<std::string>> rows = {
      {"memory", fmt::format("±{:.0f} ms by {}{}", kMilliseconds * found.memory, found.memory_rule,
                             found.memory_at_limit ? " (the longest that was tried; it may be longer)" : "")},
      {"rank",
       fmt::format("{} of {} directions of the lagged motion, by cross-validation", found.rank, found.directions)},
      {"loop", found.instruments ? "instrumental variables from the reference: valid in closed loop"
                                 : "no reference that explains the motion: biased if the force moves the robot"}};
  const std::string rows_judged = found.held_out ? "held-out data" : "in sample";
  for (std::size_t i = 0; i < found.explained.size(); ++i) {
    rows.push_back({"VAF" + axis_name(i, found.axes), fmt::format("{}; M, B, K alone {} ({})", vaf(found.explained[i]),
                                                                  vaf(found.explained_by_model[i]), rows_judged)});
  }
  add_model(found.model, motion, rows);
  if (found.model.identifiable && found.model.numerator > 0.0) {
    rows.push_back(
        {"M, B and K", fmt::format("{}: F({:.0f}, {:.0f}) = {:.3g}, {}",
                                   found.model.enough ? "suffice" : "do not suffice", found.model.numerator,
                                   found.model.denominator, found.model.statistic, p_text(found.model.p_value))});
  }
  return text + table(rows);
}

std::string parallel_cascade_text(const ParallelCascadeEstimate& found, Motion motion) {
  using namespace response_in_time;
  std::string text = "intrinsic and reflex force\n";
  std::vector<std::vector<std::string>> rows;
  switch (found.found) {
    case DelayedResponse::not_identifiable:
      rows.push_back({"reflex", "not identifiable: " + found.why});
      return text + table(rows);
    case DelayedResponse::none:
      rows.push_back({"reflex", "none found: " + found.why});
      break;
    case DelayedResponse::both_directions:
      rows.push_back({"reflex", "none found, but a delayed linear response: " + found.why});
      break;
    case DelayedResponse::reflex:
      rows.push_back({"reflex", "found: " + found.why});
      break;
  }
  std::string candidates;
  for (const StretchCandidate& one : found.candidates) {
    candidates += fmt::format("{}{} {:.2f} %", candidates.empty() ? "" : ", ", direction_name(one.direction), one.vaf);
  }
  rows.push_back({"stretch", candidates + fmt::format(", no delayed response {:.2f} % (cross-validated VAF)",
                                                      found.intrinsic_vaf)});
  const std::string judged = found.held_out ? " (held-out data)" : " (in sample)";
  const bool reflex = found.found == DelayedResponse::reflex;
  for (std::size_t i = 0; i < found.shares.size(); ++i) {
    const PathShares& one = found.shares[i];
    rows.push_back(
        {"VAF" + axis_name(i, found.axes),
         reflex ? fmt::format("intrinsic alone {}, with reflex {}{}", vaf(one.intrinsic_alone), vaf(one.both), judged)
                : fmt::format("intrinsic alone {}{}", vaf(one.intrinsic_alone), judged)});
    if (reflex) {
      rows.push_back(
          {"shares" + axis_name(i, found.axes), fmt::format("intrinsic path {}, reflex path {}; they overlap",
                                                            vaf(one.intrinsic_path), vaf(one.reflex_path))});
    }
  }
  if (found.emg) add_emg_path(*found.emg, found, motion, rows);
  if (!reflex) return text + table(rows);
  const std::string unit = units_of(motion).damping;
  rows.push_back({"direction", direction_name(found.direction) + " stretch"});
  rows.push_back(
      {"delay",
       fmt::format("response starts at {:.0f} ms ({:.0f} to {:.0f} ms){} and lasts until {:.0f} ms",
                   kMilliseconds * found.delay, kMilliseconds * found.delay_low, kMilliseconds * found.delay_high,
                   found.delay_at_limit ? ", the shortest delay that was tried," : "", kMilliseconds * found.memory)});
  rows.push_back({"gain", fmt::format("{} {}{}{}", with_interval(found.gain_along.value, found.gain_along.half_width),
                                      unit, found.gain_along.value > 0.0 ? ", resists the stretch" : ", assists it",
                                      found.gain_identifiable ? "" : ": not identifiable")});
  if (found.second_order) {
    const SecondOrderReflex& fit = *found.second_order;
    std::string gains;
    for (const Margin& one : fit.gain) {
      gains += (gains.empty() ? "" : ", ") + with_interval(one.value, one.half_width);
    }
    rows.push_back({"second order",
                    fmt::format("gain {} {}, delay {} ms, {} Hz, damping ratio {}; {} ({})", gains, unit,
                                with_interval(kMilliseconds * fit.delay.value, kMilliseconds * fit.delay.half_width),
                                with_interval(fit.frequency.value, fit.frequency.half_width),
                                with_interval(fit.damping.value, fit.damping.half_width),
                                fit.p_value < 0.01 ? "not sufficient" : "sufficient", p_text(fit.p_value))});
  }
  rows.push_back({"nonlinearity",
                  found.nonlinearity.size() == 1
                      ? std::string("half-wave rectified velocity")
                      : fmt::format("polynomial of order {} of the rectified velocity", found.nonlinearity.size())});
  rows.push_back({"intrinsic", "M, B, K of the intrinsic path"});
  add_model(found.intrinsic_model, motion, rows);
  return text + table(rows);
}

}  // namespace mbk::report
