// The one file that sees hidapi.h.
#include <hidapi.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <cwchar>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "runtime/devices/hid/hid_port.h"
#include "runtime/devices/hid/hid_report_descriptor.h"

namespace forcelayer::devices {
namespace {

// Serial numbers and names are ASCII in practice; any other character becomes '?'.
std::string narrow(const wchar_t* wide) {
  std::string text;
  for (; wide != nullptr && *wide != 0; ++wide) {
    text += *wide >= 0x20 && *wide < 0x7f ? static_cast<char>(*wide) : '?';
  }
  return text;
}

// hidapi 0.13 has no call for it; the kernel shows it beside the node, readable for everyone.
std::vector<std::uint8_t> kernel_descriptor(const std::string& path) {
  const std::string node = std::filesystem::path(path).filename();
  std::ifstream file("/sys/class/hidraw/" + node + "/device/report_descriptor", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class HidapiPort final : public HidPort {
 public:
  HidapiPort(hid_device* device, std::string path) : device_(device), path_(std::move(path)) {}
  ~HidapiPort() override { hid_close(device_); }
  HidapiPort(const HidapiPort&) = delete;
  HidapiPort& operator=(const HidapiPort&) = delete;

  int read(std::span<std::uint8_t> report, int timeout_ms) noexcept override {
    return hid_read_timeout(device_, report.data(), report.size(), timeout_ms);
  }
  bool write(std::span<const std::uint8_t> report) noexcept override {
    return hid_write(device_, report.data(), report.size()) >= 0;
  }
  std::vector<std::uint8_t> report_descriptor() override { return kernel_descriptor(path_); }

 private:
  hid_device* device_;
  std::string path_;
};

class HidapiBus final : public HidBus {
 public:
  std::vector<HidDeviceInfo> list(const HidSelector& selector) override {
    std::vector<HidDeviceInfo> found;
    hid_device_info* const all = hid_enumerate(selector.vendor, selector.product);
    for (const hid_device_info* d = all; d != nullptr; d = d->next) {
      HidDeviceInfo info{d->path,
                         d->vendor_id,
                         d->product_id,
                         narrow(d->serial_number),
                         narrow(d->product_string),
                         hid_usage(d->usage_page, d->usage)};
      if (!selector.serial.empty() && info.serial != selector.serial) continue;
      found.push_back(std::move(info));
    }
    hid_free_enumeration(all);
    return found;
  }

  Result<std::unique_ptr<HidPort>> open(const HidDeviceInfo& info) override {
    if (access(info.path.c_str(), R_OK | W_OK) != 0) {
      const int why = errno;
      return Error{why == ENOENT ? ErrorCode::kDeviceNotFound : ErrorCode::kDeviceFailed, info.path,
                   "", std::string("cannot be opened: ") + std::strerror(why),
                   why == EACCES ? "give the user access by a udev rule ('voxrun doctor' prints "
                                   "it), then plug the device in again"
                                 : "plug it in again"};
    }
    hid_device* const device = hid_open_path(info.path.c_str());
    if (device == nullptr) {
      return Error{ErrorCode::kDeviceFailed, info.path, "", "hidapi cannot open this device",
                   "plug it in again"};
    }
    return std::unique_ptr<HidPort>(std::make_unique<HidapiPort>(device, info.path));
  }
};

}  // namespace

std::unique_ptr<HidBus> make_hid_bus() { return std::make_unique<HidapiBus>(); }

}  // namespace forcelayer::devices
