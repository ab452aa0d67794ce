#include "runtime/voxrun/hid_choice.h"

#include "formats/command/arguments.h"
#include "runtime/devices/hid/hid_device.h"

namespace forcelayer::voxrun {
namespace {

constexpr const char* kSpaceMouseOptions[] = {"--control",        "--dead-zone", "--cap-speed",
                                              "--cap-turn-speed", "--cap-reach", "--cap-turn"};

}  // namespace

void add_hid_options(CLI::App& app, HidOptions& options) {
  devices::SpaceMouseOptions& cap = options.spacemouse;
  CLI::Option* const all[] = {
      command::add_text(app, "--hid", options.which,
                        "which one: VENDOR:PRODUCT[:SERIAL] in hexadecimal, or /dev/hidrawN"),
      command::add_choice(
          app, "--control", options.control, {"rate", "position"},
          "spacemouse: rate (its deflection is a speed; default) or position (it is a place)"),
      command::add_number(app, "--dead-zone", cap.dead_zone,
                          "spacemouse: share of full deflection that is rest", {0, 0.9}),
      command::add_number(app, "--cap-speed", cap.speed_mps,
                          "spacemouse, rate: m/s at full deflection", {1e-6, 10}),
      command::add_number(app, "--cap-turn-speed", cap.turn_radps,
                          "spacemouse, rate: rad/s at full deflection", {1e-6, 100}),
      command::add_number(app, "--cap-reach", cap.reach_m,
                          "spacemouse, position: m at full deflection", {1e-6, 10}),
      command::add_number(app, "--cap-turn", cap.reach_rad,
                          "spacemouse, position: rad at full deflection", {1e-6, 6.3})};
  for (CLI::Option* const option : all) command::group(option, "HID devices (hid, spacemouse)");
}

Status check_hid_options(const CLI::App& app, const HidOptions& options,
                         const std::string& device) {
  const auto usage = [](const char* option, const char* what, const char* mend) {
    return Error{ErrorCode::kUsage, "", option, what, mend};
  };
  if (!options.which.empty()) {
    if (!is_hid(device)) {
      return usage("--hid", "is for hid and spacemouse", "give --device hid or spacemouse");
    }
    if (const auto selector = devices::parse_hid_selector(options.which); !selector) {
      return usage("--hid", selector.error().what.c_str(), selector.error().mend.c_str());
    }
  }
  for (const char* option : kSpaceMouseOptions) {
    if (command::is_given(app, option) && device != "spacemouse") {
      return usage(option, "is for the spacemouse", "give --device spacemouse");
    }
  }
  return {};
}

std::unique_ptr<devices::Device> make_hid_device(const HidOptions& options,
                                                 const std::string& device, double stale_s) {
  devices::HidSelector selector;
  if (!options.which.empty()) selector = *devices::parse_hid_selector(options.which);
  if (device == "hid")
    return std::make_unique<devices::HidDevice>(devices::make_hid_bus(), selector, stale_s);
  devices::SpaceMouseOptions cap = options.spacemouse;
  cap.control = options.control == "position" ? devices::SpaceMouseControl::kPosition
                                              : devices::SpaceMouseControl::kRate;
  return std::make_unique<devices::SpaceMouse>(devices::make_hid_bus(), selector, cap);
}

}  // namespace forcelayer::voxrun
