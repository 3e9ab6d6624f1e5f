#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/teleoperation.h"
#include "mbk/teleop/architectures.h"

namespace mbk::teleop {

/// Smallest and largest magnitude of a non-zero number. Exact results use integers whose number of digits multiplies: a
/// delay of 1e-30 s together with one of 5 ms takes a minute.
struct Sizes {
  double smallest = 1e-9, largest = 1e12;
  const char* unit = "in SI units";
};

/// The decimal that reads back as `value`, exactly.
/// @fails  usage: it is not 0 and not of that size; it is not finite.
[[nodiscard]] Result<Rational> bounded(double value, Sizes sizes = {});

/// An arm that holds a port in a simulation.
struct SimulatedArm {
  enum class Kind {
    relaxed,    ///< of one of the six participants of Dyck (2013), table 3.3
    rigid,      ///< the same arm with voluntary position control
    impedance,  ///< a mass, a damper and a spring
  };
  Kind kind = Kind::relaxed;
  int participant = 1;                    ///< 1 to 6, of a relaxed or rigid arm
  double direction = 1.5707963267948966;  ///< of the line on which it moves, from +x [rad]
  Termination impedance;
};

[[nodiscard]] constexpr auto word_table(SimulatedArm::Kind) {
  using enum SimulatedArm::Kind;
  return std::to_array<Word<SimulatedArm::Kind>>({{relaxed, "relaxed"}, {rigid, "rigid"}, {impedance, "impedance"}});
}

/// Time-domain simulation of `--simulate`. Delays are those of the design.
struct SimulationPlan {
  double duration = 20.0;                      ///< [s]
  double sample_time = 1e-3;                   ///< of the controllers [s]
  double kick = 0.5;                           ///< impulse on the master that starts the motion [N·s]
  double jitter = 0.0;                         ///< of each packet [s]
  double loss = 0.0;                           ///< share of the packets, 0 to 1
  bool zero_on_loss = false;                   ///< use zeros without a packet, instead of the last one
  std::uint64_t seed = 1;                      ///< random seed of losses and arms
  std::optional<double> passivity_controller;  ///< largest damping at the master [N·s/m]
  SimulatedArm therapist, patient;             ///< at the master and at the slave
};

/// Contents of a design file: docs/guide/teleoperation.md lists every key.
struct Design {
  std::string file, name;
  std::variant<Teleoperator, TwoPort> network;
  bool pade = false;                         ///< delays are Padé approximations, by the file's choice
  std::optional<FrequencyGrid> exact_delay;  ///< true delays, on this grid only
  Port operator_port = Port::one;
  std::optional<Rational> shortage;  ///< a of the termination at that port [N·s/m]
  SimulationPlan simulation;

  [[nodiscard]] bool is_architecture() const { return std::holds_alternative<Teleoperator>(network); }
  /// Whether true delays are evaluated at frequencies; otherwise the network is rational and decided exactly.
  [[nodiscard]] bool has_true_delay() const;

  /// @param parameter  of a teleoperator, to remain a variable; empty: none
  [[nodiscard]] PortEquations equations(std::string_view parameter = {}) const;
};

/// @fails  data, with file, line and key: the malformed part; for a two-port the entry.
[[nodiscard]] Result<Design> read_design(const std::filesystem::path& file);
[[nodiscard]] Result<Design> parse_design(std::string_view text, std::string_view file);

}  // namespace mbk::teleop
