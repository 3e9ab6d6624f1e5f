// What the source says in its text and captions that follows from other numbers it prints.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/model/perturbation/underdamped_pulse.h"
#include "mbk/model/robot/dynamics.h"
#include "mbk/model/robot/workspace.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/thesis/slips.h"

namespace mbk::thesis {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi, kInch = 0.0254;

/// Statements of one chapter: what is said, the number that follows, and from what.
class Statements {
 public:
  Statements(const char* id, const char* title)
      : table_(computed_table(id, title, "statement", {{"value", "", 2}, {"from", "", 0}})) {}

  void number(const char* name, double value, std::string from) { add(name, cell(value), std::move(from)); }
  void number(const char* name, double value, std::pair<double, double> range, std::string from) {
    add(name, cell(value, range), std::move(from));
  }
  void text(const char* name, std::string value, std::string from) {
    add(name, words(std::move(value)), std::move(from));
  }
  /// Of something that should hold for each of several; the exceptions by name.
  void each(const char* name, const std::vector<std::pair<std::string, bool>>& cases, const char* from) {
    std::string exceptions;
    std::size_t holds = 0;
    for (const auto& [what, is] : cases) {
      if (is) ++holds;
      if (!is) exceptions += fmt::format("{}{}", exceptions.empty() ? "; not " : ", ", what);
    }
    constexpr std::size_t kFewExceptions = 3;
    if (cases.size() - holds > kFewExceptions) exceptions.clear();
    add(name, words(fmt::format("{} of {}", holds, cases.size())), from + exceptions);
  }

  [[nodiscard]] ReproducedTable take() { return std::move(table_); }

 private:
  void add(const char* name, ReproducedCell value, std::string from) {
    table_.rows.push_back({name, {std::move(value), words(std::move(from))}});
  }
  ReproducedTable table_;
};

using Cases = std::vector<std::pair<std::string, bool>>;

/// By how much two axes differ in angle, 0 to 90°.
double between_axes(double a, double b) {
  return std::abs(std::remainder(a - b, 180.0));
}

double relative_change(double from, double to) {
  return 100.0 * std::abs(to / from - 1.0);
}

/// Largest |r| of a step through (3.5) for a step of height 1.
Result<double> overshoot() {
  const auto pulse = perturbation::UnderdampedPulse::create(1.0);
  if (!pulse) return tl::unexpected(pulse.error());
  double largest = 0.0;
  for (int i = 0; i <= 20000; ++i) largest = std::max(largest, pulse->at(1e-4 * i).value);
  return largest;
}

/// The diameter of what both joints' ranges leave the hand [m], and how far one joint alone moves it.
struct HandRange {
  double both, one;
};
Result<HandRange> hand_range(double degrees) {
  const robot::Geometry geometry;
  const auto theta = robot::joint_angles(geometry, {0.3, -0.05});
  if (!theta) return tl::unexpected(theta.error());
  const double half = 0.5 * degrees / kDegrees;
  const auto at = [&](double first, double second) {
    return robot::hand_position(geometry, *theta + half * Eigen::Vector2d(first, second));
  };
  return HandRange{std::max((at(1, 1) - at(-1, -1)).norm(), (at(1, -1) - at(-1, 1)).norm()),
                   std::max((at(1, 0) - at(-1, 0)).norm(), (at(0, 1) - at(0, -1)).norm())};
}

// Chapter 3.

/// Ages, counts and times of the protocol.
void protocol(const Given& given, Statements& table) {
  const auto setup = [&](const char* name) { return given.number("setup", name); };
  const double people = setup("participants");
  table.number("mean age of six people", std::round(people * setup("mean age")) / people,
               "whole years: a sum of 169 over six, the nearest that can be");
  table.number("angle between directions [°]", 360.0 / setup("directions"), "360° over eight");
  const double each = setup("perturbations in each direction");
  table.number("perturbations of a trial", each * setup("directions"), "two in each of eight directions");
  table.number("perturbations of a trial with 16 directions", each * setup("directions of further experiments"),
               "two in each direction (footnote 4)");
  table.number("data of eight pulses at most [s]",
               setup("first pulses, to identify") * setup("longest perturbation, s"), "eight of 2 s");
  table.number("window of a trial [s]", setup("data stop, s") - setup("data start, s"), "appendix C, tstart and tstop");
  table.number("data to identify, sinusoidal [s]", setup("split, s") - setup("data start, s"),
               "appendix C, tstart and tsplit");
  const double lost = 2.0 * (setup("window W of chapter 3") + 1.0) / 2.0;
  table.number("data to validate, sinusoidal [s]", setup("data stop, s") - setup("split, s") + 1e-3 * (1.0 - lost),
               "appendix C: what the filter loses at both ends comes off it (slip 13)");
  table.number("conditions of theorem 3.2",
               setup("last condition of theorem 3.2") - setup("first condition of theorem 3.2") + 1.0,
               "(3.18) to (3.25)");
}

Result<void> signals(const Given& given, Statements& table) {
  const auto setup = [&](const char* name) { return given.number("setup", name); };
  const auto peak = overshoot();
  if (!peak) return tl::unexpected(peak.error());
  table.number("the 5 mm step peaks at [mm]", *peak * setup("position step, mm"),
               "(3.5) with ζ = 0.1; the rest of the 11 mm would be the position controller's own overshoot");
  const auto range = hand_range(setup("joint range of chapter 3, °"));
  if (!range) return tl::unexpected(range.error());
  table.text("circle of the hand with 4° of each joint [mm]",
             fmt::format("{:.1f} to {:.1f}", 1e3 * range->one, 1e3 * range->both),
             "one joint alone, and both at an end at once: within 20 mm only while they do not");
  table.text("filter N = 6, W = 101 within the bounds of (3.6)",
             yes(setup("window W of chapter 3") >= 51.0 &&
                 setup("order N of chapter 3") < (setup("window W of chapter 3") - 1.0) / 2.0),
             "W ≥ 51 and N < (W − 1)/2");
  const auto lowpass = dsp::butterworth_lowpass(5, Hertz(setup("cutoff of chapter 3, Hz")), Hertz(1000.0));
  const auto smoothing = dsp::savitzky_golay_gain({6, 101}, 0, Hertz(5.0), Hertz(1000.0));
  if (!lowpass) return tl::unexpected(lowpass.error());
  if (!smoothing) return tl::unexpected(smoothing.error());
  table.number("gain of the smoothing filter at 5 Hz",
               *smoothing * std::pow(dsp::gain(*lowpass, Hertz(5.0), Hertz(1000.0)), 2),
               "not near unity at the end of the band: slip 7");
  const double counts =
      2.0 * std::numbers::pi * robot::Geometry().d2 / (1e-3 * setup("resolution of the position, mm"));
  table.number("counts a turn behind the resolution", std::round(counts),
               "2π d₂ over 0.002 mm, behind the capstan; the encoders' own are not printed");
  return {};
}

void ellipses(const Given& given, Statements& table) {
  Cases between, nearer;
  double largest = 0.0, smallest = 1e300;
  for (const PrintedArm& arm : given.sinusoidal) {
    const double inertia = arm.ellipses[0].orientation.value, damping = arm.ellipses[1].orientation.value,
                 stiffness = arm.ellipses[2].orientation.value;
    between.emplace_back(arm.name, std::min(inertia, stiffness) <= damping && damping <= std::max(inertia, stiffness));
    nearer.emplace_back(arm.name, between_axes(damping, stiffness) < between_axes(damping, inertia));
    largest = std::max(largest, arm.ellipses[2].area.value);
    smallest = std::min(smallest, arm.ellipses[2].area.value);
  }
  table.each("damping between stiffness and inertia in angle", between, "table 3.3");
  table.each("damping nearer to stiffness than to inertia in angle", nearer, "table 3.3");
  table.number("size of the stiffness ellipse, largest over smallest", largest / smallest, "table 3.3, A");
  Cases more_damping, less_elsewhere;
  double turned = 0.0, reshaped = 0.0;
  for (const PrintedArm& pulses : given.underdamped) {
    const PrintedArm& sines = arm_of(given.sinusoidal, pulses.name);
    for (std::size_t k = 0; k < 3; ++k) {
      const bool rises = pulses.ellipses[k].area.value > sines.ellipses[k].area.value;
      if (k == 1) more_damping.emplace_back(pulses.name, rises);
      if (k != 1) less_elsewhere.emplace_back(pulses.name, !rises);
      turned =
          std::max(turned, between_axes(pulses.ellipses[k].orientation.value, sines.ellipses[k].orientation.value));
      reshaped = std::max(reshaped, relative_change(sines.ellipses[k].shape.value, pulses.ellipses[k].shape.value));
    }
  }
  table.each("damping area larger with pulses", more_damping, "tables 3.3 and 3.5");
  table.each("inertia and stiffness area smaller with pulses", less_elsewhere, "tables 3.3 and 3.5");
  table.text("orientation, pulses against sinusoidal [°]", fmt::format("{:.1f} at most", turned),
             "tables 3.3 and 3.5, θ");
  table.text("shape, pulses against sinusoidal [%]", fmt::format("{:.0f} at most", reshaped),
             "tables 3.3 and 3.5, R: P1's inertia; whether that is substantial the source does not say");
  // Links as in the simulated participants, the hand 0.52 m ahead of the shoulder, elbow to the right.
  constexpr double kUpperArm = 0.31, kForearm = 0.34, kAhead = 0.52;
  const double shoulder =
      std::acos((kUpperArm * kUpperArm + kAhead * kAhead - kForearm * kForearm) / (2.0 * kUpperArm * kAhead));
  const Eigen::Vector2d elbow = kUpperArm * Eigen::Vector2d(std::sin(shoulder), std::cos(shoulder));
  const double forearm = kDegrees * std::atan2(kAhead - elbow[1], -elbow[0]);
  double off_forearm = 0.0, off_shoulder = 0.0;
  for (const PrintedArm& arm : given.sinusoidal) {
    off_forearm = std::max(off_forearm, between_axes(arm.ellipses[0].orientation.value, forearm));
    off_shoulder = std::max(off_shoulder, between_axes(arm.ellipses[2].orientation.value, 90.0));
  }
  table.text("major axis of inertia from the forearm [°]", fmt::format("{:.1f} at most", off_forearm),
             "table 3.3; links of 0.31 and 0.34 m, which are ours: the source prints none");
  table.text("major axis of stiffness from the line to the shoulder [°]", fmt::format("{:.1f} at most", off_shoulder),
             "table 3.3; the shoulder is at 90° of the test location");
}

Result<ReproducedTable> chapter_3(const Given& given) {
  Statements table("statements 3", "Chapter 3");
  protocol(given, table);
  if (auto ok = signals(given, table); !ok) return tl::unexpected(ok.error());
  ellipses(given, table);
  return table.take();
}

/// The range of the excess, which the source takes from table 3.6.
ReproducedTable excess_range(const Given& given) {
  Statements table("statements slip-1", "Sections 3.6.3 and 4.5: the range of the excess");
  double least = 1e300, most = 0.0;
  std::pair<double, double> of_least, of_most;
  for (const auto* arms : {&given.sinusoidal, &given.underdamped}) {
    for (const PrintedArm& arm : *arms) {
      const PrintedNumber &area = arm.ellipses[1].area, &shape = arm.ellipses[1].shape;
      const auto smallest = [](double A, double R) { return std::sqrt(A / (std::numbers::pi * R)); };
      const double value = smallest(area.value, shape.value);
      const std::pair range{smallest(area.low(), shape.high()), smallest(area.high(), shape.low())};
      if (value < least) of_least = range;
      if (value > most) of_most = range;
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  table.number("excess of the relaxed arm, from [N·s/m]", least, of_least, "λ_min of tables 3.3 and 3.5");
  table.number("excess of the relaxed arm, to [N·s/m]", most, of_most, "λ_min of tables 3.3 and 3.5");
  ReproducedTable done = table.take();
  done.slip = "slip-1";
  return done;
}

// Chapter 4.

Result<ReproducedTable> chapter_4(Workbench& bench) {
  const Given& given = bench.given();
  Statements table("statements 4", "Chapter 4 and appendix B");
  const auto peak = overshoot();
  if (!peak) return tl::unexpected(peak.error());
  const auto scenario = task_scenario(Task::rigid_underdamped, 1, bench.seed(1, 1));
  if (!scenario) return tl::unexpected(scenario.error());
  const auto performance = laboratory::simulate(*scenario);
  if (!performance) return tl::unexpected(performance.error());
  const Vector& x = performance->recording.find("force_x")->values;
  const Vector& y = performance->recording.find("force_y")->values;
  const double strongest = (x.array().square() + y.array().square()).sqrt().maxCoeff();
  table.number(
      "force of the 2 N step at its peak [N]", *peak * given.number("setup", "force step, N"),
      fmt::format("(3.5): what is commanded; what a sensor reads has the person's answer in it, up to {:.1f} N "
                  "in a simulated trial of P1",
                  strongest));
  table.number("force of the 8 N step at its peak [N]", *peak * given.number("setup", "large force step, N"),
               "(3.5); the consent form allows 8 N, which the step keeps and its overshoot does not; the motors' limit "
               "of 20 N holds");
  Cases above;
  double least = 1e300;
  for (const auto* arms : {&given.sinusoidal, &given.underdamped}) {
    for (const PrintedArm& arm : *arms) {
      const double excess = impedance::smallest_eigenvalue(model_of(arm), 1).value;
      above.emplace_back(arm.name, excess > given.number("setup", "excess said to be useful, N·s/m"));
      least = std::min(least, excess);
    }
  }
  table.each("excess of every participant above that said to be useful", above, "λ_min of tables 3.3 and 3.5");
  table.number("least excess over that said to be useful",
               least / given.number("setup", "excess said to be useful, N·s/m"), "λ_min of P6 over 0.9 N·s/m");
  const PrintedTable& shortage = given.tables.at("4.5");
  const auto rank = [&](const char* name) {
    const double own = shortage.rows.at(name).front().value;
    return 1 + std::ranges::count_if(shortage.rows, [&](const auto& row) { return row.second.front().value > own; });
  };
  table.text("ranks of P3 and P6 in table 4.5", fmt::format("{} and {} of 6", rank("P3"), rank("P6")),
             "no contradiction: the shortage is energy over ∫v², and both moved farthest");
  return table.take();
}

// Chapter 5.

Cases per_element(const std::vector<PrintedRig>& rigs, const std::vector<const char*>& names, const auto& holds) {
  Cases cases;
  for (const PrintedRig& rig : rigs) {
    for (std::size_t k = 0; k < names.size(); ++k) {
      cases.emplace_back(fmt::format("{} {}", rig.name, names[k]), holds(rig, k));
    }
  }
  return cases;
}

void errors_of_both_methods(const Given& given, Statements& table) {
  const auto closer = [](const PrintedRig& rig, std::size_t k) {
    return std::abs(rig.error_method_2[k].value) < std::abs(rig.error_method_1[k].value);
  };
  Cases physical = per_element(given.stiffnesses, {"k_xx", "k_yy", "k_s"}, closer);
  for (const auto& one : per_element(given.masses, {"m"}, closer)) physical.push_back(one);
  table.each("physical sensor closer to theory than virtual", physical, "table 5.4");
  const auto largest_xx = [](const PrintedRig& rig, std::size_t) {
    const auto apart = [&](std::size_t k) {
      return std::abs(rig.error_method_1[k].value - rig.error_method_2[k].value);
    };
    return apart(0) > apart(1) && apart(0) > apart(2);
  };
  table.each("discrepancy of both methods largest for k_xx", per_element(given.stiffnesses, {"k_xx"}, largest_xx),
             "table 5.4, in N/m; relative to the value it is k_s: slip 19");
  const auto mean_error = [](const std::vector<PrintedRig>& rigs, std::size_t elements, auto method) {
    double sum = 0.0;
    for (const PrintedRig& rig : rigs) {
      for (std::size_t k = 0; k < elements; ++k) sum += std::abs((rig.*method)[k].value / rig.theoretical[k].value);
    }
    return 100.0 * sum / static_cast<double>(rigs.size() * elements);
  };
  table.text("inertia nearer to theory than stiffness, relatively",
             fmt::format("{:.1f} and {:.1f} % against {:.1f} and {:.1f} %",
                         mean_error(given.masses, 1, &PrintedRig::error_method_1),
                         mean_error(given.masses, 1, &PrintedRig::error_method_2),
                         mean_error(given.stiffnesses, 2, &PrintedRig::error_method_1),
                         mean_error(given.stiffnesses, 2, &PrintedRig::error_method_2)),
             "tables 5.1 and 5.4, mean errors of m and of k_xx, k_yy by methods 1 and 2");
}

void rigs(const Given& given, Statements& table) {
  const auto setup = [&](const char* name) { return given.number("setup", name); };
  table.number("impedance configurations", setup("stiffnesses") * setup("payloads"), "five stiffnesses, five payloads");
  table.number("trials in all", setup("stiffnesses") * setup("payloads") * setup("trials of each configuration"),
               "three of each");
  table.number("trials behind an entry of table 5.3", setup("payloads") * setup("trials of each configuration"),
               "three with each of five partners");
  const auto ratio = [&](std::size_t rig) {
    return given.stiffnesses[rig].theoretical[0].value / given.stiffnesses[rig].theoretical[1].value;
  };
  table.text("K1 and K2 stiffer along x", fmt::format("{:.2f} and {:.2f} times", ratio(0), ratio(1)), "table 5.1");
  table.text("K3 and K4 stiffer along y", fmt::format("{:.2f} and {:.2f} times", 1.0 / ratio(2), 1.0 / ratio(3)),
             "table 5.1");
  table.number("k_xx over k_yy of K5", ratio(4), "table 5.1");
  Cases above, well_above, stiffer;
  const PrintedTable& vaf = given.tables.at("5.5");
  for (std::size_t k = 0; k < given.stiffnesses.size(); ++k) {
    const std::vector<PrintedNumber>& row = vaf.rows.at(given.stiffnesses[k].name);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string name = given.stiffnesses[k].name + " " + vaf.columns[i];
      above.emplace_back(name, row[i].value > setup("limit of VAF, %"));
      well_above.emplace_back(name, row[i].value > setup("second limit of VAF, %"));
      constexpr std::size_t kIsotropic = 4;  // K5
      if (i % 2 == 0 && k != kIsotropic) {
        stiffer.emplace_back(name, (row[i].value > row[i + 1].value) == (ratio(k) > 1.0));
      }
    }
  }
  table.each("VAF by method 1 above 83 %", above, "table 5.5");
  table.each("VAF by method 1 above 92 %", well_above, "table 5.5: all but x of K3 and K4, and one of exactly 92.0");
  table.each("VAF larger in the stiffer direction", stiffer, "tables 5.1 and 5.5, without K5");
}

Result<void> places_and_resonances(const Given& given, Statements& table) {
  const PrintedTable& chapter3 = given.tables.at("3.1");
  Cases known, reached;
  for (const PrintedRig& mass : given.masses) {
    known.emplace_back(mass.name, std::ranges::any_of(chapter3.rows, [&](const auto& row) {
                         return row.second.back().text == mass.theoretical.front().text;
                       }));
  }
  table.each("payloads of table 5.1 among those of table 3.1", known, "the same five weights");
  for (const PrintedTable* places : {&chapter3, &given.tables.at("5.1 stiffness")}) {
    for (const auto& [name, row] : places->rows) {
      reached.emplace_back(name, robot::check_hand({}, {1e-3 * row[3].value, 1e-3 * row[4].value}).has_value());
    }
  }
  table.each("x₀ of tables 3.1 and 5.1 within the joints' limits", reached, "(A.2), (A.4)");
  int inside = 0, all = 0;
  double lowest = 1e300, highest = 0.0;
  for (const PrintedRig& rig : given.stiffnesses) {
    const Matrix K{{rig.theoretical[0].value, rig.theoretical[2].value},
                   {rig.theoretical[2].value, rig.theoretical[1].value}};
    const impedance::Ellipse ellipse = impedance::ellipse(K);
    for (const PrintedRig& mass : given.masses) {
      for (const double stiffness : {ellipse.lambda_min, ellipse.lambda_max}) {
        const double frequency = std::sqrt(stiffness / mass.theoretical.front().value) / (2.0 * std::numbers::pi);
        lowest = std::min(lowest, frequency);
        highest = std::max(highest, frequency);
        inside += frequency >= given.number("setup", "lowest resonance, Hz") &&
                          frequency <= given.number("setup", "highest resonance, Hz")
                      ? 1
                      : 0;
        ++all;
      }
    }
  }
  table.text("resonances of payload and springs between 4 and 5 Hz", fmt::format("{} of {}", inside, all),
             fmt::format("√(λ/m)/2π of table 5.1: {:.1f} to {:.1f} Hz, so what resonated was not the payload on its "
                         "springs alone",
                         lowest, highest));
  const auto range = hand_range(given.number("setup", "joint range of chapter 5, °"));
  if (!range) return tl::unexpected(range.error());
  table.text("circle of the hand with 10° of each joint [mm]",
             fmt::format("{:.1f} to {:.1f}", 1e3 * range->one, 1e3 * range->both),
             "one joint alone, and both at an end at once");
  return {};
}

Result<ReproducedTable> chapter_5(const Given& given) {
  Statements table("statements 5", "Chapter 5");
  rigs(given, table);
  errors_of_both_methods(given, table);
  if (auto ok = places_and_resonances(given, table); !ok) return tl::unexpected(ok.error());
  return table.take();
}

// Appendices.

Result<ReproducedTable> appendices(const Given& given) {
  const auto setup = [&](const char* name) { return given.number("setup", name); };
  Statements table("statements appendices", "Formulas of the text and the appendices");
  constexpr double kRounding = 1e-12;
  double eigenvalues = 0.0;
  for (const PrintedArm& arm : given.sinusoidal) {
    const Matrix Z = symmetric_matrix(arm.ellipses[2]);
    const double sum = Z(0, 0) + Z(1, 1);
    const double largest = 0.5 * (sum + std::sqrt(sum * sum + 4.0 * (Z(0, 1) * Z(0, 1) - Z(0, 0) * Z(1, 1))));
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(Z);
    eigenvalues = std::max(eigenvalues, std::abs(largest / solver.eigenvalues()[1] - 1.0));
  }
  table.text("(3.14) gives the eigenvalues", yes(eigenvalues < kRounding), fmt::format("to {:.0e}", eigenvalues));
  const robot::Geometry geometry;
  const Eigen::Vector2d theta(0.4, 0.9), rate(1.2, -0.7), acceleration(3.0, 2.0);
  const Eigen::Matrix2d J = robot::jacobian(geometry, theta), J_rate = robot::jacobian_rate(geometry, theta, rate);
  constexpr double kStep = 1e-4;  // [s], of the second difference of the hand's path, good to about 1e-6
  const auto hand = [&](double t) {
    return robot::hand_position(geometry, theta + rate * t + 0.5 * acceleration * t * t);
  };
  const Eigen::Vector2d hand_acceleration = (hand(kStep) - 2.0 * hand(0.0) + hand(-kStep)) / (kStep * kStep);
  const Eigen::Vector2d again = J.inverse() * (hand_acceleration - J_rate * rate);
  table.text(
      "(5.3) gives θ̈ back", yes((again - acceleration).norm() < 1e-4),
      fmt::format("to {:.0e} rad/s², the hand's acceleration by differences of (A.1)", (again - acceleration).norm()));
  const auto angles = robot::joint_angles(geometry, robot::hand_position(geometry, theta));
  if (!angles) return tl::unexpected(angles.error());
  table.text("(A.4) undoes (A.1)", yes((*angles - theta).norm() < kRounding), "on the branch that the limits allow");
  const Eigen::Matrix2d R = robot::link_axes(theta[1]);
  table.text("(E.4) is a rotation",
             yes((R * R.transpose() - Eigen::Matrix2d::Identity()).norm() < kRounding && R.determinant() > 0.0),
             "R Rᵀ = I, det R = 1");
  const double voltage = (setup("calibration force, N") + std::abs(setup("offset of Fx, N"))) /
                         std::min(-setup("slope of Fx, N/V"), -setup("slope of Fy, N/V"));
  table.text("calibration within the converter's range", yes(voltage < setup("converter range, V")),
             fmt::format("(E.2): 50 N are {:.1f} V at most", voltage));
  table.number("crosstalk [%]", 100.0 * setup("crosstalk, N") / setup("crosstalk load, N"), "0.5 N at 20 N, at most");
  const double half_side = 0.5 * kInch * setup("frame side, in");
  table.text("screw eyes inside the frame", yes(setup("frame d1, m") < half_side && setup("frame d2, m") < half_side),
             fmt::format("d₁ and d₂ of appendix D against half of 15.5 in, {:.3f} m", half_side));
  table.number("half of the beam less L₀ [mm]", 1e3 * (0.5 * kInch * setup("beam, in") - setup("lever arm L0, m")),
               "5 1/2 in with the gauges at its centre; the load hung about a millimetre inside its end");
  return table.take();
}

Result<void> all_statements(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {
      "Every number or claim in the text and the captions that follows from other numbers of the source. A number has "
      "to agree within its rounding or to be on the list of slips; of a claim it is counted in how many cases it "
      "holds, "
      "and the exceptions are named.",
      "Not here is what would need numbers that were not published: VAF of tables whose bodies are lost, distances of "
      "identified from theoretical equilibria, standard errors.",
      "Tests: Statements.FollowFromWhatIsGiven, Statements.NoneDiffersUnexplained."};
  exhibit.related = {"slip-1", "slip-7", "slip-12", "slip-13", "slip-15", "slip-19", "slip-20"};
  const Given& given = bench.given();
  for (auto&& table : {chapter_3(given), chapter_4(bench), chapter_5(given), appendices(given)}) {
    if (!table) return tl::unexpected(table.error());
    exhibit.tables.push_back(*table);
  }
  exhibit.tables.insert(exhibit.tables.begin() + 1, excess_range(given));
  return {};
}

constexpr std::array kMakers = {Maker{Exhibit::Kind::table, 0, "statements",
                                      "What the text says that follows from printed numbers", Provenance::recomputed,
                                      all_statements}};

}  // namespace

std::span<const Maker> statements() {
  return kMakers;
}

}  // namespace mbk::thesis
