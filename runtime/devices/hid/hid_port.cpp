#include "runtime/devices/hid/hid_port.h"

#include <algorithm>
#include <charconv>

namespace forcelayer::devices {
namespace {

std::string hex4(std::uint16_t value) {
  char digits[4];
  const auto end = std::to_chars(digits, digits + 4, value, 16).ptr;
  return std::string(4 - static_cast<std::size_t>(end - digits), '0') + std::string(digits, end);
}

bool read_hex(std::string_view text, std::uint16_t& value) {
  if (text.empty() || text.size() > 4) return false;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

Result<HidSelector> parse_hid_selector(const std::string& text) {
  HidSelector selector;
  if (text.starts_with('/')) {
    selector.path = text;
    return selector;
  }
  const std::size_t colon = text.find(':');
  const std::size_t second = colon == std::string::npos ? colon : text.find(':', colon + 1);
  if (colon == std::string::npos ||
      !read_hex(std::string_view(text).substr(0, colon), selector.vendor) ||
      !read_hex(std::string_view(text).substr(colon + 1, second - colon - 1), selector.product)) {
    return Error{ErrorCode::kUsage, "", "", "'" + text + "' is not a HID device",
                 "give VENDOR:PRODUCT[:SERIAL] in hexadecimal, like 16c0:0486, or /dev/hidrawN"};
  }
  if (second != std::string::npos) selector.serial = text.substr(second + 1);
  return selector;
}

std::string to_text(const HidDeviceInfo& info) {
  return (info.product_name.empty() ? "HID device" : info.product_name) + " (" + hex4(info.vendor) +
         ":" + hex4(info.product) + (info.serial.empty() ? "" : ", serial " + info.serial) + ", " +
         info.path + ")";
}

Result<HidDeviceInfo> find_hid_device(HidBus& bus, const HidSelector& selector,
                                      std::span<const std::uint16_t> vendors, std::uint32_t usage,
                                      const std::string& kind) {
  std::vector<HidDeviceInfo> found = bus.list(selector);
  const bool named = selector.vendor != 0 || !selector.path.empty();
  std::erase_if(found, [&](const HidDeviceInfo& info) {
    if (!selector.path.empty()) return info.path != selector.path;
    const bool maker =
        vendors.empty() || std::find(vendors.begin(), vendors.end(), info.vendor) != vendors.end();
    return !named && (info.usage != usage || !maker);
  });
  // One device may have several collections; the right one stands for it.
  const bool right = std::any_of(found.begin(), found.end(),
                                 [&](const HidDeviceInfo& info) { return info.usage == usage; });
  if (right) std::erase_if(found, [&](const HidDeviceInfo& info) { return info.usage != usage; });
  if (found.empty()) {
    return Error{ErrorCode::kDeviceNotFound, "", selector.path,
                 "no " + kind + (named ? " with this name" : "") + " is plugged in",
                 named ? "list the devices with lsusb and ls /dev/hidraw*"
                       : "plug it in, or name the device with id= of --device"};
  }
  const bool several = std::any_of(found.begin(), found.end(), [&](const HidDeviceInfo& info) {
    return info.path != found.front().path;
  });
  if (several) {
    return Error{ErrorCode::kUsage, "", "",
                 "several devices are possible: " + to_text(found[0]) + ", " + to_text(found[1]),
                 "choose one with id=VENDOR:PRODUCT:SERIAL or id=PATH in --device"};
  }
  return found.front();
}

}  // namespace forcelayer::devices
