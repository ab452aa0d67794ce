// A HID device that may come and go: a thread that reads it, notices its loss and finds it again.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <thread>

#include "runtime/devices/device.h"
#include "runtime/devices/hid/hid_port.h"

namespace forcelayer::devices {

// The reason why a connection ends, as in DeviceTrouble; null where it goes on.
struct HidLoss {
  const char* what = nullptr;
  const char* mend = nullptr;
};

// The driver of a device. HidLink::start() makes the first attach(); every other call comes from
// the link's thread.
class HidLinkClient {
 public:
  virtual ~HidLinkClient() = default;

  // The device was opened: look at its descriptor, greet it. The port stays until detach().
  virtual Status attach(HidPort& port, const HidDeviceInfo& info) = 0;

  virtual void take_report(std::span<const std::uint8_t> report, long long now_ns) noexcept = 0;

  // Called once all waiting reports were taken, and at least every kReadWaitMs. Returns the reason
  // to give the connection up, or nothing.
  virtual HidLoss look(long long now_ns) noexcept = 0;

  virtual void detach() noexcept = 0;
};

// The devices that a driver serves.
struct HidFamily {
  std::string kind;                        // in messages: "haptic HID device"
  std::span<const std::uint16_t> vendors;  // empty: any
  std::uint32_t usage = 0;                 // of the application collection
};

class HidLink {
 public:
  static constexpr int kReadWaitMs = 20;
  static constexpr int kRetryMs = 200;

  // Everything given must outlive the link.
  HidLink(HidBus& bus, const HidFamily& family, HidSelector selector, HidLinkClient& client)
      : bus_(bus), family_(family), selector_(std::move(selector)), client_(client) {}
  ~HidLink() { stop(); }

  // Finds, opens and attaches the device, then keeps it on a thread. Errors: those of
  // find_hid_device(), HidBus::open() and attach().
  Status start();

  // Detaches and ends the thread. Safe to call twice.
  void stop() noexcept;

  // For any thread.
  bool connected() const noexcept { return connected_.load(std::memory_order_acquire); }
  std::uint64_t losses() const noexcept { return losses_.load(std::memory_order_relaxed); }

  // The reason of the last loss or of the failed reconnection; empty where there was none. Not for
  // the loop's thread.
  DeviceTrouble trouble() const;

 private:
  Status connect();
  void run() noexcept;
  HidLoss read_round() noexcept;
  void lose(const DeviceTrouble& why) noexcept;
  void wait_to_retry() noexcept;

  HidBus& bus_;
  HidFamily family_;
  HidSelector selector_;
  HidLinkClient& client_;
  std::unique_ptr<HidPort> port_;
  std::thread thread_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> connected_{false};
  std::atomic<std::uint64_t> losses_{0};
  mutable std::mutex trouble_mutex_;
  DeviceTrouble trouble_;
};

}  // namespace forcelayer::devices
