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

// The buttons of a device by their numbers; kNone for one that is not given.
struct Buttons {
  static constexpr double kNone = -1;
  double clutch = kNone, scene = kNone, guide = kNone;
};

Status take_buttons(const Buttons& buttons, Options& options) {
  const struct {
    const char* name;
    double number;
    std::optional<unsigned>& button;
  } all[] = {{"clutch", buttons.clutch, options.clutch_button},
             {"scene", buttons.scene, options.scene_button},
             {"guide", buttons.guide, options.guide_button}};
  for (const auto& one : all) {
    if (one.number == Buttons::kNone) continue;
    one.button = static_cast<unsigned>(one.number);
    if (*one.button != one.number) {
      return usage("--device", std::string(one.name) + " is not a whole number", "");
    }
  }
  return {};
}

}  // namespace

void add_device_options(CLI::App& app, std::string& text) {
  command::name_value(command::add_text(app, "--device", text,
                                        "the device; default sim, a simulated hand. Options follow "
                                        "a colon, as NAME=VALUE,... (see below)"),
                      "sim|hid|spacemouse|plugin");
  command::add_help_table(
      app, "Options of --device (a comma in a value is written twice)",
      "sim:hand=WORD\tfirm or loose: a hand that feels the force, and tries to follow --motion; "
      "default: a hand that feels nothing\n"
      "hid:clutch=N\tclutch, a button from 0 to 31: while it is pressed, the hand moves without "
      "the part. Default 0; also for spacemouse and plugin\n"
      "hid:scene=N\tbutton that loads the next file of --scene-next, or the current file again if "
      "none is left; also for spacemouse and plugin\n"
      "hid:guide=N\tbutton that switches --guide off and on; also for spacemouse and plugin\n"
      "hid:id=ID\tchoose a device: VENDOR:PRODUCT[:SERIAL] in hexadecimal, or /dev/hidrawN; also "
      "for spacemouse\n"
      "hid:without-watchdog\taccept a device whose motors have no watchdog; also for plugin\n"
      "plugin:library=FILE\tthe plugin's shared library\n"
      "plugin:args=TEXT\ttext for the plugin\n"
      "plugin:trust\tlet the plugin write files and start programs\n"
      "spacemouse:control=WORD\trate (default): the push or twist of the cap sets the speed; "
      "position: it sets the position\n"
      "spacemouse:dead-zone=N\tfraction of a full push or twist that counts as rest, default 0.05\n"
      "spacemouse:speed=N\twith control=rate: speed at a full push, m/s, default 0.1; "
      "turn-speed=N: speed at a full twist, rad/s, default 1\n"
      "spacemouse:reach=N\twith control=position: distance at a full push, m, default 0.05; "
      "turn=N: angle at a full twist, rad, default 0.8\n");
}

Status read_device(const std::string& text, Options& options) {
  std::string id, control;
  devices::SpaceMouseOptions& cap = options.spacemouse;
  Buttons buttons;
  const command::Bounds numbers{0, kMaxButton};
  // Each kind takes some of them, one after the other.
  const command::ValueName names[] = {
      {.name = "dead-zone", .number = &cap.dead_zone, .bounds = {0, 0.9}},
      {.name = "speed", .number = &cap.speed_mps, .bounds = {1e-6, 10}},
      {.name = "turn-speed", .number = &cap.turn_radps, .bounds = {1e-6, 100}},
      {.name = "reach", .number = &cap.reach_m, .bounds = {1e-6, 10}},
      {.name = "turn", .number = &cap.reach_rad, .bounds = {1e-6, 6.3}},
      {.name = "control", .text = &control},
      {.name = "id", .text = &id},
      {.name = "clutch", .number = &buttons.clutch, .bounds = numbers},
      {.name = "scene", .number = &buttons.scene, .bounds = numbers},
      {.name = "guide", .number = &buttons.guide, .bounds = numbers},
      {.name = "without-watchdog", .is_given = &options.without_watchdog},
      {.name = "library", .text = &options.plugin},
      {.name = "args", .text = &options.plugin_args},
      {.name = "trust", .is_given = &options.trust_plugin},
      {.name = "hand", .text = &options.hand}};
  const std::span<const command::ValueName> all(names);
  options.device = text.substr(0, text.find(':'));
  std::span<const command::ValueName> known;
  if (options.device == "spacemouse") {
    known = all.first(10);
  } else if (options.device == "hid") {
    known = all.subspan(6, 5);
  } else if (options.device == "plugin") {
    known = all.subspan(7, 7);
  } else if (options.device == "sim") {
    known = all.last(1);
  } else {
    return usage("--device", "'" + options.device + "' is not a kind of device",
                 options.device == "replay" ? "give --replay FILE without --device"
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
    return usage("--device", "control '" + control + "' is not known",
                 "write 'rate' or 'position'");
  }
  if (options.device == "plugin" && options.plugin.empty()) {
    return usage("--device", "the plugin's library is missing", "write plugin:library=FILE");
  }
  if (!options.hand.empty() && options.hand != "firm" && options.hand != "loose") {
    return usage("--device", "hand '" + options.hand + "' is not known", "write 'firm' or 'loose'");
  }
  return take_buttons(buttons, options);
}

}  // namespace forcelayer::voxrun
