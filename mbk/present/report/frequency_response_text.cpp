#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "mbk/present/report/exploration_parts_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

const char* name_of(FrequencyResponseMethod method) {
  switch (method) {
    case FrequencyResponseMethod::welch:
      return "averaged spectra (Welch), Hann windows";
  }
  return "";
}

/// At most that many lines, evenly spaced on a logarithmic scale.
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
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  std::string text = "frequency response\n";
  std::vector<std::vector<std::string>> facts = {{"method", name_of(found.method)}};
  if (!found.method_rule.empty()) facts.back().back() += ": " + found.method_rule;
  facts.push_back({"averages", fmt::format("{:.3g} independent ones", found.averages)});
  facts.push_back({"loop", found.by_reference ? "projected on the reference: holds in closed loop"
                                              : "no reference: biased where the force moves the robot"});
  facts.push_back({"intervals", "95 %, for " + found.assumes});
  text += table(facts);
  for (std::size_t j = 0; j < found.inputs.size(); ++j) {
    for (std::size_t i = 0; i < found.outputs.size(); ++i) {
      const auto entry = static_cast<Index>(j * found.outputs.size() + i);
      text += fmt::format("\n  {} → {}\n", found.inputs[j].name, found.outputs[i].name);
      const bool partial = found.inputs.size() > 1 && found.partial_coherence.size() > 0;
      std::vector<std::vector<std::string>> rows = {
          {"Hz", fmt::format("|D|{}", unit_of(found.outputs[i], found.inputs[j])), "95 %", "phase [°]"}};
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
    }
  }
  return text;
}

}  // namespace mbk::report
