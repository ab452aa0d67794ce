#include "runtime/voxrun/device_text.h"

#include <algorithm>

#include "formats/command/arguments.h"
#include "formats/command/help.h"
#include "formats/command/values.h"
#include "runtime/devices/hid/hid_port.h"

namespace forcelayer::voxrun {
namespace {

constexpr double kMaxButton = 31;  // of the 32 bits of a reading

Error usage(std::string_view where, std::string_view what, std::string_view mend) {
  return {ErrorCode::kUsage, "", where, what, mend};
}

Status read_buttons(const std::string& text, Options& options) {
  constexpr double kNone = -1;
  double numbers[] = {kNone, kNone, kNone};
  const command::Bounds bounds{0, kMaxButton};
  const command::ValueName names[] = {{.name = "clutch", .number = &numbers[0], .bounds = bounds},
                                      {.name = "scene", .number = &numbers[1], .bounds = bounds},
                                      {.name = "guide", .number = &numbers[2], .bounds = bounds}};
  if (Status read = command::read_values("--buttons", text, names); !read) return read;
  std::optional<unsigned>* const buttons[] = {&options.clutch_button, &options.scene_button,
                                              &options.guide_button};
  for (int n = 0; n < 3; ++n) {
    if (numbers[n] == kNone) continue;
    *buttons[n] = static_cast<unsigned>(numbers[n]);
    if (**buttons[n] != numbers[n]) {
      return usage("--buttons", std::string(names[n].name) + " is not a whole number", "");
    }
  }
  return {};
}

}  // namespace

void add_device_options(CLI::App& app, DeviceTexts& texts) {
  command::name_value(
      command::add_text(app, "--device", texts.device,
                        "the device, sim (a simulated hand) by default; its options follow behind "
                        "a colon, as NAME=VALUE,...: see below"),
      "sim|hid|spacemouse|plugin");
  command::name_value(
      command::add_text(app, "--buttons", texts.buttons,
                        "buttons of the device, numbered from 0 to 31: clutch holds the part "
                        "while the hand moves (default of hardware: 0), scene asks for the next "
                        "scene of --scene-next, or for the last file anew, guide switches --guide "
                        "off and on"),
      "clutch=N,scene=N,guide=N");
  command::add_help_table(
      app, "Options of --device (a comma in a value is written twice)",
      "hid:id=ID\tchoose a device: VENDOR:PRODUCT[:SERIAL] in hexadecimal, or /dev/hidrawN; "
      "spacemouse "
      "has it too\n"
      "hid:without-watchdog\tuse a device with motors that does not stop by itself; plugin has it "
      "too\n"
      "plugin:library=FILE\tthe plugin's shared library\n"
      "plugin:args=TEXT\ttext for the plugin\n"
      "plugin:trust\tlet the plugin write files and start programs\n"
      "spacemouse:control=WORD\trate: deflection is a speed (default); position: it is a place\n"
      "spacemouse:dead-zone=N\tshare of full deflection that is rest, default 0.05\n"
      "spacemouse:speed=N\tm/s at full deflection in rate control, default 0.1; turn-speed=N: "
      "rad/s, default 1\n"
      "spacemouse:reach=N\tm at full deflection in position control, default 0.05; turn=N: rad, "
      "default 0.8\n");
}

Status read_device(const DeviceTexts& texts, Options& options) {
  const std::string& text = texts.device;
  std::string id, control;
  devices::SpaceMouseOptions& cap = options.spacemouse;
  // Each kind takes some of them, one after the other.
  const command::ValueName names[] = {
      {.name = "dead-zone", .number = &cap.dead_zone, .bounds = {0, 0.9}},
      {.name = "speed", .number = &cap.speed_mps, .bounds = {1e-6, 10}},
      {.name = "turn-speed", .number = &cap.turn_radps, .bounds = {1e-6, 100}},
      {.name = "reach", .number = &cap.reach_m, .bounds = {1e-6, 10}},
      {.name = "turn", .number = &cap.reach_rad, .bounds = {1e-6, 6.3}},
      {.name = "control", .text = &control},
      {.name = "id", .text = &id},
      {.name = "without-watchdog", .is_given = &options.without_watchdog},
      {.name = "library", .text = &options.plugin},
      {.name = "args", .text = &options.plugin_args},
      {.name = "trust", .is_given = &options.trust_plugin}};
  const std::span<const command::ValueName> all(names);
  options.device = text.substr(0, text.find(':'));
  std::span<const command::ValueName> known;
  if (options.device == "spacemouse") {
    known = all.first(7);
  } else if (options.device == "hid") {
    known = all.subspan(6, 2);
  } else if (options.device == "plugin") {
    known = all.last(4);
  } else if (options.device != "sim") {
    return usage("--device", "'" + options.device + "' is not a kind of device",
                 options.device == "replay" ? "give --replay FILE alone"
                                            : "give sim, hid, spacemouse or plugin");
  }
  const auto values =
      std::string_view(text).substr(std::min(options.device.size() + 1, text.size()));
  if (Status read = command::read_values("--device", values, known); !read) return read;
  if (!id.empty()) {
    auto selector = devices::parse_hid_selector(id);
    if (!selector) return command::about("--device id", selector.error());
    options.hid = std::move(*selector);
  }
  if (control == "position") {
    cap.control = devices::SpaceMouseControl::kPosition;
  } else if (!control.empty() && control != "rate") {
    return usage("--device", "control '" + control + "' is not known", "give rate or position");
  }
  if (options.device == "plugin" && options.plugin.empty()) {
    return usage("--device", "plugin needs the plugin's library", "write plugin:library=FILE");
  }
  return read_buttons(texts.buttons, options);
}

}  // namespace forcelayer::voxrun
