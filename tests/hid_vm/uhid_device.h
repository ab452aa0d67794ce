// A virtual HID device in the kernel (uhid): what the system shows of it is a hidraw node like that
// of any USB device.
#pragma once

#include <fcntl.h>
#include <linux/input.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "runtime/machine/real_time.h"
#include "tests/support/virtual_haptic_device.h"

namespace forcelayer::test {

struct UhidIdentity {
  std::string name, serial;
  std::uint16_t vendor = 0, product = 0;
};

class UhidDevice {
 public:
  // Plugs it in. `on_output` gets what the host writes, as hidraw passed it on: with the id's byte,
  // 0 where reports are not numbered.
  UhidDevice(const UhidIdentity& identity, std::span<const std::uint8_t> descriptor,
             std::function<void(std::span<const std::uint8_t>)> on_output)
      : on_output_(std::move(on_output)), file_(open("/dev/uhid", O_RDWR | O_CLOEXEC)) {
    uhid_event event{};
    event.type = UHID_CREATE2;
    uhid_create2_req& request = event.u.create2;
    std::snprintf(reinterpret_cast<char*>(request.name), sizeof request.name, "%s",
                  identity.name.c_str());
    std::snprintf(reinterpret_cast<char*>(request.uniq), sizeof request.uniq, "%s",
                  identity.serial.c_str());
    std::memcpy(request.rd_data, descriptor.data(), descriptor.size());
    request.rd_size = static_cast<std::uint16_t>(descriptor.size());
    request.bus = BUS_USB;
    request.vendor = identity.vendor;
    request.product = identity.product;
    created_ = file_ >= 0 && post(event);
    if (created_) thread_ = std::thread([this] { run(); });
  }

  // Unplugs it.
  ~UhidDevice() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    if (file_ >= 0) close(file_);
  }
  UhidDevice(const UhidDevice&) = delete;
  UhidDevice& operator=(const UhidDevice&) = delete;

  bool created() const { return created_; }

  void send(std::span<const std::uint8_t> report) {
    uhid_event event{};
    event.type = UHID_INPUT2;
    event.u.input2.size = static_cast<std::uint16_t>(report.size());
    std::memcpy(event.u.input2.data, report.data(), report.size());
    post(event);
  }

 private:
  bool post(const uhid_event& event) const {
    return write(file_, &event, sizeof event) == static_cast<ssize_t>(sizeof event);
  }

  void run() {
    pollfd ready{file_, POLLIN, 0};
    uhid_event event{};
    while (!stop_) {
      if (poll(&ready, 1, 10) <= 0 || read(file_, &event, sizeof event) <= 0) continue;
      if (event.type != UHID_OUTPUT || event.u.output.rtype != UHID_OUTPUT_REPORT) continue;
      on_output_(std::span(event.u.output.data, event.u.output.size));
    }
  }

  std::function<void(std::span<const std::uint8_t>)> on_output_;
  int file_;
  bool created_ = false;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// The reference firmware behind a uhid device, sending once a millisecond while it is plugged in.
class UhidHapticUnit {
 public:
  static constexpr std::uint16_t kVendor = 0x16c0, kProduct = 0x0486;

  VirtualHapticDevice device;

  void plug() {
    uhid_ = std::make_unique<UhidDevice>(
        UhidIdentity{"Forcelayer virtual haptic device", "VM-1", kVendor, kProduct},
        std::span(kHapticReportDescriptor), [this](std::span<const std::uint8_t> report) {
          if (!report.empty()) device.receive(report.subspan(1));
        });
    stop_ = false;
    sender_ = std::thread([this] { run(); });
  }
  void unplug() {
    stop_ = true;
    if (sender_.joinable()) sender_.join();
    uhid_.reset();
  }
  ~UhidHapticUnit() { unplug(); }

  bool created() const { return uhid_ && uhid_->created(); }
  std::uint64_t sent() const { return sent_; }

 private:
  void run() {
    (void)machine::take_real_time_priority();  // a microcontroller has nothing else to do either
    std::array<std::uint8_t, HAPTIC_REPORT_BYTES> report{};
    for (long long tick_ns = machine::monotonic_ns(); !stop_; tick_ns += 1'000'000) {
      machine::sleep_until_ns(tick_ns);
      if (!device.next_report(report)) continue;
      uhid_->send(report);
      ++sent_;
    }
  }

  std::unique_ptr<UhidDevice> uhid_;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> sent_{0};
  std::thread sender_;
};

}  // namespace forcelayer::test
