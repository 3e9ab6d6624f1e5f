#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "mbk/present/report/exploration_parts_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

const char* name_of(FrequencyResponseMethod method) {
  switch (method) {
    case FrequencyResponseMethod::welch:
      return "averaged spectra (Welch), Hann windows";
    case FrequencyResponseMethod::robust:
      return "robust, from periods and realisations";
    case FrequencyResponseMethod::fast:
      return "fast, from periods of one realisation";
    case FrequencyResponseMethod::local_polynomial:
      return "local polynomials of order 2";
  }
  return "";
}

std::string distortion_text(const Distortion& distortion) {
  const std::string trace =
      distortion.trace() ? fmt::format(", with a trace above the {:.2g} due to input noise", distortion.residual_noise)
                         : "";
  return fmt::format(
      "{}: {:.2g} of the output at {} empty lines, noise {:.2g} (p = {:.2g}){}{}",
      distortion.detected() ? "detected" : "not above the noise", distortion.relative, distortion.lines,
      distortion.noise, distortion.p, trace,
      distortion.uncorrected > 1.2 * distortion.relative
          ? fmt::format("; {:.2g} before subtracting the contribution of the input", distortion.uncorrected)
          : "");
}

/// Noise and distortion from periods and realisations.
std::vector<std::vector<std::string>> periodic_rows(const FrequencyResponseEstimate& found) {
  const PeriodicFacts& facts = *found.periodic;
  std::vector<std::vector<std::string>> rows;
  if (facts.dropped_periods > 0) {
    rows.push_back(
        {"transients", fmt::format("the first period of {} realisation{} differs from the others and was omitted",
                                   facts.dropped_periods, facts.dropped_periods == 1 ? "" : "s")});
  }
  if (facts.skipped_lines > 0) {
    const auto lines = [](Index count) { return fmt::format("{} line{}", count, count == 1 ? "" : "s"); };
    const Index singular = facts.skipped_lines - facts.weak_lines;
    std::string text;
    if (singular > 0) text = lines(singular) + " at which the inputs are not excited in all directions";
    if (facts.weak_lines > 0) {
      text += (text.empty() ? "" : ", ") + lines(facts.weak_lines) + " with too little of the perturbation's power";
    }
    rows.push_back({"skipped", text});
  }
  if (facts.total_over_noise) {
    rows.push_back({"nonlinear", fmt::format("variance over realisations is {:.3g} times that of noise (p = {:.2g}): "
                                             "{}",
                                             *facts.total_over_noise, facts.total_over_noise_p,
                                             facts.total_over_noise_p < 0.01 ? "nonlinear distortion"
                                                                             : "no nonlinear distortion detected")});
  } else {
    rows.push_back({"nonlinear", "not known: too few realisations with different phases"});
  }
  if (facts.even) rows.push_back({"even", distortion_text(*facts.even)});
  if (facts.odd_lines) rows.push_back({"odd", distortion_text(*facts.odd_lines)});
  if (!facts.odd) {
    rows.push_back(
        {"even, odd", "not known: the perturbation also excites even lines, so no line shows even distortion alone"});
  } else if (!facts.odd_lines) {
    rows.push_back(
        {"odd", "not known: the perturbation leaves fewer than three odd lines empty between the excited ones"});
  }
  return rows;
}

/// At most `most` lines, evenly spaced on a logarithmic scale.
std::vector<Index> shown_lines(const Vector& frequency, Index most) {
  std::vector<Index> lines;
  const Index n = frequency.size();
  const double first = std::log(frequency[0]), last = std::log(frequency[n - 1]);
  Index line = 0;
  for (Index k = 0; k < most; ++k) {
    const double at =
        first + (last - first) * static_cast<double>(k) / static_cast<double>(std::max<Index>(1, most - 1));
    while (line + 1 < n && std::log(frequency[line]) < at - 1e-9) ++line;
    if (lines.empty() || lines.back() != line) lines.push_back(line);
  }
  return lines;
}

std::string unit_of(const SignalLabel& output, const SignalLabel& input) {
  if (output.unit.empty() || input.unit.empty()) return "";
  return fmt::format(" [{}/{}]", output.unit == "N.m" ? "N·m" : output.unit, input.unit);
}

}  // namespace

std::string frequency_response_text(const FrequencyResponseEstimate& found) {
  std::string text = "frequency response\n";
  std::vector<std::vector<std::string>> facts = {{"method", name_of(found.method)}};
  if (!found.method_rule.empty()) facts.back().back() += ": " + found.method_rule;
  if (found.method == FrequencyResponseMethod::welch) {
    facts.push_back({"averages", fmt::format("{:.3g} independent segments", found.averages)});
  }
  facts.push_back({"loop", found.by_reference ? "projected on the reference: valid in closed loop"
                                              : "no reference: biased if the force moves the robot"});
  facts.push_back({"intervals", "95 %, for " + found.assumes});
  if (found.periodic) {
    for (auto& row : periodic_rows(found)) facts.push_back(std::move(row));
  }
  text += table(facts);
  for (std::size_t j = 0; j < found.inputs.size(); ++j) {
    for (std::size_t i = 0; i < found.outputs.size(); ++i) {
      const auto entry = static_cast<Index>(j * found.outputs.size() + i);
      text += fmt::format("\n  {} → {}\n", found.inputs[j].name, found.outputs[i].name);
      const bool of_limb = found.outputs[i].name.starts_with("−force") || found.outputs[i].name == "−reaction";
      const bool partial = found.inputs.size() > 1 && found.partial_coherence.size() > 0;
      std::vector<std::vector<std::string>> rows = {
          {"Hz", fmt::format("{}{}", of_limb ? "|D|" : "|G|", unit_of(found.outputs[i], found.inputs[j])), "95 %",
           "phase [°]"}};
      if (found.multiple_coherence.size() > 0) rows.back().emplace_back("γ²");
      if (partial) rows.back().emplace_back("partial");
      for (const Index k : shown_lines(found.frequency, 16)) {
        const std::complex<double> G =
            found.response[static_cast<std::size_t>(k)](static_cast<Index>(i), static_cast<Index>(j));
        rows.push_back({fmt::format("{:.4g}", found.frequency[k]), fmt::format("{:.4g}", std::abs(G)),
                        fmt::format("{:.4g} to {:.4g}", found.magnitude_low(k, entry), found.magnitude_high(k, entry)),
                        fmt::format("{:.1f}", kDegrees * std::arg(G))});
        if (found.multiple_coherence.size() > 0) {
          rows.back().push_back(fmt::format("{:.4f}", found.multiple_coherence(k, static_cast<Index>(i))));
        }
        if (partial) rows.back().push_back(fmt::format("{:.4f}", found.partial_coherence(k, entry)));
      }
      text += table(rows);
      const Index unknown = (found.magnitude_low.col(entry).array() <= 0.0).count();
      if (unknown > 0) {
        text += paragraph(
            "  ", fmt::format("(at {} of {} frequencies the interval reaches 0: the response there is not significant)",
                              unknown, found.size()));
      }
    }
  }
  return text;
}

}  // namespace mbk::report
