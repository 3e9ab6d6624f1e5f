// Errata that an earlier version charged and that the computation does not bear out.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include "mbk/measure/calibration/force_sensor.h"
#include "thesis/errata.h"

namespace mbk::thesis {
namespace {

/// What was charged and why it does not hold: words alone.
ReproducedTable reasons() {
  return computed_table("withdrawn-errata", "erratum", {{"charge", "", 0}, {"why it was withdrawn", "", 0}});
}

/// (E.3) at another lever arm L, F = (L₀/L)(a V + c), with c tuned so that no force reads zero: c = −a V₀.
ReproducedTable scaled_forces(const Given& given) {
  const double slope = given.number("setup", "slope of Fx, N/V"), offset = given.number("setup", "offset of Fx, N");
  const double L0 = given.number("setup", "lever arm L0, m"), L = 0.1;
  ReproducedTable table = computed_table("withdrawn-errata 15", "force on x", {{"voltage", "V", 3}, {"(E.3)", "N", 3}});
  const double zero = -offset / slope, intercept = -slope * zero;
  for (const auto& [name, force] : {std::pair{"0 N", 0.0}, {"5 N", 5.0}, {"−5 N", -5.0}}) {
    const double voltage = zero + force * L / L0 / slope;
    table.rows.push_back({name, {cell(voltage), cell(L0 / L * (slope * voltage + intercept) + 0.0)}});
  }
  return table;
}

/// The error that rounding to whole codes makes, against the printed noise.
ReproducedTable converter_noise(const Given& given) {
  const calibration::Converter converter{.range = given.number("setup", "converter range, V")};
  const double step = std::abs(given.number("setup", "slope of Fx, N/V")) * converter.step();
  const PrintedNumber& noise = *given.tables.at("setup").find("noise of one axis, N", "value");
  const double rounding = step / std::sqrt(12.0);
  ReproducedTable table = computed_table("withdrawn-errata 15 noise", "", {{"value", "", 4}});
  table.rows = {{"step of the converter [N]", {cell(step)}},
                {"step/√12 [N]", {cell(rounding)}},
                {"printed noise [N]", {cell(noise.value)}},
                {"rounds to the printed noise", {words(yes(std::abs(rounding - noise.value) <= noise.rounding))}}};
  return table;
}

/// How far (m s² + b s + k)(1 + 4 s/p)/(1 + s/p)⁴, four poles and three zeros, is from m s² + b s + k: the largest
/// relative difference over 0.05 to 10 Hz. The factor 1 + 4 s/p takes the first power of s/p away.
double distance_from_impedance(const impedance::Model& arm, double pole_hz) {
  constexpr double kLowest = 0.05, kHighest = 10.0;  // [Hz]
  constexpr int kPoints = 200;
  double largest = 0.0;
  for (int i = 0; i <= kPoints; ++i) {
    const double frequency = kLowest * std::pow(kHighest / kLowest, static_cast<double>(i) / kPoints);
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequency), x = s / (2.0 * std::numbers::pi * pole_hz);
    const std::complex<double> impedance = arm.M(1, 1) * s * s + arm.B(1, 1) * s + arm.K(1, 1);
    const std::complex<double> proper = impedance * (1.0 + 4.0 * x) / std::pow(1.0 + x, 4);
    largest = std::max(largest, std::abs(proper / impedance - 1.0));
  }
  return largest;
}

ReproducedTable proper_impedances(const Given& given) {
  const impedance::Model arm = model_of(arm_of(given.sinusoidal, "P2"));
  ReproducedTable table =
      computed_table("withdrawn-errata 16", "poles at", {{"largest relative difference, 0.05 to 10 Hz", "", 10}});
  for (const auto& [name, pole] : {std::pair{"1 kHz", 1e3}, {"10 kHz", 1e4}, {"500 kHz", 5e5}}) {
    table.rows.push_back({name, {cell(distance_from_impedance(arm, pole))}});
  }
  return table;
}

/// What both methods differ by, as a share of the theoretical value: the mean and the least and largest [%].
ReproducedTable relative_discrepancies(const Given& given) {
  ReproducedTable table = computed_table("withdrawn-errata 19", "parameter",
                                         {{"theoretical, least", "N/m or kg", 2},
                                          {"theoretical, largest", "N/m or kg", 2},
                                          {"discrepancy, mean", "N/m or kg", 2},
                                          {"relative discrepancy, mean", "%", 1}});
  const auto add = [&](const char* name, const std::vector<PrintedRig>& rigs, std::size_t k) {
    double least = 1e300, largest = -1e300, absolute = 0.0, relative = 0.0;
    for (const PrintedRig& rig : rigs) {
      const double theory = rig.theoretical[k].value;
      const double apart = std::abs(rig.error_method_1[k].value - rig.error_method_2[k].value);
      least = std::min(least, theory);
      largest = std::max(largest, theory);
      absolute += apart / static_cast<double>(rigs.size());
      relative += 100.0 * apart / std::abs(theory) / static_cast<double>(rigs.size());
    }
    table.rows.push_back({name, {cell(least), cell(largest), cell(absolute), cell(relative)}});
  };
  add("k_xx", given.stiffnesses, 0);
  add("k_yy", given.stiffnesses, 1);
  add("m", given.masses, 0);
  add("k_s, which crosses zero", given.stiffnesses, 2);
  return table;
}

}  // namespace

Result<void> withdrawn_errata(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {"mbk sensor calibrate --help      # --lever-arm-mm, --bits, --range"};
  exhibit.related = {"table-E.2", "table-4.4", "table-5.4"};
  const Given& given = bench.given();
  exhibit.tables = {reasons(), scaled_forces(given), converter_noise(given), proper_impedances(given),
                    relative_discrepancies(given)};
  return {};
}

}  // namespace mbk::thesis
