// The command line of voxrun.
#pragma once

#include <optional>
#include <string>

#include "forcelayer/run.h"
#include "formats/result.h"
#include "runtime/devices/hid/spacemouse.h"
#include "runtime/loop/guide.h"

namespace CLI {
class App;
}

namespace forcelayer::voxrun {

// Consequence of a trip of the output.
enum class AfterTrip {
  kEnd,    // the run ends with status 5
  kWait,   // zero until the user presses the clutch and releases it
  kRearm,  // it arms again by itself: simulated hands only
};

// The events that make a run end with status 6, as bits: penetration always, others by --fail-on.
enum FailOn : std::uint32_t {
  kFailOnPenetration = 1,  // a penetration frame
  kFailOnContact = 2,      // a contact, but with the objects of the open seat
  kFailOnOutside = 4,      // a frame beyond a cropped side
  kFailOnSeat = 8,         // a seat that is open at the end
  kFailOnHeld = 16,        // a part off its motion, or short of the end of its pull
};

// A scene that follows while the run goes on.
struct NextScene {
  std::string path;
  std::optional<double> at_s;  // none: when the user asks for it
};

struct Options {
  RunRequest run;              // its device: set once that is known
  std::string device = "sim";  // its kind; "replay" with --replay
  std::optional<double> duration_s;
  bool as_fast_as_possible = false;
  bool without_watchdog = false;  // a device with motors may lack one
  bool quiet = false;
  bool on_new_scene = false;        // --replay: its inputs alone, on any scene
  bool trust_plugin = false;        // its process keeps the user's rights
  std::string plugin, plugin_args;  // of the device "plugin"
  devices::HidSelector hid;         // of the devices "hid" and "spacemouse"
  devices::SpaceMouseOptions spacemouse;
  std::string hand;  // that holds the sim device; empty: the script moves it, whatever it feels
  std::string motion, json, trace, save_path, record, replay, udp;
  std::optional<glm::dvec3> pull_m;  // --pull: displacement of the hand, world axes
  double udp_rate_hz = 60;
  PartStart start;                             // --start and --grip
  std::uint32_t fail_on = kFailOnPenetration;  // FailOn bits
  std::optional<AfterTrip> after_trip;         // none: the device's own
  std::optional<unsigned> clutch_button;       // none: the device's own
  std::vector<NextScene> scene_next;           // --scene-next
  std::string guide;                           // --guide: a path
  std::optional<double> guide_force_n;         // none: of GuideLimits
  std::optional<unsigned> guide_button;        // that switches it off and on; none: nothing does
  std::optional<unsigned> scene_button;        // that asks for the next scene; none: SIGUSR1 alone
};

// Whether the scene can change while such a run goes on. `asked_by`: an option, for the error.
// Errors: kUsage.
Status check_scene_change(const Options& options, const char* asked_by);

// Declares the options to CLI11. finish() turns what was parsed into Options and refuses
// contradictions. (A copy of Options would be 3 kB of code.)
class OptionParser {
 public:
  explicit OptionParser(CLI::App& app);

  // Errors: kUsage.
  Status finish();
  Options& options() { return options_; }

 private:
  struct Texts {
    std::string scene, part, duration, model, force, start, seat, grip, world_from_device, fail_on,
        after_trip, settings, scene_next, pull, expect;
    std::string device = "sim";
  };
  Status read_texts(Options& options) const;
  Status read_safety(Options& options) const;
  Status read_scenes(Options& options) const;
  Status read_pull(Options& options) const;
  Status read_fail_on(Options& options) const;
  Status check(const Options& options) const;

  CLI::App& app_;
  Options options_;
  Texts texts_;
};

}  // namespace forcelayer::voxrun
