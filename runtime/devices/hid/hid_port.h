// HID devices as the drivers see them: found by the user's choice, opened, read and written.
// hidapi_bus.cpp implements this over hidapi; the tests have a bus of their own.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/result.h"

namespace forcelayer::devices {

// The user's choice of a device. An empty or zero field fits any.
struct HidSelector {
  std::uint16_t vendor = 0, product = 0;
  std::string serial;
  std::string path;  // /dev/hidrawN
};

// VENDOR:PRODUCT[:SERIAL] in hexadecimal, or a path. Errors: kUsage.
Result<HidSelector> parse_hid_selector(const std::string& text);

struct HidDeviceInfo {
  std::string path;
  std::uint16_t vendor = 0, product = 0;
  std::string serial, product_name;
  std::uint32_t usage = 0;  // of an application collection, page in the upper 16 bits
};

// "Maker's name (16c0:0486, serial 12, /dev/hidraw0)".
std::string to_text(const HidDeviceInfo& info);

// An open device. read() on one thread and write() on one other; the rest before either.
class HidPort {
 public:
  virtual ~HidPort() = default;

  // The next report, with its id's byte where reports are numbered. Waits for `timeout_ms` at
  // most. Returns its bytes, 0 where none came, -1 where the device is lost.
  virtual int read(std::span<std::uint8_t> report, int timeout_ms) noexcept = 0;

  // `report` begins with the id's byte, 0 where reports are not numbered. May block for
  // milliseconds. False where the device is lost.
  virtual bool write(std::span<const std::uint8_t> report) noexcept = 0;

  // Empty where the system does not tell.
  virtual std::vector<std::uint8_t> report_descriptor() = 0;
};

class HidBus {
 public:
  virtual ~HidBus() = default;

  // Devices that fit, one entry for each application collection. Not by path.
  virtual std::vector<HidDeviceInfo> list(const HidSelector& selector) = 0;

  // Errors: kDeviceNotFound, or kDeviceFailed with the remedy.
  virtual Result<std::unique_ptr<HidPort>> open(const HidDeviceInfo& info) = 0;
};

// hidapi with its hidraw backend. Not to be used from two threads at once.
std::unique_ptr<HidBus> make_hid_bus();

// The device that `selector` names. Without a path or vendor in it, only devices with `usage`
// count. Errors: kDeviceNotFound; kUsage where several fit.
Result<HidDeviceInfo> find_hid_device(HidBus& bus, const HidSelector& selector,
                                      std::span<const std::uint16_t> vendors, std::uint32_t usage,
                                      const std::string& kind);

}  // namespace forcelayer::devices
