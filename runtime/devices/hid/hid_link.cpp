#include "runtime/devices/hid/hid_link.h"

#include <array>
#include <utility>

#include "runtime/machine/real_time.h"

namespace forcelayer::devices {
namespace {

constexpr std::size_t kMaxReportBytes = 4096;
constexpr int kMaxDrained = 256;  // four full queues of the kernel; then look() is due
constexpr int kStopLookMs = 10;   // how soon a wait sees that it is to stop

DeviceTrouble described(Error error) {
  std::string mend = std::exchange(error.mend, {});
  return {to_line(error), std::move(mend)};
}

}  // namespace

Status HidLink::connect() {
  const auto info = find_hid_device(bus_, selector_, family_.vendors, family_.usage, family_.kind);
  if (!info) return info.error();
  auto port = bus_.open(*info);
  if (!port) return port.error();
  if (Status attached = client_.attach(**port, *info); !attached) return attached;
  port_ = std::move(*port);
  // From now on only this device counts. Its node's number may change.
  selector_ = {info->vendor, info->product, info->serial, ""};
  connected_.store(true, std::memory_order_release);
  return {};
}

Status HidLink::start() {
  if (Status first = connect(); !first) return first;
  stop_.store(false);
  thread_ = std::thread([this] { run(); });
  return {};
}

void HidLink::stop() noexcept {
  stop_.store(true);
  if (thread_.joinable()) thread_.join();
}

DeviceTrouble HidLink::trouble() const {
  const std::lock_guard lock(trouble_mutex_);
  return trouble_;
}

void HidLink::lose(const DeviceTrouble& why) noexcept {
  const std::lock_guard lock(trouble_mutex_);
  trouble_ = why;
}

void HidLink::wait_to_retry() noexcept {
  for (int waited = 0; waited < kRetryMs && !stop_.load(); waited += kStopLookMs) {
    machine::sleep_until_ns(machine::monotonic_ns() + kStopLookMs * 1'000'000LL);
  }
}

// The kernel's queue keeps the oldest reports when it is full: it is emptied every time.
HidLoss HidLink::read_round() noexcept {
  std::array<std::uint8_t, kMaxReportBytes> report;
  int wait_ms = kReadWaitMs;
  for (int i = 0; i < kMaxDrained; ++i, wait_ms = 0) {
    const int bytes = port_->read(report, wait_ms);
    if (bytes < 0) return {"the device was unplugged", "check plug and power"};
    if (bytes == 0) break;
    client_.take_report(std::span(report).first(static_cast<std::size_t>(bytes)),
                        machine::monotonic_ns());
  }
  return client_.look(machine::monotonic_ns());
}

void HidLink::run() noexcept {
  (void)machine::take_real_time_priority();  // the loop's own call has said what is refused
  while (!stop_.load()) {
    if (port_ == nullptr) {
      wait_to_retry();
      if (stop_.load()) break;
      const Status again = connect();
      // "Not plugged in" would replace the reason of the loss and say less.
      if (!again && again.error().code != ErrorCode::kDeviceNotFound)
        lose(described(again.error()));
      continue;
    }
    const HidLoss lost = read_round();
    if (lost.what == nullptr) continue;
    lose({lost.what, lost.mend});
    losses_.fetch_add(1, std::memory_order_relaxed);
    connected_.store(false, std::memory_order_release);
    client_.detach();
    port_.reset();
  }
  if (port_ != nullptr) {
    connected_.store(false, std::memory_order_release);
    client_.detach();
    port_.reset();
  }
}

}  // namespace forcelayer::devices
