#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/experiment/device/device.h"
#include "mbk/experiment/drivers/device_plugin.h"
#include "mbk/experiment/drivers/fittings.h"

namespace mbk::drivers {

struct PluginOptions {
  std::filesystem::path library;  ///< a shared library that exports mbk_device_plugin_get
  std::string settings;           ///< handed to its open(): a port, a serial number
  double watchdog = 0.05;         ///< handed to its open() [s] > 0
};

/// A robot whose driver is a shared library with the C interface of device_plugin.h.
class PluginDevice : public device::Device {
 public:
  /// Loads the library; the robot is not touched. Which sensors there are the library knows.
  /// @fails  usage: watchdog. data: the library cannot be loaded; it does not export mbk_device_plugin_get; it is of
  ///         another version; a function is missing, which the message names; it and `fittings` disagree on the
  ///         sensors.
  [[nodiscard]] static Result<std::unique_ptr<PluginDevice>> create(const PluginOptions& options,
                                                                    const Fittings& fittings);
  PluginDevice(const PluginDevice&) = delete;
  PluginDevice& operator=(const PluginDevice&) = delete;
  ~PluginDevice() override;

  [[nodiscard]] const device::Facts& facts() const override { return facts_; }

  /// @fails  data: what its open() says; no sample comes.
  [[nodiscard]] Result<void> start() override;
  bool read(device::State& state) noexcept override;
  bool write(const device::Command& command) noexcept override;
  void stop() noexcept override;

 private:
  struct CloseLibrary {
    void operator()(void* library) const;
  };
  using Library = std::unique_ptr<void, CloseLibrary>;

  PluginDevice(PluginOptions options, const Fittings& fittings, Library library, const mbk_device_plugin& plugin);
  void close() noexcept;
  bool read_report(device::State& state) noexcept;

  PluginOptions options_;
  Fittings fittings_;
  Library library_;
  const mbk_device_plugin* plugin_;
  device::Facts facts_;
  void* device_ = nullptr;
  bool open_ = false;
  std::uint64_t written_ = 0;  // commands since open
  mbk_device_state newest_{};
};

}  // namespace mbk::drivers
