// A device behind a plugin (forcelayer/plugin.h), which runs in a process of its own.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "forcelayer/stale_limit.h"
#include "runtime/devices/device.h"
#include "runtime/devices/plugin/plugin_link.h"

namespace forcelayer::devices {

struct PluginOptions {
  std::filesystem::path library;  // the plugin
  std::string arguments;          // for its open()
  std::filesystem::path host;     // the program voxrun-plugin; empty: beside the running program
  bool trusted = false;  // may write files and start programs: its process keeps the user's rights
  double stale_s = kStaleLimitS;           // age at which the plugin's process drops a wrench
  double open_s = 20;                      // longest open(): some devices calibrate first
  const std::atomic<int>* stop = nullptr;  // ends the wait for open() once it is not 0
};

class PluginDevice final : public Device {
 public:
  explicit PluginDevice(PluginOptions options);
  ~PluginDevice() override;

  // The plugin's declaration, after start().
  const DeviceCapabilities& capabilities() const override { return capabilities_; }

  // Starts the process and shakes hands. Errors: kDeviceNotFound where library or program are
  // missing, kDeviceFailed where the plugin cannot open its device or its process dies,
  // kDeviceRefused where the handshake lacks a promise.
  Status start() override;

  DeviceSample read(double time_s) noexcept override;
  void write(const Wrench& device_wrench) noexcept override;

  // Asks the process to close the device, and waits for up to two seconds before it is killed; for
  // a fifth of one where the device is not open yet.
  void stop() noexcept override;

  DeviceTrouble trouble() const override;

 private:
  Status launch();
  Status shake_hands();
  void wait_for_end() noexcept;

  PluginOptions options_;
  DeviceCapabilities capabilities_;
  PluginLink* link_ = nullptr;  // mapped
  pid_t process_ = -1;
  std::thread waiter_;  // reaps the process
  std::atomic<bool> ended_{false};
  int exit_status_ = 0;  // of waitpid; read after ended_
  bool killed_ = false;  // by stop(), as it did not close its device
  machine::ValueProducer<PluginCommand> commands_;
  machine::ValueConsumer<PluginReading> readings_;
  std::atomic<bool> overwritten_{false};  // the shared memory, by the plugin
  PluginReading last_{};
};

}  // namespace forcelayer::devices
