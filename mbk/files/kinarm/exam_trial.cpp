#include "mbk/files/kinarm/exam_trial.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "mbk/base/numeric/dense.h"

namespace mbk::recording {
namespace {

constexpr double kEpsilon = 0x1p-23;      ///< of a 32-bit real
constexpr double kLengthsMatter = 5e-4;   ///< share of the motion by which wrong lengths may be off
constexpr double kNoMotion = 2e-2;        ///< share by which a recorded hand is another one, whatever the lengths
constexpr double kStill = 1e-4;           ///< [m] that a hand at rest may differ by
constexpr double kLengthsExplain = 0.25;  ///< share of the difference that other lengths leave where they explain it

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

/// The name that a unit has in mbk, or the unit as it is.
std::string unit_name(const std::string& unit) {
  struct Names {
    std::string_view unit;
    std::array<std::string_view, 7> others;
  };
  constexpr Names kNames[] = {
      {"rad", {"rad", "radian", "radians"}},
      {"rad/s", {"rad/s", "rad/sec", "radian/s", "radians/s", "radians/second"}},
      {"rad/s2", {"rad/s2", "rad/s^2", "rad/sec^2", "rad/s/s", "rad/s²", "radians/s^2"}},
      {"N.m", {"nm", "n.m", "n*m", "n m", "n-m", "n·m", "newton meters"}},
      {"N", {"n", "newton", "newtons"}},
      {"m", {"m", "meter", "meters", "metre", "metres"}},
  };
  const std::string plain = lower(unit);
  if (plain.empty()) return unit;
  for (const Names& names : kNames) {
    if (std::ranges::find(names.others, std::string_view(plain)) != names.others.end()) return std::string(names.unit);
  }
  return unit;
}

/// Whether a version, "3.4.2.1021", comes before another. A part that is not a number counts as 0.
bool is_before(std::string_view version, std::array<int, 3> other) {
  for (const int known : other) {
    int own = 0;
    const char* const end = version.data() + version.size();
    const char* const stop = std::from_chars(version.data(), end, own).ptr;
    if (own != known) return own < known;
    const std::size_t dot = std::string_view(stop, static_cast<std::size_t>(end - stop)).find('.');
    version = dot == std::string_view::npos
                  ? std::string_view()
                  : std::string_view(stop + dot + 1, static_cast<std::size_t>(end - stop) - dot - 1);
  }
  return false;
}

void drop_wrong_torques(ExamTrial& trial) {
  const std::string version = trial.parameters.text("EXPERIMENT", "TASK_PROGRAM_BUILD_TDK");
  if (!version.empty() && !is_before(version, {3, 4, 2})) return;
  const auto wrong = [](const ExamSignal& signal) { return signal.name.ends_with("_FS_TorqueX"); };
  std::vector<std::string> names;
  for (const ExamSignal& signal : trial.signals) {
    if (wrong(signal)) names.push_back(signal.name);
  }
  if (names.empty()) return;
  std::erase_if(trial.signals, wrong);
  trial.notes.push_back(
      fmt::format("{} {} omitted: the task development kit recorded it wrongly before version 3.4.2, and this exam {}; "
                  "forces and the other torques are correct",
                  fmt::join(names, " and "), names.size() == 1 ? "was" : "were",
                  version.empty() ? "states no version" : fmt::format("has version {}", version)));
}

/// The recorder calls the hand of a robot without a right arm "Right_Hand" all the same.
void rename_left_hand(ExamTrial& trial) {
  constexpr std::string_view kRight = "Right_Hand", kLeft = "Left_Hand";
  if (trial.parameters.number("RIGHT_KINARM", "IS_PRESENT") != 0.0) return;
  const auto begins = [&](std::string_view with) {
    return [with](const ExamSignal& signal) { return signal.name.starts_with(with); };
  };
  if (std::ranges::none_of(trial.signals, begins(kRight)) || std::ranges::any_of(trial.signals, begins(kLeft))) return;
  for (ExamSignal& signal : trial.signals) {
    if (signal.name.starts_with(kRight)) signal.name = std::string(kLeft) + signal.name.substr(kRight.size());
  }
  trial.notes.emplace_back(
      "there was no right arm (RIGHT_KINARM:IS_PRESENT is 0): Right_Hand is the left hand and was renamed Left_Hand");
}

/// A signal in one of these units, as long as `samples` (any length where it is negative); otherwise nullptr, and why.
const Vector* signal_in(const ExamTrial& trial, const std::string& name, std::string_view unit, Index samples,
                        std::vector<std::string>& why) {
  const ExamSignal* const signal = trial.find(name);
  if (signal == nullptr) {
    why.push_back(fmt::format("{} is missing", name));
  } else if (!signal->unit.empty() && signal->unit != unit) {
    why.push_back(fmt::format("{} is in '{}', not in {}", name, signal->unit, unit));
  } else if (samples >= 0 && signal->values.size() != samples) {
    why.push_back(fmt::format("{} has {} samples, not {}", name, signal->values.size(), samples));
  } else {
    return &signal->values;
  }
  return nullptr;
}

JointMotion joints_of(Arm arm, const ExamTrial& trial, std::vector<std::string>& why) {
  const auto take = [&](std::string_view name, std::string_view unit, Index samples,
                        std::vector<std::string>& missing) {
    return signal_in(trial, fmt::format("{}_{}", name_of(arm), name), unit, samples, missing);
  };
  JointMotion joints;
  joints.q1 = take("L1Ang", "rad", -1, why);
  joints.q2 = take("L2Ang", "rad", joints.q1 != nullptr ? joints.q1->size() : -1, why);
  if (joints.q1 == nullptr || joints.q2 == nullptr) return joints;
  const Index samples = joints.q1->size();
  joints.v1 = take("L1Vel", "rad/s", samples, why);
  joints.v2 = take("L2Vel", "rad/s", samples, why);
  joints.a1 = take("L1Acc", "rad/s2", samples, why);
  joints.a2 = take("L2Acc", "rad/s2", samples, why);
  joints.torque1 = take("M1TorCMD", "N.m", samples, why);
  joints.torque2 = take("M2TorCMD", "N.m", samples, why);
  return joints;
}

/// [m] in one of the unit of a point; 0 if it is not a length.
double metres_in(const std::string& unit) {
  if (unit.empty() || unit == "m") return 1.0;
  if (unit == "cm") return 1e-2;
  return unit == "mm" ? 1e-3 : 0.0;
}

struct RecordedHand {
  const ExamSignal *x = nullptr, *y = nullptr;
};

RecordedHand recorded_hand(Arm arm, const ExamTrial& trial) {
  for (const auto& [x, y] : {std::pair{".x", ".y"}, {"X", "Y"}}) {
    const RecordedHand hand{trial.find(fmt::format("{}_Hand{}", name_of(arm), x)),
                            trial.find(fmt::format("{}_Hand{}", name_of(arm), y))};
    if (hand.x != nullptr && hand.y != nullptr) return hand;
  }
  return {};
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// How the recorded hand and that by the joints differ, in one axis.
struct Difference {
  double offset = 0, largest = 0;  ///< [m]: median, and the largest distance from it
  double from = std::numeric_limits<double>::infinity(),
         to = -std::numeric_limits<double>::infinity();  ///< [m]: the recorded motion
  double size = 0;                                       ///< [m]: the largest recorded number
  bool any = false;
};

Difference difference(const ExamSignal& recorded, const Vector& computed) {
  Difference found;
  const double metres = metres_in(recorded.unit);
  std::vector<double> differences;
  for (Index i = 0; i < computed.size(); ++i) {
    const double position = metres * recorded.values[i];
    if (!std::isfinite(position) || !std::isfinite(computed[i])) continue;
    differences.push_back(position - computed[i]);
    found.from = std::min(found.from, position);
    found.to = std::max(found.to, position);
    found.size = std::max(found.size, std::abs(position));
  }
  if (differences.empty()) return found;
  found.any = true;
  found.offset = median(differences);
  for (const double one : differences) found.largest = std::max(found.largest, std::abs(one - found.offset));
  return found;
}

/// The lengths that fit the recorded hand best, wherever it counts from, and what they leave [m].
struct FittedLengths {
  double link1 = 0, link2 = 0, pointer = 0;
  double largest = std::numeric_limits<double>::infinity();  ///< [m] left in any sample
};

/// Least squares of x = c_x + L1 c1 + L2 c2 − p s2, y = c_y + L1 s1 + L2 s2 + p c2 over c, L1, L2 and p.
FittedLengths fitted_lengths(const RecordedHand& recorded, const JointMotion& joints) {
  using Row = Eigen::Matrix<double, 5, 1>;
  const double metres_x = metres_in(recorded.x->unit), metres_y = metres_in(recorded.y->unit);
  const auto each_row = [&](const auto& use) {
    for (Index i = 0; i < joints.q1->size(); ++i) {
      const double x = metres_x * recorded.x->values[i], y = metres_y * recorded.y->values[i];
      const double q1 = (*joints.q1)[i], q2 = (*joints.q2)[i];
      if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(q1) || !std::isfinite(q2)) continue;
      use(Row{1.0, 0.0, std::cos(q1), std::cos(q2), -std::sin(q2)}, x);
      use(Row{0.0, 1.0, std::sin(q1), std::sin(q2), std::cos(q2)}, y);
    }
  };
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Row right = Row::Zero();
  each_row([&](const Row& row, double position) {
    normal += row * row.transpose();
    right += position * row;
  });
  const Row fitted = numeric::CompleteOrthogonal(normal).solve(right);
  FittedLengths lengths{fitted[2], fitted[3], fitted[4], 0.0};
  each_row([&](const Row& row, double position) {
    lengths.largest = std::max(lengths.largest, std::abs(position - row.dot(fitted)));
  });
  return lengths;
}

double largest_in(const Vector& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::isfinite(value) ? std::max(largest, std::abs(value)) : largest;
  return largest;
}

std::string length_text(double metres) {
  return metres < 1e-3 ? fmt::format("{:.3g} µm", 1e6 * metres) : fmt::format("{:.4g} mm", 1e3 * metres);
}

/// Whether the recorded hand does not contradict the geometry; a note says how they compare.
bool agrees(Arm arm, const ExamTrial& trial, const HandGeometry& geometry, const JointMotion& joints,
            const HandSignal& position, std::vector<std::string>& notes) {
  const RecordedHand recorded = recorded_hand(arm, trial);
  const std::string hand = fmt::format("{0}_hand_x, {0}_hand_y", name_of(arm));
  const std::string by = fmt::format(
      "{} are computed from the joint angles ({}), relative to the axis of the first link", hand, geometry.from);
  if (recorded.x == nullptr || recorded.x->values.size() != position.x.size() ||
      recorded.y->values.size() != position.y.size() || metres_in(recorded.x->unit) == 0.0 ||
      metres_in(recorded.y->unit) == 0.0) {
    notes.push_back(by + "; no recorded position was available to confirm them");
    return true;
  }
  const Difference x = difference(*recorded.x, position.x), y = difference(*recorded.y, position.y);
  if (!x.any || !y.any) {
    notes.push_back(by + "; no recorded position was available to confirm them");
    return true;
  }
  const double rounding = kEpsilon * (std::max(x.size, y.size) + geometry.link1 * largest_in(*joints.q1) +
                                      (geometry.link2 + std::abs(geometry.pointer)) * largest_in(*joints.q2));
  const double largest = std::max(x.largest, y.largest), motion = std::max(x.to - x.from, y.to - y.from);
  const std::string name =
      recorded.x->name.substr(0, recorded.x->name.size() - (recorded.x->name.ends_with(".x") ? 2 : 1));
  std::string offset;
  if (std::max(std::abs(x.offset), std::abs(y.offset)) > rounding) {
    offset = fmt::format("; {} has a constant offset of ({:.6g}, {:.6g}) m, its origin", name, x.offset, y.offset);
  }
  if (largest <= rounding) {
    notes.push_back(fmt::format("{}; the recorded {} agrees within {}, its rounding error{}", by, name,
                                length_text(rounding), offset));
    return true;
  }
  const FittedLengths fitted = fitted_lengths(recorded, joints);
  const bool explained = fitted.largest <= kLengthsExplain * largest;
  const bool wrong = (explained && largest > std::max(kLengthsMatter * motion, 10.0 * rounding)) ||
                     largest > std::max(kNoMotion * motion, kStill);
  if (!wrong) {
    notes.push_back(
        fmt::format("{}; the recorded {} differs by up to {} in a motion of {}, more than the {} that rounding "
                    "explains; joints and hand may have been sampled at different times{}",
                    by, name, length_text(largest), length_text(motion), length_text(rounding), offset));
    return true;
  }
  const std::string better = explained
                                 ? fmt::format("it fits link lengths of {:.4g} m, {:.4g} m and a pointer of {:.4g} m",
                                               fitted.link1, fitted.link2, fitted.pointer)
                                 : std::string("no other link lengths explain it");
  notes.push_back(
      fmt::format("! {} do not fit: the recorded {} differs by up to {} in a motion of {} (rounding explains {}) from "
                  "the values computed with the link lengths ({}); {}. They are not used for hand, acceleration and "
                  "the sign of the force; --channels x={}_hand_x,… uses them nevertheless",
                  hand, name, length_text(largest), length_text(motion), length_text(rounding), geometry.from, better,
                  name_of(arm)));
  return false;
}

}  // namespace

const ExamSignal* ExamTrial::find(std::string_view name) const {
  const auto found = std::ranges::find(signals, name, &ExamSignal::name);
  return found == signals.end() ? nullptr : &*found;
}

Result<ExamTrial> join_parts(std::vector<ExamTrial> parts) {
  ExamTrial whole = std::move(parts.front());
  if (parts.size() == 1) return whole;
  std::vector<std::string> dropped;
  for (std::size_t k = 1; k < parts.size(); ++k) {
    if (std::abs(parts[k].rate_hz - whole.rate_hz) > kRateTolerance * whole.rate_hz) {
      return bad_data(
          fmt::format("part 1 of the trial runs at {} Hz, part {} at {} Hz", whole.rate_hz, k + 1, parts[k].rate_hz));
    }
  }
  const auto in_all = [&](const ExamSignal& signal) {
    return std::ranges::all_of(parts.begin() + 1, parts.end(), [&](const ExamTrial& part) {
      const ExamSignal* const same = part.find(signal.name);
      return same != nullptr && same->unit == signal.unit;
    });
  };
  for (const ExamSignal& signal : whole.signals) {
    if (!in_all(signal)) dropped.push_back(signal.name);
  }
  std::erase_if(whole.signals, [&](const ExamSignal& signal) { return !in_all(signal); });
  for (ExamSignal& signal : whole.signals) {
    Index samples = signal.values.size();
    for (std::size_t k = 1; k < parts.size(); ++k) samples += parts[k].find(signal.name)->values.size();
    Vector joined(samples);
    Index at = 0;
    const auto put = [&](const Vector& values) {
      joined.segment(at, values.size()) = values;
      at += values.size();
    };
    put(signal.values);
    for (std::size_t k = 1; k < parts.size(); ++k) {
      auto& signals = parts[k].signals;
      const auto same = std::ranges::find(signals, signal.name, &ExamSignal::name);
      put(same->values);
      same->values.resize(0);
    }
    signal.values = std::move(joined);
  }
  for (std::size_t k = 1; k < parts.size(); ++k) {
    const double before = whole.rate_hz > 0.0 ? whole.frames / whole.rate_hz : 0.0;
    for (Event& event : parts[k].events) {
      event.time += before;
      whole.events.push_back(std::move(event));
    }
    whole.frames += parts[k].frames;
    whole.notes.insert(whole.notes.end(), parts[k].notes.begin(), parts[k].notes.end());
  }
  whole.notes.push_back(
      fmt::format("the recorder split this trial into {} parts, which were joined without a gap; events of later parts "
                  "were shifted by the duration of the preceding parts",
                  parts.size()));
  if (!dropped.empty()) {
    whole.notes.push_back(fmt::format("omitted because the parts differ in them: {}", fmt::join(dropped, ", ")));
  }
  return whole;
}

void correct(ExamTrial& trial) {
  for (ExamSignal& signal : trial.signals) signal.unit = unit_name(signal.unit);
  rename_left_hand(trial);
  drop_wrong_torques(trial);
}

std::vector<Arm> arms_of(const ExamTrial& trial) {
  std::vector<Arm> arms;
  for (const Arm arm : {Arm::right, Arm::left}) {
    if (trial.parameters.number(fmt::format("{}_KINARM", capitals_of(arm)), "IS_PRESENT") == 0.0) continue;
    const ExamSignal* const q1 = trial.find(fmt::format("{}_L1Ang", name_of(arm)));
    const ExamSignal* const q2 = trial.find(fmt::format("{}_L2Ang", name_of(arm)));
    if (q1 == nullptr || q2 == nullptr) continue;
    if (largest_in(q1->values) > 0.0 || largest_in(q2->values) > 0.0) arms.push_back(arm);  // 0 throughout: no arm
  }
  return arms;
}

HandOfArm hand_of(Arm arm, const ExamTrial& trial, std::vector<std::string>& notes) {
  HandOfArm hand;
  std::vector<std::string> why;
  const JointMotion joints = joints_of(arm, trial, why);
  if (joints.q1 == nullptr || joints.q2 == nullptr) {
    notes.push_back(fmt::format("the {} hand cannot be computed: {}", lower(name_of(arm)), fmt::join(why, ", ")));
    return hand;
  }
  const auto geometry = geometry_of(arm, trial.parameters);
  if (!geometry) {
    notes.push_back(fmt::format("the {} hand cannot be computed: {}", lower(name_of(arm)), geometry.error().message));
    return hand;
  }
  if (!why.empty()) notes.push_back(fmt::format("some hand quantities cannot be computed: {}", fmt::join(why, ", ")));
  hand.position = geometry->position(joints);
  hand.trusted = agrees(arm, trial, *geometry, joints, hand.position, notes);
  if (joints.has_velocity()) hand.velocity = geometry->velocity(joints);
  if (joints.has_acceleration()) hand.acceleration = geometry->acceleration(joints);
  if (joints.has_torque()) {
    hand.commanded = geometry->commanded_force(joints);
    const auto singular = hand.commanded.x.array().isNaN() && joints.q1->array().isFinite() &&
                          joints.torque1->array().isFinite() && joints.torque2->array().isFinite();
    if (const Index count = singular.count(); count > 0) {
      notes.push_back(fmt::format("{}_commanded_force is NaN in {} samples, in which the links are collinear",
                                  name_of(arm), count));
    }
  }
  return hand;
}

bool has_force(Arm arm, const ExamTrial& trial) {
  std::vector<std::string> why;
  const Vector* const x = signal_in(trial, fmt::format("{}_FS_ForceX", name_of(arm)), "N", -1, why);
  return x != nullptr && signal_in(trial, fmt::format("{}_FS_ForceY", name_of(arm)), "N", x->size(), why) != nullptr;
}

ForceEvidence evidence_of(Arm arm, const ExamTrial& trial, const HandOfArm& hand) {
  if (!hand.trusted || !has_force(arm, trial) || hand.velocity.x.size() == 0) return {};
  const Vector& x = trial.find(fmt::format("{}_FS_ForceX", name_of(arm)))->values;
  const Vector& y = trial.find(fmt::format("{}_FS_ForceY", name_of(arm)))->values;
  if (x.size() != hand.velocity.x.size()) return {};
  return {x,
          y,
          hand.commanded.x,
          hand.commanded.y,
          hand.velocity.x,
          hand.velocity.y,
          hand.acceleration.x,
          hand.acceleration.y};
}

bool tells_of_force(std::string_view name) {
  constexpr auto kEnds =
      std::to_array<std::string_view>({"_L1Ang", "_L2Ang", "_L1Vel", "_L2Vel", "_L1Acc", "_L2Acc", "_M1TorCMD",
                                       "_M2TorCMD", "_FS_ForceX", "_FS_ForceY", "_Hand"});
  return std::ranges::any_of(kEnds, [&](std::string_view end) { return name.ends_with(end); });
}

}  // namespace mbk::recording
