#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "mbk/core/result.h"
#include "mbk/teleop/architectures.h"
#include "mbk/trial/teleoperation.h"

namespace mbk::teleop {

/// What a design file says: docs/guide/teleoperation.md has every key.
struct Design {
  std::string file, name;
  std::variant<Teleoperator, TwoPort> network;
  std::optional<FrequencyGrid> exact_delay;  ///< delays as they are, on this grid; none: by Padé, exactly
  Port operator_port = Port::one;
  std::optional<Rational> shortage;  ///< a of the termination at that port [N·s/m]

  /// @param parameter  of a teleoperator, to stay a variable; empty: none
  [[nodiscard]] PortEquations equations(std::string_view parameter = {}) const;
};

/// @fails  data, with file, line and key: what is malformed; of a two-port it names the entry.
[[nodiscard]] Result<Design> read_design(const std::filesystem::path& file);
[[nodiscard]] Result<Design> parse_design(std::string_view text, std::string_view file);

}  // namespace mbk::teleop
