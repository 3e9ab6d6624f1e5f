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

/// How small and how large a number may be other than 0. Exact answers are worked out with whole numbers whose digits
/// multiply: a delay of 1e-30 s beside one of 5 ms takes a minute.
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
    rigid,      ///< the same arm that holds its place at will
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

/// What `--simulate` runs in time, where the design says so. Delays are those of the design.
struct SimulationPlan {
  double duration = 20.0;                      ///< [s]
  double sample_time = 1e-3;                   ///< of the controllers [s]
  double kick = 0.5;                           ///< impulse on the master that sets the motion off [N·s]
  double jitter = 0.0;                         ///< of each packet [s]
  double loss = 0.0;                           ///< share of the packets, 0 to 1
  bool zero_on_loss = false;                   ///< zeros where no packet came, instead of the last one
  std::uint64_t seed = 1;                      ///< of losses and of what arms do at random
  std::optional<double> passivity_controller;  ///< largest damping at the master [N·s/m]
  SimulatedArm therapist, patient;             ///< at the master and at the slave
};

/// What a design file says: docs/guide/teleoperation.md has every key.
struct Design {
  std::string file, name;
  std::variant<Teleoperator, TwoPort> network;
  std::optional<FrequencyGrid> exact_delay;  ///< delays as they are, on this grid; none: by Padé, exactly
  Port operator_port = Port::one;
  std::optional<Rational> shortage;  ///< a of the termination at that port [N·s/m]
  SimulationPlan simulation;

  [[nodiscard]] bool is_architecture() const { return std::holds_alternative<Teleoperator>(network); }

  /// @param parameter  of a teleoperator, to stay a variable; empty: none
  [[nodiscard]] PortEquations equations(std::string_view parameter = {}) const;
};

/// @fails  data, with file, line and key: what is malformed; of a two-port it names the entry.
[[nodiscard]] Result<Design> read_design(const std::filesystem::path& file);
[[nodiscard]] Result<Design> parse_design(std::string_view text, std::string_view file);

}  // namespace mbk::teleop
