// One run of a model against a prescribed handle, or against a simulated hand on a simulated
// device, and everything that is measured on it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "forcelayer/run.h"
#include "runtime/devices/sim_hand.h"
#include "runtime/model/simulation.h"
#include "tests/stress/baked.h"

namespace forcelayer::stress {

// The device of the trials: it has the paper's limits (6.4), and the damping and the delay of such
// devices.
DeviceCapabilities trial_device();

struct Trial {
  std::shared_ptr<const BakedScene> scene;
  std::shared_ptr<const BakedPart> part;
  // That the scene is baked to. None: as `voxelize` writes it for `default`, with distances, and as
  // the paper has it for `paper`, in Chebyshev layers.
  std::optional<test::VoxelKind> voxels;
  Pose start;  // world_from_part, gripped there without stretch
  double rate_hz = 1000;
  double duration_s = 0;
  std::function<Pose(double)> target;  // world_from_part that the handle asks for, by time
  std::map<std::string, double> settings;
  DeviceCapabilities device = trial_device();
  // Closes the loop: the hand wants the handle at `target`, and feels what the device outputs.
  std::optional<devices::SimHandParameters> hand;

  // Spoils an input, or the time that passes, before the step sees it.
  std::function<void(StepInput& input, double& dt_s)> disturb;

  // The handle is still from here to the end; rest is measured in the last half of that.
  std::optional<double> hold_from_s;
  // The handle slides from here on along `slide_direction`.
  std::optional<double> slide_from_s;
  glm::dvec3 slide_direction{1, 0, 0};
  bool exact_distance = true;
  double distance_below_m = 1e300;  // exact distances above this are of no interest
  bool braking = true;
};

struct Metrics {
  std::uint64_t trials = 0, frames = 0;
  std::uint64_t starts_inside = 0;  // trials; their distances and PR are not counted
  std::uint64_t force_layer_frames = 0, penetration_frames = 0;
  std::uint64_t penetrating_trials = 0;  // with a penetration frame
  std::uint64_t non_finite = 0;          // frames with a value that is not finite
  std::uint64_t over_limit = 0;          // frames with a wrench above the limits
  double generated_j = 0;                // sum over trials
  double worst_generated_j = 0;          // of one trial
  double smallest_distance_m = 1e300;
  double guaranteed_m = 1e300;  // smallest of the trials' guarantees, swept poses
  std::uint64_t distances_visited = 0, distances_measured = 0;

  // One value for each trial that has one.
  std::vector<double> rest_force_n;        // at the end of a hold
  std::vector<double> cycle_voxels;        // peak to peak of any shell point while held
  std::vector<double> cycle_force_n;       // peak to peak of the force while held
  std::vector<double> settle_s;            // from the start of the hold to the last motion
  std::vector<double> swing_third_voxels;  // peak to peak in the third quarter of the hold
  std::vector<double> swing_last_voxels;   // the same in the last
  std::vector<double> progress;            // tangential, of the handle's
  std::vector<double> stuck_fraction;      // of the sliding frames: below 5% of the handle's speed

  double penetration_ratio() const {
    return force_layer_frames == 0
               ? 0
               : static_cast<double>(penetration_frames) / static_cast<double>(force_layer_frames);
  }
  void add(const Metrics& other);
};

// The run and the simulation of a trial. Both throw std::runtime_error where set-up fails.
Run open_trial(const Trial& trial, Model model);
std::unique_ptr<model::Simulation> make_simulation(const Trial& trial, Model model);

// Runs `trial` under `model`. Throws std::runtime_error where it cannot be set up.
Metrics run(const Trial& trial, Model model);

// The p-th percentile (0-100) of a sample; 0 of an empty one.
double percentile(std::vector<double> sample, double p);

// 95% interval of a ratio of `events` in `frames`: exact (Clopper and Pearson); zero events give
// [0, 3/n].
struct Interval {
  double low, high;
};
Interval interval95(std::uint64_t events, std::uint64_t frames);

}  // namespace forcelayer::stress
