#pragma once

#include <filesystem>
#include <optional>
#include <variant>

#include "mbk/base/config/document.h"
#include "mbk/experiment/drivers/fittings.h"
#include "mbk/experiment/drivers/plugin_device.h"
#include "mbk/experiment/drivers/udp_device.h"

namespace mbk::protocol {

/// A simulated robot (Trial::simulation).
struct Simulated {};

/// Which robot a trial runs on.
struct DevicePlan {
  std::variant<Simulated, drivers::UdpOptions, drivers::PluginOptions> kind;
  drivers::Fittings fittings;        ///< of a robot that is not simulated
  bool counts = false;               ///< the encoders are read in counts, not as angles
  std::optional<double> force_step;  ///< smallest step of a force reading, in its own unit; absent: not known

  [[nodiscard]] bool simulated() const { return std::holds_alternative<Simulated>(kind); }
};

/// The section [device] with its table [device.wiring]; docs/guide/own_robot.md lists the keys.
/// @param folder  from which a library's name is taken
[[nodiscard]] DevicePlan read_device(const config::Section& section, const std::filesystem::path& folder);

}  // namespace mbk::protocol
