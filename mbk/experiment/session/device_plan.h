#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <variant>

#include "mbk/base/core/result.h"
#include "mbk/experiment/drivers/fittings.h"
#include "mbk/experiment/drivers/plugin_device.h"
#include "mbk/experiment/drivers/udp_device.h"
#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::session {

/// The robot of the scenario itself, with whoever it describes at the handle.
struct Simulated {};

/// Which robot a trial runs on.
struct DevicePlan {
  std::variant<Simulated, drivers::UdpOptions, drivers::PluginOptions> kind;
  drivers::Fittings fittings;        ///< of a robot that is not simulated
  bool counts = false;               ///< the encoders are read in counts, not as angles
  std::optional<double> force_step;  ///< smallest step of a force reading, in its own unit; absent: not known

  [[nodiscard]] bool simulated() const { return std::holds_alternative<Simulated>(kind); }
};

/// The section [device] with its table [device.wiring]; docs/guide/devices.md lists the keys.
/// @param folder  from which a library's name is taken
[[nodiscard]] DevicePlan read_device(const config::Section& section, const std::filesystem::path& folder);

/// @fails  as SimulatedDevice, UdpDevice::create, PluginDevice::create
[[nodiscard]] Result<std::unique_ptr<device::Device>> make_device(const DevicePlan& plan,
                                                                  const laboratory::Scenario& scenario);

}  // namespace mbk::session
