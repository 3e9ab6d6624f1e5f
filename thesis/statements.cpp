// What the source says in its text and captions that follows from other numbers it prints.
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/model/perturbation/underdamped_pulse.h"
#include "mbk/model/robot/dynamics.h"
#include "mbk/model/robot/workspace.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "thesis/errata.h"

namespace mbk::thesis {
namespace {

constexpr double kInch = 0.0254;

/// Statements of one chapter: what is said and the number that follows; from what is in the text.
class Statements {
 public:
  Statements(const char* id, TextValues& values)
      : table_(computed_table(id, "statement", {{"value", "", 2}, {"from", "", 0}})), values_(values) {}

  void number(const char* name, double value) { add(name, cell(value)); }
  void number(const char* name, double value, std::pair<double, double> range) { add(name, cell(value, range)); }
  void text(const char* name, std::string value) { add(name, words(std::move(value))); }
  /// Of something that should hold for each of several. The text has the exceptions by name where it says so.
  void each(const char* name, const std::vector<std::pair<std::string, bool>>& cases, const char* exceptions_are) {
    std::string exceptions;
    std::size_t holds = 0;
    for (const auto& [what, is] : cases) {
      if (is) ++holds;
      if (!is) exceptions += fmt::format("{}{}", exceptions.empty() ? "; not " : ", ", what);
    }
    constexpr std::size_t kFewExceptions = 3;
    if (cases.size() - holds > kFewExceptions) exceptions.clear();
    value(exceptions_are, std::move(exceptions));
    add(name, words(fmt::format("{} of {}", holds, cases.size())));
  }

  /// Something else that the text speaks of.
  void value(const char* name, TextValues::mapped_type value) { values_[name] = std::move(value); }

  [[nodiscard]] ReproducedTable take() { return std::move(table_); }

 private:
  void add(const char* name, ReproducedCell value) { table_.rows.push_back({name, {std::move(value)}}); }

  ReproducedTable table_;
  TextValues& values_;
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
  const auto pulse = MBK_TRY(perturbation::UnderdampedPulse::create(1.0));
  double largest = 0.0;
  for (int i = 0; i <= 20000; ++i) largest = std::max(largest, pulse.at(1e-4 * i).value);
  return largest;
}

/// The diameter of what both joints' ranges leave the hand [m], and how far one joint alone moves it.
struct HandRange {
  double both, one;
};
Result<HandRange> hand_range(double degrees) {
  const robot::Geometry geometry;
  const auto theta = MBK_TRY(robot::joint_angles(geometry, {0.3, -0.05}));
  const double half = 0.5 * degrees / kDegrees;
  const auto at = [&](double first, double second) {
    return robot::hand_position(geometry, theta + half * Eigen::Vector2d(first, second));
  };
  return HandRange{std::max((at(1, 1) - at(-1, -1)).norm(), (at(1, -1) - at(-1, 1)).norm()),
                   std::max((at(1, 0) - at(-1, 0)).norm(), (at(0, 1) - at(0, -1)).norm())};
}

// Chapter 3.

/// Ages, counts and times of the protocol.
void protocol(const Given& given, Statements& table) {
  const auto setup = [&](const char* name) { return given.number("setup", name); };
  const double people = setup("participants");
  table.number("mean age of six people", std::round(people * setup("mean age")) / people);
  table.number("angle between directions [°]", 360.0 / setup("directions"));
  const double each = setup("perturbations in each direction");
  table.number("perturbations of a trial", each * setup("directions"));
  table.number("perturbations of a trial with 16 directions", each * setup("directions of further experiments"));
  table.number("data of eight pulses at most [s]",
               setup("first pulses, to identify") * setup("longest perturbation, s"));
  table.number("window of a trial [s]", setup("data stop, s") - setup("data start, s"));
  table.number("data to identify, sinusoidal [s]", setup("split, s") - setup("data start, s"));
  const double lost = 2.0 * (setup("window W of chapter 3") + 1.0) / 2.0;
  table.number("data to validate, sinusoidal [s]", setup("data stop, s") - setup("split, s") + 1e-3 * (1.0 - lost));
  table.number("conditions of theorem 3.2",
               setup("last condition of theorem 3.2") - setup("first condition of theorem 3.2") + 1.0);
}

Result<void> signals(const Given& given, Statements& table) {
  const auto setup = [&](const char* name) { return given.number("setup", name); };
  const auto peak = MBK_TRY(overshoot());
  table.number("the 5 mm step peaks at [mm]", peak * setup("position step, mm"));
  const auto range = MBK_TRY(hand_range(setup("joint range of chapter 3, °")));
  table.text("circle of the hand with 4° of each joint [mm]",
             fmt::format("{:.1f} to {:.1f}", 1e3 * range.one, 1e3 * range.both));
  table.text("filter N = 6, W = 101 within the bounds of (3.6)",
             yes(setup("window W of chapter 3") >= 51.0 &&
                 setup("order N of chapter 3") < (setup("window W of chapter 3") - 1.0) / 2.0));
  const auto lowpass = dsp::butterworth_lowpass(5, Hertz(setup("cutoff of chapter 3, Hz")), Hertz(1000.0));
  const auto smoothing = dsp::savitzky_golay_gain({6, 101}, 0, Hertz(5.0), Hertz(1000.0));
  if (!lowpass) return tl::unexpected(lowpass.error());
  if (!smoothing) return tl::unexpected(smoothing.error());
  table.number("gain of the smoothing filter at 5 Hz",
               *smoothing * std::pow(dsp::gain(*lowpass, Hertz(5.0), Hertz(1000.0)), 2));
  const double counts =
      2.0 * std::numbers::pi * robot::Geometry().d2 / (1e-3 * setup("resolution of the position, mm"));
  table.number("counts a turn behind the resolution", std::round(counts));
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
  table.each("damping between stiffness and inertia in angle", between, "not_between");
  table.each("damping nearer to stiffness than to inertia in angle", nearer, "not_nearer");
  table.number("size of the stiffness ellipse, largest over smallest", largest / smallest);
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
  table.each("damping area larger with pulses", more_damping, "not_more_damping");
  table.each("inertia and stiffness area smaller with pulses", less_elsewhere, "not_less_elsewhere");
  table.text("orientation, pulses against sinusoidal [°]", fmt::format("{:.1f} at most", turned));
  table.text("shape, pulses against sinusoidal [%]", fmt::format("{:.0f} at most", reshaped));
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
  table.text("major axis of inertia from the forearm [°]", fmt::format("{:.1f} at most", off_forearm));
  table.text("major axis of stiffness from the line to the shoulder [°]", fmt::format("{:.1f} at most", off_shoulder));
}

Result<ReproducedTable> chapter_3(const Given& given, TextValues& values) {
  Statements table("statements 3", values);
  protocol(given, table);
  MBK_TRY(signals(given, table));
  ellipses(given, table);
  return table.take();
}

/// The range of the excess, which the source takes from table 3.6.
ReproducedTable excess_range(const Given& given, TextValues& values) {
  Statements table("statements erratum-1", values);
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
  table.number("excess of the relaxed arm, from [N·s/m]", least, of_least);
  table.number("excess of the relaxed arm, to [N·s/m]", most, of_most);
  ReproducedTable done = table.take();
  done.erratum = "erratum-1";
  return done;
}

// Chapter 4.

Result<ReproducedTable> chapter_4(Workbench& bench, TextValues& values) {
  const Given& given = bench.given();
  Statements table("statements 4", values);
  const auto peak = MBK_TRY(overshoot());
  const auto scenario = MBK_TRY(task_scenario(Task::rigid_underdamped, 1, bench.seed(1, 1)));
  const auto performance = MBK_TRY(laboratory::simulate(scenario));
  const Vector& x = performance.recording.find("force_x")->values;
  const Vector& y = performance.recording.find("force_y")->values;
  table.value("strongest", (x.array().square() + y.array().square()).sqrt().maxCoeff());
  table.number("force of the 2 N step at its peak [N]", peak * given.number("setup", "force step, N"));
  table.number("force of the 8 N step at its peak [N]", peak * given.number("setup", "large force step, N"));
  Cases above;
  double least = 1e300;
  for (const auto* arms : {&given.sinusoidal, &given.underdamped}) {
    for (const PrintedArm& arm : *arms) {
      const double excess = impedance::smallest_eigenvalue(model_of(arm), 1).value;
      above.emplace_back(arm.name, excess > given.number("setup", "excess said to be useful, N·s/m"));
      least = std::min(least, excess);
    }
  }
  table.each("excess of every participant above that said to be useful", above, "not_useful");
  table.number("least excess over that said to be useful",
               least / given.number("setup", "excess said to be useful, N·s/m"));
  const PrintedTable& shortage = given.tables.at("4.5");
  const auto rank = [&](const char* name) {
    const double own = shortage.rows.at(name).front().value;
    return 1 + std::ranges::count_if(shortage.rows, [&](const auto& row) { return row.second.front().value > own; });
  };
  table.text("ranks of P3 and P6 in table 4.5", fmt::format("{} and {} of 6", rank("P3"), rank("P6")));
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
  table.each("physical sensor closer to theory than virtual", physical, "not_closer");
  const auto mean_discrepancy = [](const std::vector<PrintedRig>& rigs, std::size_t k) {
    double sum = 0.0;
    for (const PrintedRig& rig : rigs) {
      sum += std::abs((rig.error_method_1[k].value - rig.error_method_2[k].value) / rig.theoretical[k].value);
    }
    return 100.0 * sum / static_cast<double>(rigs.size());
  };
  table.text("relative discrepancy of both methods largest for k_xx",
             fmt::format("{:.1f} % against {:.1f} % of k_yy and {:.1f} % of m", mean_discrepancy(given.stiffnesses, 0),
                         mean_discrepancy(given.stiffnesses, 1), mean_discrepancy(given.masses, 0)));
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
                         mean_error(given.stiffnesses, 2, &PrintedRig::error_method_2)));
}

void rigs(const Given& given, Statements& table) {
  const auto setup = [&](const char* name) { return given.number("setup", name); };
  table.number("impedance configurations", setup("stiffnesses") * setup("payloads"));
  table.number("trials in all", setup("stiffnesses") * setup("payloads") * setup("trials of each configuration"));
  table.number("trials behind an entry of table 5.3", setup("payloads") * setup("trials of each configuration"));
  const auto ratio = [&](std::size_t rig) {
    return given.stiffnesses[rig].theoretical[0].value / given.stiffnesses[rig].theoretical[1].value;
  };
  table.text("K1 and K2 stiffer along x", fmt::format("{:.2f} and {:.2f} times", ratio(0), ratio(1)));
  table.text("K3 and K4 stiffer along y", fmt::format("{:.2f} and {:.2f} times", 1.0 / ratio(2), 1.0 / ratio(3)));
  table.number("k_xx over k_yy of K5", ratio(4));
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
  table.each("VAF by method 1 above 83 %", above, "not_above_83");
  table.each("VAF by method 1 above 92 %", well_above, "not_above_92");
  table.each("VAF larger in the stiffer direction", stiffer, "not_stiffer");
}

Result<void> places_and_resonances(const Given& given, Statements& table) {
  const PrintedTable& chapter3 = given.tables.at("3.1");
  Cases known, reached;
  for (const PrintedRig& mass : given.masses) {
    known.emplace_back(mass.name, std::ranges::any_of(chapter3.rows, [&](const auto& row) {
                         return row.second.back().text == mass.theoretical.front().text;
                       }));
  }
  table.each("payloads of table 5.1 among those of table 3.1", known, "not_known");
  for (const PrintedTable* places : {&chapter3, &given.tables.at("5.1 stiffness")}) {
    for (const auto& [name, row] : places->rows) {
      reached.emplace_back(name, robot::check_hand({}, {1e-3 * row[3].value, 1e-3 * row[4].value}).has_value());
    }
  }
  table.each("x₀ of tables 3.1 and 5.1 within the joints' limits", reached, "not_reached");
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
  table.value("lowest_resonance", lowest);
  table.value("highest_resonance", highest);
  table.text("resonances of payload and springs between 4 and 5 Hz", fmt::format("{} of {}", inside, all));
  const auto range = MBK_TRY(hand_range(given.number("setup", "joint range of chapter 5, °")));
  table.text("circle of the hand with 10° of each joint [mm]",
             fmt::format("{:.1f} to {:.1f}", 1e3 * range.one, 1e3 * range.both));
  return {};
}

Result<ReproducedTable> chapter_5(const Given& given, TextValues& values) {
  Statements table("statements 5", values);
  rigs(given, table);
  errors_of_both_methods(given, table);
  MBK_TRY(places_and_resonances(given, table));
  return table.take();
}

// Appendices.

Result<ReproducedTable> appendices(const Given& given, TextValues& values) {
  const auto setup = [&](const char* name) { return given.number("setup", name); };
  Statements table("statements appendices", values);
  constexpr double kRounding = 1e-12;
  double eigenvalues = 0.0;
  for (const PrintedArm& arm : given.sinusoidal) {
    const Matrix Z = symmetric_matrix(arm.ellipses[2]);
    const double sum = Z(0, 0) + Z(1, 1);
    const double largest = 0.5 * (sum + std::sqrt(sum * sum + 4.0 * (Z(0, 1) * Z(0, 1) - Z(0, 0) * Z(1, 1))));
    eigenvalues = std::max(eigenvalues, std::abs(largest / numeric::symmetric_eigenvalues(Z)[1] - 1.0));
  }
  table.value("eigenvalue_error", eigenvalues);
  table.text("(3.14) gives the eigenvalues", yes(eigenvalues < kRounding));
  const robot::Geometry geometry;
  const Eigen::Vector2d theta(0.4, 0.9), rate(1.2, -0.7), acceleration(3.0, 2.0);
  const Eigen::Matrix2d J = robot::jacobian(geometry, theta), J_rate = robot::jacobian_rate(geometry, theta, rate);
  constexpr double kStep = 1e-4;  // [s], of the second difference of the hand's path, good to about 1e-6
  const auto hand = [&](double t) {
    return robot::hand_position(geometry, theta + rate * t + 0.5 * acceleration * t * t);
  };
  const Eigen::Vector2d hand_acceleration = (hand(kStep) - 2.0 * hand(0.0) + hand(-kStep)) / (kStep * kStep);
  const double off = (J.inverse() * (hand_acceleration - J_rate * rate) - acceleration).norm();
  table.value("acceleration_error", off);
  table.text("(5.3) gives θ̈ back", yes(off < 1e-4));
  const auto angles = MBK_TRY(robot::joint_angles(geometry, robot::hand_position(geometry, theta)));
  table.text("(A.4) undoes (A.1)", yes((angles - theta).norm() < kRounding));
  const Eigen::Matrix2d R = robot::link_axes(theta[1]);
  table.text("(E.4) is a rotation",
             yes((R * R.transpose() - Eigen::Matrix2d::Identity()).norm() < kRounding && R.determinant() > 0.0));
  const double voltage = (setup("calibration force, N") + std::abs(setup("offset of Fx, N"))) /
                         std::min(-setup("slope of Fx, N/V"), -setup("slope of Fy, N/V"));
  table.value("calibration_voltage", voltage);
  table.text("calibration within the converter's range", yes(voltage < setup("converter range, V")));
  table.number("crosstalk [%]", 100.0 * setup("crosstalk, N") / setup("crosstalk load, N"));
  const double half_side = 0.5 * kInch * setup("frame side, in");
  table.value("half_side", half_side);
  table.text("screw eyes inside the frame", yes(setup("frame d1, m") < half_side && setup("frame d2, m") < half_side));
  table.number("half of the beam less L₀ [mm]", 1e3 * (0.5 * kInch * setup("beam, in") - setup("lever arm L0, m")));
  return table.take();
}

Result<void> all_statements(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"erratum-1", "erratum-7", "erratum-12", "erratum-13", "erratum-20", "withdrawn-errata"};
  const Given& given = bench.given();
  TextValues& values = exhibit.values;
  for (auto&& table :
       {chapter_3(given, values), chapter_4(bench, values), chapter_5(given, values), appendices(given, values)}) {
    if (!table) return tl::unexpected(table.error());
    exhibit.tables.push_back(*table);
  }
  exhibit.tables.insert(exhibit.tables.begin() + 1, excess_range(given, values));
  return {};
}

constexpr std::array kStatements = {
    Maker{Exhibit::Kind::table, 0, "statements", Provenance::recomputed, all_statements}};

}  // namespace

std::span<const Maker> statements() {
  return kStatements;
}

}  // namespace mbk::thesis
