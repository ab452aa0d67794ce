// A HID bus in this process, with the habits of hidraw: a queue of 64 reports that keeps the
// oldest, reads that end with -1 once the device is gone.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "runtime/devices/hid/hid_port.h"
#include "tests/support/virtual_haptic_device.h"

namespace forcelayer::test {

// One device's place on the bus; outlives the ports into it.
class FakeSocket {
 public:
  static constexpr std::size_t kQueue = 64;

  std::vector<std::uint8_t> descriptor;
  devices::HidDeviceInfo info;
  std::function<void(std::span<const std::uint8_t>)> on_write;  // without the id's byte

  void plug(bool in) {
    const std::lock_guard lock(mutex_);
    plugged_ = in;
    ++plugs_;
    queue_.clear();
    news_.notify_all();
  }
  bool plugged() {
    const std::lock_guard lock(mutex_);
    return plugged_;
  }
  std::uint64_t plugs() {
    const std::lock_guard lock(mutex_);
    return plugs_;
  }
  void send(std::span<const std::uint8_t> report) {
    send_all({std::vector(report.begin(), report.end())});
  }
  // All at once: no reader comes between.
  void send_all(const std::vector<std::vector<std::uint8_t>>& reports) {
    const std::lock_guard lock(mutex_);
    if (!plugged_) return;
    for (const auto& report : reports) {
      if (queue_.size() < kQueue) {
        queue_.push_back(report);
      } else {
        ++lost_;
      }
    }
    news_.notify_all();
  }
  // Reports for which there was no room.
  std::uint64_t lost() {
    const std::lock_guard lock(mutex_);
    return lost_;
  }
  int receive(std::span<std::uint8_t> report, int timeout_ms, std::uint64_t plugs) {
    std::unique_lock lock(mutex_);
    const auto gone = [&] { return !plugged_ || plugs_ != plugs; };
    news_.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                   [&] { return gone() || !queue_.empty(); });
    if (gone()) return -1;
    if (queue_.empty()) return 0;
    const std::size_t bytes = std::min(report.size(), queue_.front().size());
    std::copy_n(queue_.front().begin(), bytes, report.begin());
    queue_.pop_front();
    return static_cast<int>(bytes);
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  std::deque<std::vector<std::uint8_t>> queue_;
  bool plugged_ = true;
  std::uint64_t plugs_ = 0, lost_ = 0;
};

class FakeHidBus final : public devices::HidBus {
 public:
  explicit FakeHidBus(std::vector<std::shared_ptr<FakeSocket>> sockets)
      : sockets_(std::move(sockets)) {}

  std::vector<devices::HidDeviceInfo> list(const devices::HidSelector& selector) override {
    std::vector<devices::HidDeviceInfo> found;
    for (const auto& socket : sockets_) {
      const devices::HidDeviceInfo& info = socket->info;
      if (socket->plugged() && (selector.vendor == 0 || selector.vendor == info.vendor) &&
          (selector.product == 0 || selector.product == info.product) &&
          (selector.serial.empty() || selector.serial == info.serial)) {
        found.push_back(info);
      }
    }
    return found;
  }
  Result<std::unique_ptr<devices::HidPort>> open(const devices::HidDeviceInfo& info) override {
    for (const auto& socket : sockets_) {
      if (socket->info.path == info.path && socket->plugged()) {
        return std::unique_ptr<devices::HidPort>(std::make_unique<Port>(socket));
      }
    }
    return Error{ErrorCode::kDeviceNotFound, info.path, "", "is gone", ""};
  }

 private:
  class Port final : public devices::HidPort {
   public:
    explicit Port(std::shared_ptr<FakeSocket> socket)
        : socket_(std::move(socket)), plugs_(socket_->plugs()) {}
    int read(std::span<std::uint8_t> report, int timeout_ms) noexcept override {
      return socket_->receive(report, timeout_ms, plugs_);
    }
    bool write(std::span<const std::uint8_t> report) noexcept override {
      if (!socket_->plugged() || socket_->plugs() != plugs_) return false;
      socket_->on_write(report);
      return true;
    }
    std::vector<std::uint8_t> report_descriptor() override { return socket_->descriptor; }

   private:
    std::shared_ptr<FakeSocket> socket_;
    std::uint64_t plugs_;
  };

  std::vector<std::shared_ptr<FakeSocket>> sockets_;
};

// A virtual haptic device on a socket, sending once a millisecond.
class FakeHapticUnit {
 public:
  explicit FakeHapticUnit(const HapticDeviceRatings& ratings = virtual_ratings())
      : device(ratings), socket(std::make_shared<FakeSocket>()) {
    socket->descriptor.assign(kHapticReportDescriptor,
                              kHapticReportDescriptor + HAPTIC_REPORT_DESCRIPTOR_BYTES);
    socket->info = {"/dev/fake0", 0x16c0, 0x0486, "7", "Virtual haptic device", 0xff46'0001};
    socket->on_write = [this](std::span<const std::uint8_t> report) {
      device.receive(report.subspan(1));
    };
  }
  ~FakeHapticUnit() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

  void run() {
    thread_ = std::thread([this] {
      std::array<std::uint8_t, HAPTIC_REPORT_BYTES> report{};
      for (long long tick_ns = machine::monotonic_ns(); !stop_; tick_ns += 1'000'000) {
        machine::sleep_until_ns(tick_ns);
        if (burst_.exchange(false)) socket->send_all(make_burst());
        if (device.next_report(report)) socket->send(report);
      }
    });
  }

  // Soon, between two reports of the stream: thirty at once, every third of them lost on the way.
  static constexpr int kBurst = 30, kBurstLost = kBurst / 3;
  void burst() { burst_ = true; }
  bool bursting() const { return burst_; }

  VirtualHapticDevice device;
  std::shared_ptr<FakeSocket> socket;

 private:
  std::vector<std::vector<std::uint8_t>> make_burst() {
    std::vector<std::vector<std::uint8_t>> kept;
    std::array<std::uint8_t, HAPTIC_REPORT_BYTES> report{};
    for (int i = 0; i < kBurst; ++i) {
      // The device's clock goes on from report to report: one that stands still is a fault.
      for (const std::uint32_t now_us = device.now_us(); device.now_us() == now_us;) {
      }
      if (device.next_report(report) && i % 3 != 1) kept.emplace_back(report.begin(), report.end());
    }
    return kept;
  }

  std::atomic<bool> stop_{false}, burst_{false};
  std::thread thread_;
};

}  // namespace forcelayer::test
