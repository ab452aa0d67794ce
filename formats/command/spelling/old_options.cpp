#include "formats/command/spelling/old_options.h"

namespace forcelayer::command {
namespace {

// "COMMAND OPTION NOW" a line: one text takes less room in a program than a table of pointers.
constexpr std::string_view kOldOptions =
    "voxrun --mass --set mass_kg=VALUE\n"
    "voxrun --coupling-stiffness --set coupling_n_per_m=VALUE\n"
    "voxrun --coupling-damping --set coupling_ns_per_m=VALUE\n"
    "voxrun --coupling-stiffness-rot --set coupling_nm_per_rad=VALUE\n"
    "voxrun --coupling-damping-rot --set coupling_nms_per_rad=VALUE\n"
    "voxrun --coupling-force-limit --set coupling_force_limit_n=VALUE\n"
    "voxrun --coupling-torque-limit --set coupling_torque_limit_nm=VALUE\n"
    "voxrun --field-stiffness --set field_n_per_m=VALUE\n"
    "voxrun --contact-damping --set contact_damping_ratio=VALUE\n"
    "voxrun --look-ups --set look_ups=VALUE\n"
    "voxrun --recovery-speed --set recovery_mps=VALUE\n"
    "voxrun --allowance --set allowance_j=VALUE\n"
    "voxrun --allowance-fade --set allowance_fade_s=VALUE\n"
    "voxrun --passivity-damping --set passivity_damping_ns_per_m=VALUE\n"
    "voxrun --max-force --set max_force_n=VALUE\n"
    "voxrun --max-torque --set max_torque_nm=VALUE\n"
    "voxrun --max-speed --set max_speed_mps=VALUE\n"
    "voxrun --max-turn --set max_turn_radps=VALUE\n"
    "voxrun --stale-limit --set stale_s=SECONDS\n"
    "voxrun --guide-force --set guide_force_n=VALUE\n"
    "voxrun --no-braking --set braking=0\n"
    "voxrun --hid --device hid:id=ID\n"
    "voxrun --control --device spacemouse:control=rate|position\n"
    "voxrun --dead-zone --device spacemouse:dead-zone=VALUE\n"
    "voxrun --cap-speed --device spacemouse:speed=VALUE\n"
    "voxrun --cap-turn-speed --device spacemouse:turn-speed=VALUE\n"
    "voxrun --cap-reach --device spacemouse:reach=VALUE\n"
    "voxrun --cap-turn --device spacemouse:turn=VALUE\n"
    "voxrun --plugin --device plugin:library=FILE\n"
    "voxrun --plugin-args --device plugin:library=FILE,args=TEXT\n"
    "voxrun --trust-plugin --device plugin:library=FILE,trust\n"
    "voxrun --without-watchdog --device KIND:without-watchdog\n"
    "voxrun --clutch-button --device KIND:clutch=N\n"
    "voxrun --scene-button --device KIND:scene=N\n"
    "voxrun --guide-button --device KIND:guide=N\n"
    "voxrun --buttons --device KIND:clutch=N,scene=N,guide=N\n"
    "voxrun --hand --device sim:hand=firm|loose\n"
    "voxrun --rate --set rate_hz=VALUE\n"
    "voxrun --motion-scale --set motion_scale=VALUE\n"
    "voxrun --udp-rate --udp [HOST:]PORT@RATE\n"
    "voxrun --on-new-scene --replay inputs:FILE\n"
    "voxcheck --csv --report csv:FILE\n"
    "voxcheck --picture --report picture:FILE\n"
    "voxcheck --junit --report junit:FILE\n"
    "voxcheck --code-quality --report gitlab:FILE\n"
    "voxcheck --github --report github\n"
    "voxelize --sandbox-memory --sandbox=memory=SIZE\n"
    "pointshell --sandbox-memory --sandbox=memory=SIZE\n"
    "voxcheck --sandbox-memory --sandbox=memory=SIZE\n"
    "voxelize --sandbox-time --sandbox=time=LIMIT\n"
    "pointshell --sandbox-time --sandbox=time=LIMIT\n"
    "voxcheck --sandbox-time --sandbox=time=LIMIT\n"
    "forcelayer --range leave it out: with --voxel-size auto the study finds it\n"
    "voxinfo --of leave it out: the path is that of the part\n"
    "voxplan --speed leave it out: the path goes at 0.1 m/s\n"
    "voxplan --out-of-scene leave it out: it is the default\n"
    "voxelize --lean --kind lean\n"
    "voxelize --metric --kind full|paper\n"
    "pointshell --effort --method surface|fast\n"
    "voxview --scale --size WIDTHxHEIGHT@SCALE\n"
    "voxview --turntable --screenshot turntable:FILE\n"
    "voxview --model leave it out: it is read from the recording of a run\n"
    "voxview --force leave it out: it is read from the recording of a run\n"
    "voxview --grip leave it out: it is read from the first row of a run\n"
    "voxview --duration voxview draw ... --duration\n"
    "voxview --frame-times voxview draw ... --frame-times\n"
    "voxview --plain voxview draw ... --plain\n"
    "voxview --pixels-per-voxel voxview draw ... --pixels-per-voxel\n"
    "voxview --measure voxview draw ... --measure\n"
    "voxview --measure-object voxview draw ... --measure-object\n"
    "voxview --measure-words voxview draw ... --measure-words\n"
    "voxview --title voxview draw ... --title\n"
    "voxview --part-units voxview draw ... --part-units\n"
    "voxview --focus voxview draw ... --focus\n"
    "voxview --color voxview draw ... --color\n";

}  // namespace

std::string_view new_spelling(std::string_view command, std::string_view option) {
  for (std::string_view rest = kOldOptions; !rest.empty();) {
    std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(line.size() + 1);
    bool is_it = true;
    for (const std::string_view word : {command, option}) {
      is_it = is_it && line.starts_with(word) && line.substr(word.size()).starts_with(' ');
      if (is_it) line.remove_prefix(word.size() + 1);
    }
    if (is_it) return line;
  }
  return {};
}

}  // namespace forcelayer::command
