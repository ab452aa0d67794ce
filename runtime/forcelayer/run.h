// A run: one baked scene, one baked part, and the step between them, for a program that has a
// servo thread of its own. This is the header that such a program begins with.
//
//   auto run = forcelayer::open_run(forcelayer::default_run_request("scene.vox", "part.pshell"));
//   if (!run) return complain(run.error());
//   if (auto s = run->start({}, reading()); !s) return complain(s.error());
//   for (;;) {                                  // once a period, on the servo thread
//     const Wrench wrench = run->step(reading());  // give it to the motors
//   }
//
// SI units, right-handed frames. "World" is the scene's frame, "device" the frame in which the
// device reports its handle, "part" the frame of the part's mesh. Both files are read
// into memory when they are opened. Whatever becomes of them later changes nothing in a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcelayer/device.h"
#include "forcelayer/frame.h"
#include "forcelayer/parameters.h"
#include "forcelayer/placement.h"
#include "forcelayer/ranges.h"
#include "forcelayer/stale_limit.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"

namespace forcelayer::model {
class Simulation;
}

namespace forcelayer {

// A device as the paper had it (6.4: 15 N, 0.1 N m), with the damping (2 N s/m, 0.005 N m s/rad)
// and the delay (1 ms) that such devices show; it holds a hand.
DeviceCapabilities default_device();

// Limit of a handle's rotation over that of its speed: the wrist of a hand.
inline constexpr double kTurnOfSpeedRadPerM = kMaxTurnsRadps.largest / kMaxSpeedsMps.largest;

// Everything that decides what a run is. The defaults are what most people want; only the files
// must be named. open_run() refuses numbers out of their ranges (ranges.h, parameter_table()).
struct RunRequest {
  std::filesystem::path scene;  // .vox, from voxelize
  std::filesystem::path part;   // .pshell, from pointshell

  Model model = kDefaultModel;
  std::optional<ForceKind> force;  // none: the best that the model and the map allow
  bool braking = true;             // pre-contact braking (paper 5.3)
  double rate_hz = 1000;           // at which step() is called

  // Parameters that are to have a value of your own, by the name of their member of Parameters
  // ("mass_kg"; all of them: parameter_table()). The others are derived from the voxel size, the
  // part, the rate and the device; Run::reasons() says by which rule.
  std::map<std::string, double> settings;

  // The parameters of a recorded run, used as they are: then model, force, braking, rate_hz,
  // settings and the ratings of the device count for nothing.
  std::optional<Parameters> recorded;

  DeviceCapabilities device = default_device();  // its ratings are never exceeded
  DevicePlacement placement;                     // of the device in the scene
  double stale_s = kStaleLimitS;  // silence of device or caller that takes the output to zero; of
                                  // the device's never more than kStaleCeilingS
  double max_speed_mps = 5;       // of the handle at the device: faster trips the output; to 10
  std::optional<double> max_turn_radps;  // the same for its rotation; none: kTurnOfSpeedRadPerM
                                         // times max_speed_mps; to 100
  unsigned threads = 1;  // of the contact query, to 256; worth more than 1 from 16384 points on

  // Open also files without a guarantee of separation.
  bool without_guarantee = false;

  // SHA-256 of the files that may be opened, 64 lower-case hexadecimal digits each, as `sha256sum`
  // and `voxinfo` print them. With any, scene and part must both be among them. Empty: any file.
  std::vector<std::string> expected_sha256;
};

// A request for these two files with every default.
RunRequest default_run_request(std::filesystem::path scene, std::filesystem::path part);

// How far apart the exact surfaces of part and scene are as long as no shell point is in an
// interior voxel: a bound that follows from the two files alone. None where it is not positive.
struct SeparationGuarantee {
  std::optional<double> tested_m;  // in every frame
  std::optional<double> swept_m;   // between two frames, where no point travels more than s/2
};

// "0.67 mm at every frame, 0.51 mm between frames ...", or "none ..."; rounded down.
std::string guarantee_text(const SeparationGuarantee& guarantee);

// The frames of a run so far. Objects are numbers in the scene's file: Run::object_name().
struct RunStatistics {
  std::uint64_t frames = 0;
  std::uint64_t force_layer_frames = 0;  // with a point in the force layer or in the interior
  std::uint64_t contact_frames = 0;      // with a contact
  std::uint64_t penetration_frames = 0;  // with a point in the interior: no guarantee there
  std::uint64_t outside_map_frames = 0;  // with a point beyond a cropped side: the same
  std::uint64_t seated_frames = 0;       // in which the part was in its seat: no clearance is known
  std::optional<double> guarantee_from_s;  // when the part had left its seat, 0 without one; none:
                                           // it has not, and no separation is guaranteed yet
  std::uint64_t guard_cuts = 0;            // motions that the guard shortened
  std::uint64_t saturated_frames = 0;      // in which the coupling's clamp was at work
  std::uint64_t faulty_frames = 0;         // in which the step reported a fault
  std::uint64_t trips = 0;                 // of the output
  double max_force_n = 0;                  // at the device
  double max_torque_nm = 0;                // at the device
  double generated_j = 0;  // energy given to the hand that a passive scene could not give

  // The frame with the least clearance of those of which something is known.
  ClearanceKind min_clearance_kind = ClearanceKind::kNone;
  double min_clearance_m = 0, min_clearance_s = 0;  // how much, and when
  std::uint32_t min_clearance_object = 0;  // to which object; 0: not known, or of a scene that
                                           // was swapped out
  std::uint64_t step_p50_ns = 0, step_p99_ns = 0, step_max_ns = 0;
};

// Made by open_run(). Call its functions from the servo's thread, but for set_clutch() (any thread)
// and swap() (one other thread). While swap() runs, call step(), frame() and
// guaranteed_m() alone.
class Run {
 public:
  Run(Run&&) noexcept;
  Run& operator=(Run&&) noexcept;
  ~Run();

  // The parameters in use. By name, the rule by which each was chosen ("set": by the request; no
  // rules for the parameters of a recording). Warnings for the user, a sentence each. The proven
  // separation of the two files.
  const Parameters& parameters() const;
  const std::map<std::string, std::string>& reasons() const;
  const std::vector<std::string>& warnings() const;
  const SeparationGuarantee& guarantee() const;

  // Registers the part at rest, before the first step(), or to begin anew. `first` is where the
  // handle is now. With neither place nor grip in `start`, the part's frame is the handle's.
  // Errors: kUsage for an invalid pose; kDeviceRefused for a reading with which a run cannot
  // begin: absent, not calibrated, or so far outside the workspace that its unit must be wrong.
  Status start(const PartStart& start, const DeviceSample& first);
  bool started() const;

  // One period: takes the device's reading, and returns the wrench for its motors, about the
  // handle's origin, in device axes, within the ratings. It is zero before start(), and until the
  // output arms: once the part is free of contact, or held without stretch. A fault of the reading
  // gives zero in the same call. A fault that lasts, or a call that is late by more than the stale
  // limit, trips the output: zero until the user presses and releases the clutch. Never blocks,
  // allocates, locks or logs. With more than one thread it calls the system to wake the helpers.
  Wrench step(const DeviceSample& reading) noexcept;

  // The last step in full. Before the first one: a frame of zeros.
  const Frame& frame() const;

  // How far apart the exact surfaces were at least in the last step: guarantee().tested_m of the
  // files in use. 0 where nothing is guaranteed: a point in the interior, beyond a cropped side or
  // nearer than the guard allows, an open seat, a lost file, or nothing tested yet. Where clutch or
  // fault held the part, that of the pose at which it is held.
  double guaranteed_m() const noexcept;

  // Where the part is after the last step; the identity before start().
  Pose world_from_part() const;

  // The clutch, from any thread. Pressed: the output fades to zero and the part stays where it is.
  // Released: the hand holds it anew, without stretch, and the output ramps in. It also arms a
  // tripped output. Nothing before start().
  void set_clutch(bool pressed) noexcept;

  // Replaces scene and part, from one thread other than the one that calls step(): opens both, lets
  // the output fade, registers the part as `start` has it (with both a place and a grip, the place
  // counts: it is gripped there without stretch) and ramps in. Returns once the servo thread has
  // taken them. On an error the files so far stay in use. If the servo thread does not come within
  // `timeout_s`, the new ones follow when it does. Errors: those of open_run(); kUsage
  // before start() and while another swap waits; kDeviceFailed for the timeout.
  Status swap(const std::filesystem::path& scene, const std::filesystem::path& part,
              const PartStart& start, double timeout_s);

  // Figures of the frames since start().
  RunStatistics statistics() const;

  // The name of an object of the scene by its number; empty for 0 and where the file names none.
  // After a swap(): of the scene that is in use then.
  std::string_view object_name(std::uint32_t object) const;

  // Asks the system for real time: locked memory, and real-time priority for the calling thread
  // and the query's helpers. Call it once, on the servo thread, when every other thread runs.
  // Returns a warning for everything that was refused, with what to do about it.
  std::vector<std::string> make_real_time();

  // The dynamics inside, for programs that are built with this project's sources
  // (runtime/model/simulation.h). After release_simulation() nothing else may be called.
  model::Simulation& simulation();
  const model::Simulation& simulation() const;
  std::unique_ptr<model::Simulation> release_simulation();

 private:
  struct Parts;
  explicit Run(std::unique_ptr<Parts> parts);
  friend Result<Run> open_run(Voxmap scene, Pshell part, const RunRequest& request);

  std::unique_ptr<Parts> parts_;
};

// Reads both files, checks them, every checksum and all that the step trusts too, chooses force
// field and parameters, and refuses what could not be trusted. Errors: those of files (1xx, 4xx);
// kFilesDoNotMatch for a part too large for the voxels, or where no separation is guaranteed;
// kUsage for a number out of its range and for a force that model or map do not have.
Result<Run> open_run(const RunRequest& request);

// The same for a scene and a part that are open already; the paths of the request are for errors.
Result<Run> open_run(Voxmap scene, Pshell part, const RunRequest& request);

}  // namespace forcelayer
