#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <ctime>

#include "mbk/base/core/option_limits.h"
#include "mbk/base/core/printable.h"
#include "mbk/experiment/drivers/plugin_device.h"

namespace mbk::drivers {
namespace {

constexpr const char* kEntry = "mbk_device_plugin_get";
constexpr int kFirstSampleWithin = 2000;  // [ms]

/// Names of the functions that are not there.
std::string missing(const mbk_device_plugin& plugin) {
  std::string names;
  const auto need = [&](const char* name, bool there) {
    if (!there) names += (names.empty() ? "" : ", ") + std::string(name);
  };
  need("open", plugin.open != nullptr);
  need("read", plugin.read != nullptr);
  need("write", plugin.write != nullptr);
  need("close", plugin.close != nullptr);
  return names;
}

/// Of the struct in a version of the interface [bytes].
std::size_t size_of(std::uint32_t version) {
  return version < 2 ? offsetof(mbk_device_plugin, report) : sizeof(mbk_device_plugin);
}

Result<void> check(const mbk_device_plugin* plugin, const Fittings& fittings) {
  if (plugin == nullptr)
    return bad_data(fmt::format("{} returns a null pointer", kEntry), "return the address of your struct");
  if (plugin->version < 1 || plugin->version > MBK_DEVICE_PLUGIN_VERSION) {
    return bad_data(fmt::format("it was compiled for version {} of the interface, but this mbk has version {}",
                                plugin->version, MBK_DEVICE_PLUGIN_VERSION),
                    "compile it again with this mbk's mbk/experiment/drivers/device_plugin.h");
  }
  if (const std::size_t size = size_of(plugin->version); plugin->size != size) {
    return bad_data(fmt::format("its struct has {} bytes instead of {}", plugin->size, size),
                    "set size = sizeof(mbk_device_plugin), and compile it for this machine");
  }
  if (const std::string names = missing(*plugin); !names.empty()) {
    return bad_data(fmt::format("it lacks {}", names), "set every function of mbk_device_plugin");
  }
  const auto agree = [](const char* key, bool fitted, bool expected) -> Result<void> {
    if (fitted == expected) return {};
    return bad_data(fmt::format("its {} is {}, but the experiment's is {}", key, fitted, expected),
                    fmt::format("set {} in [device]", key));
  };
  MBK_TRY(agree("has_force", plugin->has_force != 0, fittings.has_force));
  return agree("has_acceleration", plugin->has_acceleration != 0, fittings.has_acceleration);
}

}  // namespace

void PluginDevice::CloseLibrary::operator()(void* library) const {
  dlclose(library);
}

PluginDevice::PluginDevice(PluginOptions options, const Fittings& fittings, Library library,
                           const mbk_device_plugin& plugin)
    : options_(std::move(options)), fittings_(fittings), library_(std::move(library)), plugin_(&plugin) {
  facts_.name = printable(plugin.name != nullptr ? plugin.name : options_.library.filename().string());
  facts_.has_force = fittings.has_force;
  facts_.has_acceleration = fittings.has_acceleration;
  facts_.keeps_time = plugin.keeps_time != 0;
  facts_.force_latency = fittings.force_latency;
  facts_.acknowledges = plugin.version >= 2 && plugin.report != nullptr;
}

Result<std::unique_ptr<PluginDevice>> PluginDevice::create(const PluginOptions& options, const Fittings& fittings) {
  MBK_TRY(above_zero({{"watchdog", options.watchdog, "s"}}));
  // An absolute path: a bare name would be looked for where the system keeps its own libraries.
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::absolute(options.library, ignored);
  Library library(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL));
  if (!library) {
    const char* reason = dlerror();
    return bad_data(fmt::format("the plug-in cannot be loaded: {}", reason != nullptr ? reason : "no reason given"),
                    "check 'library' in [device], which is relative to the experiment's folder");
  }
  using Entry = const mbk_device_plugin* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(library.get(), kEntry));
  const std::string where = file.string();
  if (entry == nullptr) {
    return bad_data(fmt::format("it does not export {}", kEntry),
                    "include mbk/experiment/drivers/device_plugin.h, as in examples/device_plugin", where);
  }
  const mbk_device_plugin* plugin = entry();
  if (auto ok = check(plugin, fittings); !ok) return tl::unexpected(ok.error().in(where));
  return std::unique_ptr<PluginDevice>(new PluginDevice(options, fittings, std::move(library), *plugin));
}

PluginDevice::~PluginDevice() {
  close();
}

void PluginDevice::close() noexcept {
  if (open_) plugin_->close(device_);
  open_ = false;
}

Result<void> PluginDevice::start() {
  close();
  std::array<char, 512> message{};
  newest_ = {};
  written_ = 0;
  if (const int code =
          plugin_->open(&device_, options_.settings.c_str(), options_.watchdog, message.data(), message.size());
      code != 0) {
    message.back() = '\0';
    return bad_data(fmt::format("{}: {}", facts_.name,
                                message.front() != '\0' ? std::string(message.data())
                                                        : fmt::format("its open() fails with {}", code)),
                    "check the robot's power and cable, and 'settings' in [device]");
  }
  open_ = true;
  // A trial begins from where the robot is: so it has to be known.
  constexpr timespec kPause{0, 1'000'000};
  for (int i = 0; i < kFirstSampleWithin; ++i) {
    if (plugin_->read(device_, &newest_) == 0 && newest_.sequence > 0) return {};
    nanosleep(&kPause, nullptr);
  }
  close();
  return bad_data(fmt::format("{}: no sample within {} ms", facts_.name, kFirstSampleWithin),
                  "its read() must increment 'sequence' from 1 with each sample");
}

bool PluginDevice::read(device::State& state) noexcept {
  if (!open_ || plugin_->read(device_, &newest_) != 0) return false;
  device::RawState raw;
  raw.sequence = newest_.sequence;
  raw.time = newest_.time_s;
  raw.encoder = {newest_.encoder[0], newest_.encoder[1]};
  raw.force = {newest_.force[0], newest_.force[1]};
  raw.acceleration = {newest_.acceleration[0], newest_.acceleration[1]};
  raw.stop = newest_.stop != 0;
  state = fittings_.wiring.state(raw);
  return !facts_.acknowledges || read_report(state);
}

bool PluginDevice::read_report(device::State& state) noexcept {
  mbk_device_report report{};
  if (plugin_->report(device_, &report) != 0) return false;
  state.answered = report.answered;
  state.motors = report.motors_on != 0 ? device::Motors::on : device::Motors::off;
  state.has_force = report.has_force != 0;
  state.has_acceleration = report.has_acceleration != 0;
  state.watchdog_expired = report.watchdog_expired != 0;
  state.drives_measure = report.drives_measure != 0;
  state.drive_torque = fittings_.wiring.torque({report.drive_torque[0], report.drive_torque[1]});
  state.fault = report.fault;
  return true;
}

bool PluginDevice::write(const device::Command& command) noexcept {
  if (!open_) return false;
  const device::Vector2d own = fittings_.wiring.command(command.torque);
  const mbk_device_command given{written_++, {own[0], own[1]}, command.enabled ? 1 : 0};
  return plugin_->write(device_, &given) == 0;
}

void PluginDevice::stop() noexcept {
  write({});
}

}  // namespace mbk::drivers
