// Forcelayer in your own servo loop: opens two files and calls the loop from a callback.
//   example_embed SCENE.vox PART.pshell
// Here the callback is called by a plain loop, and the hand is a script that comes down 30 mm.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <glm/geometric.hpp>
#include <thread>

#include "runtime/loop/callback_servo.h"
#include "runtime/machine/real_time.h"
#include "runtime/run/baked_files.h"
#include "runtime/run/derive_parameters.h"

using namespace forcelayer;

namespace {

int complain(const Error& error) {
  std::fprintf(stderr, "example_embed: %s\n", to_line(error).c_str());
  return exit_status(error.code);
}

// What your device is: SI units, its ratings, its physical damping and delay.
DeviceCapabilities my_device() {
  DeviceCapabilities device;
  device.name = "my device";
  device.max_force_n = 8;
  device.max_torque_nm = 0.1;
  device.damping_ns_per_m = 2;
  device.damping_nms_per_rad = 0.005;
  device.delay_s = 0.001;
  device.hardware = true;
  return device;
}

// What your SDK's servo callback reads: the handle in the device's frame.
DeviceSample my_reading(double time_s) {
  DeviceSample reading;
  reading.device_from_handle.position_m.z = -0.03 * std::min(1.0, time_s / 0.5);
  reading.present = reading.fresh = true;
  return reading;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: example_embed SCENE.vox PART.pshell\n");
    return 2;
  }
  auto voxmap = open_scene(argv[1]);
  if (!voxmap) return complain(voxmap.error());
  auto shell = open_part(argv[2]);
  if (!shell) return complain(shell.error());
  const auto derived = derive_parameters({}, *voxmap, *shell, my_device());
  if (!derived) return complain(derived.error());
  auto simulation = Simulation::create(std::move(*voxmap), std::move(*shell), derived->values);
  if (!simulation) return complain(simulation.error());

  // The device's origin stands 60 mm above the middle of the floor, and so does the part.
  DevicePlacement placement;
  placement.world_from_device.position_m = {0.1, 0.1, 0.06};
  OutputLimits limits = output_limits(derived->values);
  limits.stale_s = 0.1;  // a shared machine and no motors; else leave it
  PartStart start;
  start.world_from_part = placement.world_from_device;
  CallbackServo servo(**simulation, my_device(), placement, start, my_reading(0), limits);

  // Your servo thread, with real-time priority where it is granted. The wrench goes to the motors:
  // newtons and newton metres, device axes.
  take_real_time_priority();
  double largest_n = 0;
  auto tick = std::chrono::steady_clock::now();
  for (int frame = 0; frame < 1000; ++frame) {
    std::this_thread::sleep_until(tick += std::chrono::milliseconds(1));
    const Wrench wrench = servo.call(my_reading(frame / 1000.0));
    largest_n = std::max(largest_n, glm::length(wrench.force_n));
  }

  const LoopStatistics& seen = servo.statistics();
  std::printf(
      "largest force %.2f N, %llu of %llu frames in contact, %llu penetrating, trips %llu\n",
      largest_n, static_cast<unsigned long long>(seen.contact_frames),
      static_cast<unsigned long long>(seen.frames),
      static_cast<unsigned long long>(seen.penetration_frames),
      static_cast<unsigned long long>(servo.servo().output().trips()));
  return 0;
}
