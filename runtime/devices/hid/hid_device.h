// `hid`: a six-axis force-feedback device that speaks hid_haptic_report.md.
#pragma once

#include <semaphore.h>

#include <atomic>
#include <memory>
#include <thread>

#include "runtime/devices/device.h"
#include "runtime/devices/hid/hid_haptic_report.h"
#include "runtime/devices/hid/hid_link.h"
#include "runtime/devices/output_watch.h"
#include "runtime/machine/latest_value.h"

namespace forcelayer::devices {

// Counts of reports.
struct HidStatistics {
  std::uint64_t states = 0;     // new ones
  std::uint64_t gaps = 0;       // sequence numbers that never came
  std::uint64_t repeated = 0;   // an old sequence or time: not taken
  std::uint64_t malformed = 0;  // not taken
  std::uint64_t commands = 0;   // sent
  std::uint64_t faded = 0;      // of these: while the loop was late, or back since a moment
  std::uint64_t losses = 0;     // of the connection
  std::uint64_t longest_write_ns = 0;
};

// read() and write() hand over to a thread that reads and one that writes.
class HidDevice final : public Device, private HidLinkClient {
 public:
  // `bus`: make_hid_bus(), or a test's own. `stale_s`: how old the loop's last wrench may be.
  HidDevice(std::unique_ptr<HidBus> bus, HidSelector selector, double stale_s = kStaleLimitS);
  ~HidDevice() override;

  const DeviceCapabilities& capabilities() const override { return capabilities_; }
  Status start() override;
  DeviceSample read(double time_s) noexcept override;
  void write(const Wrench& device_wrench) noexcept override;
  void stop() noexcept override;

  HidStatistics statistics() const;

  std::vector<DeviceCounter> counters() const override;
  DeviceTrouble trouble() const override;

 private:
  // A wrench of the loop on its way to the writer.
  struct Outgoing {
    Wrench wrench;
    long long written_ns = 0;
    std::uint32_t frame = 0;
  };
  // The reading thread's view of this connection.
  struct Watch {
    HapticState newest;
    long long newest_ns = 0;                    // when it came
    std::uint64_t repeated = 0, malformed = 0;  // since then
    HapticDefect defect = HapticDefect::kNone;  // of the last malformed one
    bool taken = false;                         // the newest has been handed to the loop
  };

  Status attach(HidPort& port, const HidDeviceInfo& info) override;
  void take_report(std::span<const std::uint8_t> report, long long now_ns) noexcept override;
  HidLoss look(long long now_ns) noexcept override;
  void detach() noexcept override;

  Status greet(HidPort& port, const HidDeviceInfo& info);
  Status check_ratings(const DeviceCapabilities& device, const HidDeviceInfo& info) const;
  Status await_state(HidPort& port, const HidDeviceInfo& info);
  void take_state(const HapticState& state, long long now_ns) noexcept;
  void note_status(std::uint16_t status, long long now_ns) noexcept;
  bool send(HidPort& port, const HapticReport& report) noexcept;
  void run_writer(HidPort& port) noexcept;
  bool send_command(HidPort& port, const Outgoing& newest, const Wrench& wrench,
                    bool motors_on) noexcept;

  std::unique_ptr<HidBus> bus_;
  double stale_s_;
  DeviceCapabilities capabilities_;
  bool known_ = false;  // capabilities_ came from a device
  Watch watch_;
  machine::LatestValue<HapticState> states_;
  machine::LatestValue<Outgoing> outgoing_;
  HapticState state_;           // the loop's
  Outgoing newest_;             // the writer's
  std::uint32_t frame_ = 0;     // the loop's
  std::uint32_t sequence_ = 0;  // of the last report sent: by attach(), then by the writer
  sem_t written_;
  std::thread writer_;
  std::atomic<bool> writer_stop_{false}, write_failed_{false};
  std::atomic<bool> held_{true};               // the writer sends zero whatever it is given
  std::atomic<double> falls_{0};               // of the writer's watch on this connection
  std::atomic<std::uint32_t> known_state_{0};  // newest sequence, for the writer
  std::atomic<std::uint16_t> bad_status_{0};   // watchdog or fault: the last that it reported
  std::atomic<std::uint64_t> bad_losses_{0};   // link_.losses() at that time
  std::atomic<long long> absent_until_ns_{0};  // after a fault
  std::atomic<long long> held_until_ns_{0};    // after its watchdog
  std::atomic<std::uint64_t> count_states_{0}, count_gaps_{0}, count_repeated_{0},
      count_malformed_{0}, count_commands_{0}, count_faded_{0}, longest_write_ns_{0};
  HidLink link_;
};

}  // namespace forcelayer::devices
