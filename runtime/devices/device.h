// A device as the loop sees it: readings in, wrenches out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "forcelayer/device.h"
#include "formats/result.h"

namespace forcelayer::devices {

struct DeviceCounter {
  const char* name;
  std::uint64_t value;
};

// Why a device was last absent, or took its motors to zero, and what to do about it: each a part of
// a sentence, empty where there was nothing.
struct DeviceTrouble {
  std::string what, mend;
};

// A device as the loop sees it. read() and write() are called from the loop's thread only: they
// never block, allocate or call out; slow I/O lives on a thread of the device's own, which passes
// every wrench through an OutputWatch (output_watch.h), so that a loop that stands still is not
// felt as its last force for ever.
class Device {
 public:
  virtual ~Device() = default;

  virtual const DeviceCapabilities& capabilities() const = 0;

  // Connects and starts whatever threads the device has. Errors: device codes (5xx).
  virtual Status start() = 0;

  // The newest reading at loop time `time_s`.
  virtual DeviceSample read(double time_s) noexcept = 0;

  // The wrench on the hand, about the handle's origin, device axes.
  virtual void write(const Wrench& device_wrench) noexcept = 0;

  // Takes the output to zero and disconnects. Safe to call twice.
  virtual void stop() noexcept = 0;

  // Counts of its own side since start(), for the report.
  virtual std::vector<DeviceCounter> counters() const { return {}; }

  // For a message. Not for the loop's thread.
  virtual DeviceTrouble trouble() const { return {}; }
};

}  // namespace forcelayer::devices
