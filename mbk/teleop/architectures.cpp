#include "mbk/teleop/architectures.h"

#include <algorithm>
#include <array>

#include "mbk/base/lti/on_axis.h"

namespace mbk::teleop {
namespace {

constexpr auto kParameters = std::to_array<Parameter>({
    {"master.m", "master", "mass_kg", "kg", "m_m, mass of the master"},
    {"master.b", "master", "damping_N_s_per_m", "N·s/m", "b_m, damping of the master"},
    {"master.d", "master", "controller_damping_N_s_per_m", "N·s/m", "d_m, damping of the master's controller"},
    {"master.k", "master", "controller_stiffness_N_per_m", "N/m", "k_m, stiffness of the master's controller"},
    {"master.local_force_gain", "master", "local_force_gain", "", "C6, gain of the hand force at the master"},
    {"slave.m", "slave", "mass_kg", "kg", "m_s, mass of the slave"},
    {"slave.b", "slave", "damping_N_s_per_m", "N·s/m", "b_s, damping of the slave"},
    {"slave.d", "slave", "controller_damping_N_s_per_m", "N·s/m", "d_s, damping of the slave's controller"},
    {"slave.k", "slave", "controller_stiffness_N_per_m", "N/m", "k_s, stiffness of the slave's controller"},
    {"slave.local_force_gain", "slave", "local_force_gain", "", "C5, gain of the environment force at the slave"},
    {"channels.force_to_master", "channels", "force_to_master", "", "C2 = k_f, gain of the environment force"},
    {"channels.force_to_slave", "channels", "force_to_slave", "", "C3, gain of the hand force"},
    {"channels.to_slave_m", "channels", "to_slave_mass_kg", "kg", "mass in C1"},
    {"channels.to_slave_d", "channels", "to_slave_damping_N_s_per_m", "N·s/m", "damping in C1"},
    {"channels.to_slave_k", "channels", "to_slave_stiffness_N_per_m", "N/m", "stiffness in C1"},
    {"channels.to_master_m", "channels", "to_master_mass_kg", "kg", "mass in −C4"},
    {"channels.to_master_d", "channels", "to_master_damping_N_s_per_m", "N·s/m", "damping in −C4"},
    {"channels.to_master_k", "channels", "to_master_stiffness_N_per_m", "N/m", "stiffness in −C4"},
    {"delay.to_slave", "delay", "to_slave_ms", "s", "T1, delay from master to slave"},
    {"delay.to_master", "delay", "to_master_ms", "s", "T2, delay from slave to master"},
});

/// Which entries of [V₁ V₂ I₁ I₂] have crossed the channel, in the equation of the master and of the slave.
constexpr std::array<std::array<bool, 4>, 2> kSent = {{{false, true, false, true}, {true, false, true, false}}};
constexpr std::array<std::string_view, 2> kDelays = {"delay.to_master", "delay.to_slave"};

/// Q(x) of the Padé approximation, ascending.
std::vector<Rational> pade(int order) {
  std::vector<Rational> coefficients = {1};
  for (int j = 0; j < order; ++j) {
    coefficients.push_back(coefficients.back() * Rational(order - j, (2 * order - j) * (j + 1)));
  }
  return coefficients;
}

/// Q(±sT) with T a polynomial of the parameter.
ParametricPolynomial pade_polynomial(int order, const Polynomial& T, int sign) {
  std::vector<Polynomial> coefficients;
  Polynomial power{1};
  for (const Rational& c : pade(order)) {
    coefficients.push_back(power * Polynomial{c});
    power = power * T * Polynomial{sign};
  }
  return ParametricPolynomial(std::move(coefficients));
}

}  // namespace

std::vector<std::string> matrix_lines(Architecture architecture) {
  const std::string impedances = "Zm = m_m s + b_m, Cm = d_m + k_m/s, Zs = m_s s + b_s, Cs = d_s + k_s/s";
  switch (architecture) {
    case Architecture::position_force:
      return {"h = [[Zm + Cm, -D2 k_f], [D1 Cs/(Zs + Cs), 1/(Zs + Cs)]]", impedances};
    case Architecture::three_channel:
      return {"z = [[1 + C6, D2 k_f], [0, 1 + C5]]^-1 [[Zm + Cm, -D2 Cm], [-D1 Cs, Zs + Cs]]", impedances};
    case Architecture::four_channel:
      return {"z = [[1 + C6, D2 C2], [D1 C3, 1 + C5]]^-1 [[Zm + Cm, D2 C4], [-D1 C1, Zs + Cs]]", impedances};
    case Architecture::position_position:
      break;
  }
  return {"z = [[Zm + Cm, -D2 Cm], [-D1 Cs, Zs + Cs]]", impedances};
}

std::span<const Parameter> all_parameters() {
  return kParameters;
}

Need need(Architecture architecture, std::string_view parameter) {
  using enum Architecture;
  if (parameter.starts_with("delay.")) return Need::optional;
  if (parameter.ends_with(".local_force_gain")) {
    return architecture == three_channel || architecture == four_channel ? Need::optional : Need::none;
  }
  if (parameter == "channels.force_to_master") {
    return architecture == position_position ? Need::none : Need::required;
  }
  if (parameter == "channels.force_to_slave") return architecture == four_channel ? Need::required : Need::none;
  if (parameter.starts_with("channels.")) return architecture == four_channel ? Need::optional : Need::none;
  const bool controller_of_master = parameter == "master.d" || parameter == "master.k";
  return controller_of_master && architecture == position_force ? Need::optional : Need::required;
}

bool Teleoperator::has_delay() const {
  return std::ranges::any_of(kDelays, [&](std::string_view name) {
    const auto found = values.find(name);
    return found != values.end() && !found->second.is_zero();
  });
}

PortEquations Teleoperator::without_delay(std::string_view parameter) const {
  const auto given = [&](std::string_view name) { return name == parameter || values.contains(name); };
  const auto value = [&](std::string_view name) {
    if (name == parameter) return Polynomial{0, 1};
    const auto found = values.find(name);
    return found == values.end() ? Polynomial() : Polynomial{found->second};
  };
  // all times s: (m s + d + k/s) s = k + d s + m s²
  const auto impedance = [](const Polynomial& k, const Polynomial& d, const Polynomial& m) {
    return ParametricPolynomial({k, d, m});
  };
  const auto gain = [](const Polynomial& g) { return ParametricPolynomial({Polynomial(), g}); };
  const auto channel = [&](const char* m, const char* d, const char* k, const ParametricPolynomial& otherwise) {
    return given(m) || given(d) || given(k) ? impedance(value(k), value(d), value(m)) : otherwise;
  };
  const ParametricPolynomial Cm = impedance(value("master.k"), value("master.d"), {});
  const ParametricPolynomial Cs = impedance(value("slave.k"), value("slave.d"), {});
  const ParametricPolynomial Zm = impedance({}, value("master.b"), value("master.m"));
  const ParametricPolynomial Zs = impedance({}, value("slave.b"), value("slave.m"));
  const ParametricPolynomial C1 = channel("channels.to_slave_m", "channels.to_slave_d", "channels.to_slave_k", Cs);
  const ParametricPolynomial minus_C4 =
      architecture == Architecture::position_force
          ? ParametricPolynomial()
          : channel("channels.to_master_m", "channels.to_master_d", "channels.to_master_k", Cm);
  const Polynomial one{1};
  const ParametricPolynomial zero;
  return {
      {{{gain(one + value("master.local_force_gain")), gain(value("channels.force_to_master")), zero - Zm - Cm,
         minus_C4},
        {gain(value("channels.force_to_slave")), gain(one + value("slave.local_force_gain")), C1, zero - Zs - Cs}}}};
}

PortEquations Teleoperator::equations(std::string_view parameter) const {
  PortEquations result = without_delay(parameter);
  for (const std::size_t i : {0, 1}) {
    const auto found = values.find(kDelays[i]);
    Polynomial T;
    if (kDelays[i] == parameter) {
      T = Polynomial{0, 1};
    } else if (found != values.end()) {
      T = Polynomial{found->second};
    }
    if (T.is_zero()) continue;
    const ParametricPolynomial late = pade_polynomial(pade_order, T, -1), early = pade_polynomial(pade_order, T, 1);
    for (std::size_t j = 0; j < 4; ++j) result.rows[i][j] = result.rows[i][j] * (kSent[i][j] ? late : early);
  }
  return result;
}

Eigen::Matrix<std::complex<double>, 2, 4> Teleoperator::with_exact_delay(RadPerSec frequency,
                                                                         double sample_time) const {
  const PortEquations at_once = without_delay();
  Teleoperator robots;  // without controllers
  for (const char* name : {"master.m", "master.b", "slave.m", "slave.b"}) {
    if (const auto found = values.find(name); found != values.end()) robots.values.insert(*found);
  }
  const PortEquations alone = robots.without_delay();
  const std::complex<double> s(0.0, frequency.value);
  const std::complex<double> hold =
      sample_time > 0.0 ? (1.0 - std::exp(-s * sample_time)) / (s * sample_time) : std::complex<double>(1.0);
  Eigen::Matrix<std::complex<double>, 2, 4> result;
  for (const std::size_t i : {0, 1}) {
    const auto found = values.find(kDelays[i]);
    const double T = found == values.end() ? 0.0 : lti::to_double(found->second);
    for (std::size_t j = 0; j < 4; ++j) {
      const std::complex<double> own = lti::evaluate(alone.rows[i][j].at(0), s);
      const std::complex<double> commanded = lti::evaluate(at_once.rows[i][j].at(0), s) - own;
      result(static_cast<Index>(i), static_cast<Index>(j)) =
          own + hold * (kSent[i][j] ? commanded * std::exp(-s * T) : commanded);
    }
  }
  return result;
}

}  // namespace mbk::teleop
