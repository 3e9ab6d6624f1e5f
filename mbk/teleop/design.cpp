#include "mbk/teleop/design.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "mbk/base/config/document.h"

namespace mbk::teleop {
namespace {

using config::Document;
using config::Section;

/// A value of the file as a fraction, for a quantity in SI units; 0 in place of one that is refused.
Rational fraction(const Section& section, std::string_view key, double value, Sizes sizes = {}) {
  auto exact = bounded(value, sizes);
  if (exact) return std::move(*exact);
  section.reject(key, exact.error().message, exact.error().remedy);
  return 0;
}

/// [s]
constexpr Sizes kDelaySizes{1e-6, 1e6, "s"};
/// Of two-ports, whose coefficients are products of up to twelve time constants.
constexpr Sizes kCoefficients{1e-40, 1e40, "in SI units"};

config::Range allowed(std::string_view key) {
  const bool never_negative = key.ends_with("_kg") || key.ends_with("_ms");
  return never_negative ? config::at_least(0.0) : config::any();
}

Teleoperator read_teleoperator(const Document& document) {
  Teleoperator result;
  result.architecture = document.root().section("architecture").required_choice<Architecture>("kind");
  for (const Parameter& parameter : all_parameters()) {
    const Need needed = need(result.architecture, parameter.name);
    if (needed == Need::none) continue;
    const Section section = document.root().section(parameter.section);
    const auto value = needed == Need::required
                           ? std::optional(section.required_number(parameter.key, allowed(parameter.key)))
                           : section.optional_number(parameter.key, allowed(parameter.key));
    const Sizes sizes = parameter.section == "delay" ? kDelaySizes : Sizes{};
    if (value) result.values.emplace(parameter.name, fraction(section, parameter.key, *value, sizes));
  }
  return result;
}

/// "numerator" or "denominator" of an entry: coefficients, that of the highest power of s first.
Polynomial read_polynomial(const Section& entry, std::string_view key, std::vector<double> fallback) {
  constexpr std::size_t kMax = 13;  // degree 12: two-ports beyond that take minutes
  std::vector<double> coefficients = entry.numbers(key, std::move(fallback));
  if (coefficients.empty()) {
    entry.reject(key, "has no coefficients", "list them, highest power of s first: [1, 0.5] is s + 0.5");
  }
  if (coefficients.size() > kMax) {
    entry.reject(key, fmt::format("has {} coefficients, more than {}", coefficients.size(), kMax),
                 "reduce the order of the model");
    coefficients.clear();
  }
  std::vector<Rational> ascending;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c)
    ascending.push_back(fraction(entry, key, *c, kCoefficients));
  return Polynomial(std::move(ascending));
}

TwoPort read_two_port(const Section& section) {
  TwoPort result;
  result.form = section.required_choice<Form>("form");
  for (const Index i : {0, 1}) {
    for (const Index j : {0, 1}) {
      const std::string name = fmt::format("{}{}{}", word_of(result.form), i + 1, j + 1);
      const Section entry = section.section(name);
      if (!section.has(name)) {
        section.reject(name, "this entry is missing",
                       fmt::format("write {} = {{numerator = [1], denominator = [1, 0]}}", name));
        continue;
      }
      const Polynomial numerator = read_polynomial(entry, "numerator", {});
      const Polynomial denominator = read_polynomial(entry, "denominator", {1.0});
      auto function = lti::RationalFunction::of(numerator, denominator);
      if (function) {
        result.matrix(i, j) = std::move(*function);
      } else {
        entry.reject("denominator", "is zero", "make at least one coefficient non-zero");
      }
    }
  }
  return result;
}

/// The grid, if the file gives one.
std::optional<FrequencyGrid> read_delay(const Section& section, Teleoperator& teleoperator, bool& pade) {
  constexpr int kHighestOrder = 4, kMin = 10, kMax = 1'000'000;
  pade = section.has("pade");
  const bool exact = section.flag("exact", !pade);
  if (pade && exact) section.reject("exact", "there is also pade", "keep one of the two");
  pade = !exact;
  if (pade) {
    teleoperator.pade_order = section.integer("pade", teleoperator.pade_order, 1, kHighestOrder);
    return std::nullopt;
  }
  const auto given = [&](const char* key) { return section.has(key); };
  if (!given("grid_from_rad_per_s") && !given("grid_to_rad_per_s") && !given("grid_points")) return std::nullopt;
  FrequencyGrid grid;
  grid.low = RadPerSec(section.required_number("grid_from_rad_per_s", config::above(0.0)));
  grid.high = RadPerSec(section.required_number("grid_to_rad_per_s", config::above(0.0)));
  grid.points = section.required_integer<int>("grid_points", kMin, kMax);
  if (!(grid.low < grid.high)) section.reject("grid_to_rad_per_s", "is not above grid_from_rad_per_s");
  return grid;
}

SimulatedArm read_arm(const Section& section) {
  SimulatedArm arm;
  arm.kind = section.choice("kind", arm.kind);
  if (arm.kind == SimulatedArm::Kind::impedance) {
    arm.impedance.mass = section.number("mass_kg", 0.0, config::at_least(0.0));
    arm.impedance.damping = section.number("damping_N_s_per_m", 0.0);
    arm.impedance.stiffness = section.number("stiffness_N_per_m", 0.0, config::at_least(0.0));
    return arm;
  }
  constexpr int kParticipants = 6;
  arm.participant = section.integer("participant", arm.participant, 1, kParticipants);
  arm.direction = section.number("direction_deg", arm.direction);
  return arm;
}

SimulationPlan read_simulation(const Section& section) {
  SimulationPlan plan;
  constexpr double kShortest = 0.1, kLongest = 3600.0, kSlowest = 50.0, kFastest = 20'000.0;
  constexpr double kLongestJitter = 10'000.0, kAll = 100.0;  // ms, %
  plan.duration = section.number("duration_s", plan.duration, config::between(kShortest, kLongest));
  plan.sample_time = 1.0 / section.number("rate_hz", 1.0 / plan.sample_time, config::between(kSlowest, kFastest));
  plan.kick = section.number("kick_Ns", plan.kick);
  plan.jitter = section.number("jitter_ms", plan.jitter, config::between(0.0, kLongestJitter));
  plan.loss = section.number("loss_percent", plan.loss, config::between(0.0, kAll));
  plan.zero_on_loss = section.choice("on_loss", {{"hold", false}, {"zero", true}}, plan.zero_on_loss);
  plan.seed = section.integer<std::uint64_t>("seed", plan.seed, 0, std::numeric_limits<std::int64_t>::max());
  plan.passivity_controller = section.optional_number("passivity_controller_N_s_per_m", config::above(0.0));
  plan.therapist = read_arm(section.section("therapist"));
  plan.patient = read_arm(section.section("patient"));
  return plan;
}

Result<Design> design_of(const Document& document, std::string_view file) {
  const Section root = document.root();
  Design design;
  design.file = file;
  design.name = root.text("name", "");
  const Section two_port = root.section("two_port");
  if (two_port.given() && root.section("architecture").given()) {
    return tl::unexpected(two_port.error("form", "there is also an [architecture]", "keep one of the two"));
  }
  if (!two_port.given() && !root.section("architecture").given()) {
    return tl::unexpected(root.error("", "[architecture] is missing, and there is no [two_port] either",
                                     "write [architecture] with kind = \"position-position\""));
  }
  if (two_port.given()) {
    design.network = read_two_port(two_port);
  } else {
    Teleoperator teleoperator = read_teleoperator(document);
    design.exact_delay = read_delay(root.section("delay"), teleoperator, design.pade);
    design.network = std::move(teleoperator);
  }
  const Section terminated = root.section("operator");
  design.operator_port = terminated.integer("port", 1, 1, 2) == 1 ? Port::one : Port::two;
  if (const auto a = terminated.optional_number("shortage_N_s_per_m")) {
    design.shortage = fraction(terminated, "shortage_N_s_per_m", *a);
  }
  if (design.is_architecture()) design.simulation = read_simulation(root.section("simulation"));
  MBK_TRY(document.finish());
  return design;
}

}  // namespace

Result<Rational> bounded(double value, Sizes sizes) {
  const double size = std::abs(value);
  if (value == 0.0 || (size >= sizes.smallest && size <= sizes.largest)) return lti::exact(value);
  return bad_usage(fmt::format("{:g} is {} {:g} {}", value, size < sizes.smallest ? "closer to zero than" : "beyond",
                               size < sizes.smallest ? sizes.smallest : sizes.largest, sizes.unit),
                   size < sizes.smallest ? "write 0 if there is none" : "check its unit");
}

bool Design::has_true_delay() const {
  return is_architecture() && !pade && (exact_delay || std::get<Teleoperator>(network).has_delay());
}

PortEquations Design::equations(std::string_view parameter) const {
  if (const auto* two_port = std::get_if<TwoPort>(&network)) return PortEquations::of(*two_port);
  return std::get<Teleoperator>(network).equations(parameter);
}

Result<Design> parse_design(std::string_view text, std::string_view file) {
  const auto document = Document::parse(text, file);
  return document ? design_of(*document, file) : tl::unexpected(document.error());
}

Result<Design> read_design(const std::filesystem::path& file) {
  const auto document = Document::read(file);
  return document ? design_of(*document, file.string()) : tl::unexpected(document.error());
}

}  // namespace mbk::teleop
