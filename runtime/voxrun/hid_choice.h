// The HID devices on the command line: --device hid and spacemouse, and what they can be told.
#pragma once

#include <memory>
#include <string>

#include "formats/result.h"
#include "runtime/devices/device.h"
#include "runtime/devices/hid/spacemouse.h"

namespace CLI {
class App;
}

namespace forcelayer::voxrun {

struct HidOptions {
  std::string which;  // --hid; empty: the only one of its kind
  std::string control = "rate";
  devices::SpaceMouseOptions spacemouse;
};

void add_hid_options(CLI::App& app, HidOptions& options);

// Finds options that contradict each other or `device`, the kind of device. Errors: kUsage.
Status check_hid_options(const CLI::App& app, const HidOptions& options, const std::string& device);

inline bool is_hid(const std::string& device) { return device == "hid" || device == "spacemouse"; }

// Not started. `stale_s`: how old the loop's last wrench may be. `options` were checked.
std::unique_ptr<devices::Device> make_hid_device(const HidOptions& options,
                                                 const std::string& device, double stale_s);

}  // namespace forcelayer::voxrun
