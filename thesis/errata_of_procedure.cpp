// Errata about filters, samples, errors and models: chapters 3 to 5 and appendix C.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/measure/preprocess/prepare.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/perturbation/multisine.h"
#include "mbk/model/perturbation/underdamped_pulse.h"
#include "thesis/errata.h"

namespace mbk::thesis {
namespace {

constexpr Hertz kRate(1000.0);
constexpr dsp::SavitzkyGolay kSmoothing{6, 101};

/// A number, or that there is none.
ReproducedCell number_or_none(double value) {
  return std::isfinite(value) ? cell(value) : words("0/0");
}

/// (3.17) in degrees.
double printed_orientation(const Matrix& Z) {
  const double sum = Z(0, 0) + Z(1, 1);
  const double largest = 0.5 * (sum + std::sqrt(sum * sum + 4.0 * (Z(0, 1) * Z(0, 1) - Z(0, 0) * Z(1, 1))));
  return kDegrees * std::atan((largest - Z(0, 0)) / Z(0, 1));
}

}  // namespace

Result<void> orientation_of_an_ellipse(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {
      "mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk measure relaxed.h5 --json --out relaxed.json && mbk "
      "ellipse relaxed.json"};
  exhibit.related = {"table-3.3", "table-3.5"};
  ReproducedTable table =
      computed_table("erratum-6", "z_xx, z_yy, z_s", {{"(3.17), as printed", "°", 2}, {"½ atan2", "°", 2}});
  const auto add = [&](const std::string& name, const Matrix& Z) {
    table.rows.push_back(
        {name, {number_or_none(printed_orientation(Z)), cell(kDegrees * impedance::ellipse(Z).orientation)}});
  };
  add("P1's stiffness, table 3.3", model_of(arm_of(bench.given().sinusoidal, "P1")).K);
  add("100, 50, 0", Matrix{{100.0, 0.0}, {0.0, 50.0}});
  add("50, 100, 10⁻⁶", Matrix{{50.0, 1e-6}, {1e-6, 100.0}});
  add("100, 50, 10⁻⁶", Matrix{{100.0, 1e-6}, {1e-6, 50.0}});
  int ellipses = 0, negative = 0;
  double apart = 0.0;
  for (const auto* arms : {&bench.given().sinusoidal, &bench.given().underdamped}) {
    for (const PrintedArm& arm : *arms) {
      for (const PrintedEllipse& ellipse : arm.ellipses) {
        const Matrix Z = symmetric_matrix(ellipse);
        const double printed = printed_orientation(Z), right = kDegrees * impedance::ellipse(Z).orientation;
        ++ellipses;
        negative += printed < 0.0 ? 1 : 0;
        apart = std::max(apart, std::abs(std::remainder(right - printed, 180.0)));
      }
    }
  }
  ReproducedTable all = computed_table("erratum-6 all", "",
                                       {{"ellipses", "", 0}, {"(3.17) below 0°", "", 0}, {"apart, mod 180°", "°", 9}});
  all.rows.push_back(
      {"both tables", {cell(static_cast<double>(ellipses)), cell(static_cast<double>(negative)), cell(apart)}});
  exhibit.tables = {std::move(table), std::move(all)};
  return {};
}

namespace {

/// Where the gain of a filter against the ideal has fallen to 1/√2 [Hz], by bisection.
Result<double> minus_3_db(const dsp::SavitzkyGolay& filter, int derivative) {
  double low = 0.1, high = 100.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const auto gain = MBK_TRY(dsp::savitzky_golay_gain(filter, derivative, Hertz(middle), kRate));
    (gain > std::numbers::sqrt2 / 2.0 ? low : high) = middle;
  }
  return low;
}

Result<Chart> filter_chart(const dsp::SectionCascade& lowpass) {
  Chart chart;
  chart.x = {"frequency", "Hz"};
  chart.y = {"gain, of derivatives against the ideal one", ""};
  constexpr std::array<const char*, 3> kNames = {"smoothing", "first derivative", "second derivative"};
  for (int derivative = 0; derivative < 3; ++derivative) {
    ChartSeries series{kNames[static_cast<std::size_t>(derivative)], {}, {}, {}, ChartSeries::Drawn::line};
    for (int i = 1; i <= 100; ++i) {
      const Hertz frequency(0.1 * i);
      const auto gain = MBK_TRY(dsp::savitzky_golay_gain(kSmoothing, derivative, frequency, kRate));
      series.x.push_back(frequency.value);
      series.y.push_back(gain * std::pow(dsp::gain(lowpass, frequency, kRate), 2));
    }
    chart.series.push_back(std::move(series));
  }
  chart.vertical = {{5.0, "said to be near unity up to here"}};
  return chart;
}

}  // namespace

Result<void> smoothing_cutoff(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {
      "mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk measure relaxed.h5 --sg-order 6 "
      "--sg-window 101 --cutoff 5      # the filters are named in the output"};
  exhibit.related = {"figure-3.5", "statements"};
  ReproducedTable table = computed_table(
      "erratum-7", "N, W", {{"(3.6), as printed", "Hz", 2}, {"Schafer", "Hz", 2}, {"from the weights", "Hz", 2}});
  for (const dsp::SavitzkyGolay& filter : {kSmoothing, dsp::SavitzkyGolay{6, 151}, dsp::SavitzkyGolay{4, 51}}) {
    const auto cutoff = MBK_TRY(dsp::savitzky_golay_cutoff(filter, kRate));
    const double nyquist = 0.5 * kRate.value;
    table.rows.push_back(
        {fmt::format("{}, {}", filter.order, filter.window),
         {cell(nyquist * (filter.order + 1) / (1.6 * filter.window - 4.6)),
          cell(nyquist * (filter.order + 1) / (3.2 * filter.half_window() - 4.6)), cell(cutoff.value)}});
  }
  ReproducedTable derivatives = computed_table("erratum-7 derivatives", "derivative", {{"cutoff", "Hz", 1}});
  for (const int derivative : {1, 2}) {
    const auto cutoff = MBK_TRY(minus_3_db(kSmoothing, derivative));
    derivatives.rows.push_back({derivative == 1 ? "first" : "second", {cell(cutoff)}});
  }
  const double cutoff = bench.given().number("setup", "cutoff of chapter 3, Hz");
  const auto lowpass = MBK_TRY(dsp::butterworth_lowpass(5, Hertz(cutoff), kRate));
  ReproducedTable twice =
      computed_table("erratum-7 low-pass", "frequency", {{"gain, once", "", 3}, {"gain, forward and backward", "", 3}});
  for (const double frequency : {2.0, 3.0, 4.0, 5.0}) {
    const double gain = dsp::gain(lowpass, Hertz(frequency), kRate);
    twice.rows.push_back({fmt::format("{:g} Hz", frequency), {cell(gain), cell(gain * gain)}});
  }
  auto chart = MBK_TRY(filter_chart(lowpass));
  exhibit.tables = {std::move(table), std::move(derivatives), std::move(twice)};
  exhibit.charts = {std::move(chart)};
  return {};
}

Result<void> sign_of_the_errors(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {
      "mbk simulate rig_table_5_1 --trial K1_M1 --out rig.h5 && mbk measure rig_K1_M1.h5 --structure "
      "mass-spring --mode reference --procedure chapter5"};
  exhibit.related = {"table-5.3", "table-5.4"};
  ReproducedTable table = computed_table(
      "erratum-12", "statement", {{"theoretical + entry, as captioned", "", 0}, {"theoretical − entry", "", 0}});
  const auto count = [&](const std::vector<PrintedRig>& rigs, std::size_t elements, const auto& holds) {
    std::array<int, 3> counts{};
    for (const PrintedRig& rig : rigs) {
      for (std::size_t k = 0; k < elements; ++k) {
        const double truth = rig.theoretical[k].value, one = rig.error_method_1[k].value,
                     two = rig.error_method_2[k].value;
        counts[0] += holds(truth, truth + one, truth + two) ? 1 : 0;
        counts[1] += holds(truth, truth - one, truth - two) ? 1 : 0;
        ++counts[2];
      }
    }
    return counts;
  };
  const auto add = [&](const char* name, const std::array<int, 3>& counts) {
    table.rows.push_back(
        {name,
         {words(fmt::format("{} of {}", counts[0], counts[2])), words(fmt::format("{} of {}", counts[1], counts[2]))}});
  };
  const Given& given = bench.given();
  const auto higher = [](double, double one, double two) { return one > two; };
  const auto lower = [](double, double one, double two) { return one < two; };
  add("k_xx, k_yy overestimated by method 1",
      count(given.stiffnesses, 2, [](double truth, double one, double) { return one > truth; }));
  add("k_xx, k_yy of method 1 above method 2", count(given.stiffnesses, 2, higher));
  add("m underestimated by method 1",
      count(given.masses, 1, [](double truth, double one, double) { return one < truth; }));
  add("m of method 1 below method 2", count(given.masses, 1, lower));
  exhibit.tables = {std::move(table)};
  return {};
}

namespace {

/// P1's arm along a given motion, exactly; `at` gives place, velocity and acceleration of both axes.
template <typename At, typename Reference>
Recording exact_recording(const impedance::Model& model, Index samples, const At& at, const Reference& reference) {
  Recording recording;
  recording.time = Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1)) / kRate.value;
  Matrix values(samples, 6);
  for (Index i = 0; i < samples; ++i) {
    const auto jet = at(recording.time[i]);
    const Eigen::Vector2d force =
        -(model.M * jet.second + model.B * jet.first + model.K * (jet.value - Eigen::Vector2d(model.x0)));
    const Eigen::Vector2d requested = reference(recording.time[i]);
    values.row(i) << jet.value.transpose(), force.transpose(), requested.transpose();
  }
  const std::array<const char*, 6> names = {"hand_x", "hand_y", "force_x", "force_y", "reference_x", "reference_y"};
  for (Index k = 0; k < 6; ++k) {
    recording.channels.push_back(
        {names[static_cast<std::size_t>(k)], k == 2 || k == 3 ? "N" : "m", "base", values.col(k)});
  }
  return recording;
}

Result<Recording> sinusoidal_recording(const impedance::Model& model) {
  const std::vector<int> harmonics = {1, 4, 7, 10, 13, 16, 20, 23, 26, 29};
  const std::vector<double> amplitudes(harmonics.size(), 0.0015);
  const auto x = perturbation::Multisine::with_random_phases(10.0, harmonics, amplitudes, 1, 0);
  const auto y = perturbation::Multisine::with_random_phases(10.0, harmonics, amplitudes, 1, 1);
  if (!x) return tl::unexpected(x.error());
  if (!y) return tl::unexpected(y.error());
  const auto at = [&](double t) {
    const auto a = x->at(t), b = y->at(t);
    return perturbation::Jet<Eigen::Vector2d>{{a.value, b.value}, {a.first, b.first}, {a.second, b.second}};
  };
  return exact_recording(model, 62001, at, [&](double t) { return at(t).value; });
}

Result<Recording> pulse_recording(const impedance::Model& model) {
  const auto pulses = MBK_TRY(perturbation::PulseSchedule::create({}));
  const auto samples = static_cast<Index>((pulses.pulses().back().offset + 3.0) * kRate.value);
  return exact_recording(
      model, samples, [&](double t) { return pulses.at(t); }, [&](double t) { return pulses.reference(t); });
}

}  // namespace

Result<void> samples_of_the_program(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {
      "mbk simulate relaxed_underdamped --out pulses.h5 && mbk measure pulses.h5 --mode reference && "
      "mbk measure pulses.h5"};
  exhibit.related = {"table-3.2", "table-3.4", "statements"};
  impedance::Model model = model_of(arm_of(bench.given().sinusoidal, "P1"));
  const auto lasting = MBK_TRY(sinusoidal_recording(model));
  preprocess::Options reference;
  reference.mode = Mode::reference;
  reference.protocol = Protocol::sinusoidal;
  const auto trial = MBK_TRY(preprocess::prepare(lasting, recording::inspect(lasting), reference));
  // The program's window is samples 11999 to 61999, both of them in it.
  const Index window = 62000 - 11999, possible = window - 2 * kSmoothing.half_window();
  Index used = 0, validating = 0, first = trial.recording_duration > 0 ? 1000000 : 0;
  for (const Segment& segment : trial.segments) {
    used += segment.size();
    if (segment.purpose == Purpose::validation) validating += segment.size();
    first = std::min(first, segment.first_sample);
  }
  ReproducedTable centres =
      computed_table("erratum-13", "", {{"possible", "", 0}, {"used by the program", "", 0}, {"seconds", "s", 3}});
  centres.rows = {{"all",
                   {cell(static_cast<double>(possible)), cell(static_cast<double>(used)),
                    cell(static_cast<double>(used) / kRate.value)}},
                  {"first centre, as a sample of the log, from 0",
                   {cell(static_cast<double>(11999 + kSmoothing.half_window())), cell(static_cast<double>(first)),
                    cell(static_cast<double>(first) / kRate.value)}},
                  {"to validate",
                   {cell(static_cast<double>(possible - 40000)), cell(static_cast<double>(validating)),
                    cell(static_cast<double>(validating) / kRate.value)}}};
  const auto pulses = MBK_TRY(pulse_recording(model));
  ReproducedTable smear = computed_table(
      "erratum-13 pulses", "procedure",
      {{"m_yy", "kg", 5}, {"b_yy", "N·s/m", 4}, {"k_yy", "N/m", 4}, {"largest error of M, B, K", "", 6}});
  smear.rows.push_back({"the arm", {cell(model.M(1, 1)), cell(model.B(1, 1)), cell(model.K(1, 1)), cell(0.0)}});
  for (const auto& [name, mode] : {std::pair{"filtered, then cut (reference mode)", Mode::reference},
                                   {"cut, then filtered (default mode)", Mode::default_mode}}) {
    measurement::Options options;
    options.preprocess.mode = mode;
    options.passivity = false;
    options.identify.parameters_from = ParametersFrom::all;
    const auto measured = MBK_TRY(measurement::measure({&pulses, 1}, options));
    const impedance::Model& found = measured.identification.model;
    double largest = 0.0;
    for (const auto& [a, b] : {std::pair{&found.M, &model.M}, {&found.B, &model.B}, {&found.K, &model.K}}) {
      largest = std::max(largest, (*a - *b).cwiseAbs().maxCoeff() / b->cwiseAbs().maxCoeff());
    }
    smear.rows.push_back({name, {cell(found.M(1, 1)), cell(found.B(1, 1)), cell(found.K(1, 1)), cell(largest)}});
  }
  exhibit.tables = {std::move(centres), std::move(smear)};
  return {};
}

Result<void> offset_of_the_fit(Workbench& /*bench*/, Draft& exhibit) {
  exhibit.commands = {
      "mbk simulate relaxed_sinusoidal --out relaxed.h5 && mbk measure relaxed.h5      # VAF and RMSE of each axis"};
  exhibit.related = {"table-4.4", "table-5.5"};
  constexpr Index kSamples = 5000;
  Vector force(kSamples), shifted(kSamples);
  for (Index i = 0; i < kSamples; ++i) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(i) / kRate.value;
    force[i] = 2.0 * std::sin(phase);
    shifted[i] = 2.0 * std::sin(phase - 1.1);
  }
  ReproducedTable table = computed_table("erratum-14", "model", {{"VAF", "%", 1}, {"RMSE", "N", 3}});
  const auto add = [&](const char* name, const Vector& residual) {
    table.rows.push_back(
        {name, {cell(numeric::variance_accounted_for(force, residual)), cell(numeric::root_mean_square(residual))}});
  };
  add("off by 1 N", Vector::Constant(kSamples, 1.0));
  add("off by 10 N", Vector::Constant(kSamples, 10.0));
  add("0.9 of the force", 0.1 * force);
  add("63° late", force - shifted);
  exhibit.tables = {std::move(table)};
  return {};
}

}  // namespace mbk::thesis
